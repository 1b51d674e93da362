"""Holds and lifts in MuJoCo: robot, person and load as bodies that move by Newton's laws alone."""
