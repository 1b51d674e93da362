"""The hold of `tests.simulation` and an inverted pendulum on one sole, under whole-body controllers."""

from tests.simulation.conftest import held, held_with

__all__ = ["held", "held_with"]
