"""The experiments of the two papers again: robots, people and loads, with verdicts on the claims."""
