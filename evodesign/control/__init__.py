"""A controller of every agent on feet: torques that keep balance, trunk and load, found by a quadratic program."""
