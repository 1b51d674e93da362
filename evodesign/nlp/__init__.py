"""Nonlinear programs and their solvers, which know no robots."""
