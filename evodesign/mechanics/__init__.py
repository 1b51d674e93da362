"""Static equilibrium of robot, person and load."""
