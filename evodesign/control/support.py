"""Limits of a controller's program that depend on which feet stand: their cones, and where other rows lie."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations

import numpy as np
import scipy
from numpy.typing import NDArray

from evodesign.control.moving_body import MovingBody
from evodesign.mechanics.contact import Ground, foot_margins

Array = NDArray[np.float64]
Places = NDArray[np.intp]


@dataclass(frozen=True, slots=True, eq=False)
class Support:
    """On which feet an agent stands, and the limits of its program then.

    Args:
        feet: that stand, by their place among the agent's.
        bounds: rows over accelerations and wrenches per mass, of cones, torques and accelerations; those of
            torques are still empty.
        torques: rows of torques.
        least: lower limits of the rows of cones.
    """

    feet: tuple[int, ...]
    bounds: Array
    torques: slice
    least: Array

    @classmethod
    def of(
        cls, body: MovingBody, ground: Ground, feet: tuple[int, ...], limited: Places, bounded: Places
    ) -> Support:
        """Those of some feet.

        Args:
            body: of the agent.
            ground: under its feet.
            feet: that stand.
            limited: joints whose torque is limited, by their place among the agent's.
            bounded: joints whose acceleration is limited, likewise.
        """
        units = [*np.eye(6), np.zeros(6)]
        soles = [body.agent.feet[foot].sole for foot in feet]
        margins = [np.array([foot_margins(e, sole, ground) for e in units]) for sole in soles]
        cones = scipy.linalg.block_diag(*((each[:-1] - each[-1]).T for each in margins))
        bounds = np.zeros((len(cones) + len(limited) + len(bounded), body.size + 6 * len(margins)))
        bounds[: len(cones), body.size :] = cones
        ends = range(len(bounds) - len(bounded), len(bounds))
        bounds[ends, body.rates[bounded]] = 1.0
        least = -np.concatenate([each[-1] for each in margins]) / body.total
        return cls(feet, bounds, slice(len(cones), len(cones) + len(limited)), least)


def supports_of(
    body: MovingBody, ground: Ground, limited: Places, bounded: Places
) -> Mapping[tuple[int, ...], Support]:
    """Those of every choice of at least one foot; arguments as `Support.of`."""
    every = range(len(body.agent.feet))
    choices = (feet for count in range(1, len(every) + 1) for feet in combinations(every, count))
    return {feet: Support.of(body, ground, feet, limited, bounded) for feet in choices}
