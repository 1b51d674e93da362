"""What the two papers claim, their experiments again (robots, people, loads), and verdicts."""
