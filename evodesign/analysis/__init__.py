"""Fronts, hypervolumes and histories of runs."""
