"""What the three papers claim, their experiments again (robots, people, loads), and verdicts."""
