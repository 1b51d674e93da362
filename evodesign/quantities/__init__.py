"""What can be an objective or a constraint: quantities of a design, by name."""
