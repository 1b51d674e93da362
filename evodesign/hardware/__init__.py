"""Hardware that can be ordered: actuators, hollow links, and the size that a demand asks for."""
