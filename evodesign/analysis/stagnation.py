"""When a search has come to a standstill: its hypervolume no longer grows."""

from __future__ import annotations

from collections.abc import Sequence

__all__ = ["LEAST_GROWTH", "stagnant"]

LEAST_GROWTH = 1e-3
"""Share of its value by which a hypervolume must grow to count as growing."""


def stagnant(hypervolumes: Sequence[float | None], generations: int | None) -> bool:
    """Whether the last so many generations together made the hypervolume grow by less than a thousandth.

    Args:
        hypervolumes: after each generation; None before the first feasible design, where there is no
            standstill.
        generations: how many may pass without growth; None or zero for any number.
    """
    if not generations or len(hypervolumes) <= generations:
        return False
    before, now = hypervolumes[-1 - generations], hypervolumes[-1]
    return before is not None and now is not None and now < before * (1.0 + LEAST_GROWTH)
