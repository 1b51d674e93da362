"""Whole-body controllers: torques that keep balance, trunk and load, by quadratic programs."""
