"""Shapes, placements and inertia of rigid bodies."""
