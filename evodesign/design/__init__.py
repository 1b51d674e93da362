"""Design parameters, the design space, and the robot of a design."""
