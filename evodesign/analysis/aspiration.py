"""Designs closest to what somebody hopes for, by an achievement function.

    s(x) = max_i w_i (f_i(x) - z_i)  +  rho * sum_i w_i (f_i(x) - z_i)

f_i are minimised values, z_i the aspirations, w_i = 1 / range over the designs. The least s is the design
whose worst shortfall from the aspirations is least; when they can all be had, it is the one that exceeds them
by most. Unlike a distance, s never prefers a design that another one beats: the small sum decides between
designs of equal shortfall. For an objective that nobody names, the best value of the designs is hoped for.

Source: Wierzbicki 1980, The use of reference objectives in multiobjective optimization, augmented as in
Miettinen 1999, Section 5.7.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from evodesign.analysis.front import to_minimise
from evodesign.analysis.scaling import Matrix, scaled
from evodesign.errors import InputError, nearest_name
from evodesign.records import Evaluation, Objective

__all__ = ["AUGMENTATION", "achievements", "closest"]

AUGMENTATION = 1e-3
"""rho: small, so that it only decides between designs whose worst shortfall is nearly equal."""


def closest(
    objectives: Sequence[Objective], designs: Sequence[Evaluation], aspiration: Mapping[str, float]
) -> tuple[Evaluation, ...]:
    """All designs, those closest to an aspiration first; of equal ones the earlier number.

    Args:
        objectives: of the run.
        designs: of a front.
        aspiration: natural values hoped for, of one objective or more.
    Raises:
        InputError: the aspiration is empty or names something that is no objective.
    """
    names = [objective.name for objective in objectives]
    for name in aspiration:
        if name not in names:
            wanted = f"objectives among {', '.join(names)}"
            raise InputError("aspiration", "", wanted, f"'{name}'{nearest_name(name, names)}")
    if not aspiration:
        raise InputError("aspiration", "", "at least one objective with its value", "nothing")
    front = scaled(objectives, designs)
    hoped = [
        front.share(column, to_minimise(objective, aspiration[objective.name]))
        if objective.name in aspiration
        else 0.0
        for column, objective in enumerate(objectives)
    ]
    order = np.argsort(achievements(front.shares, hoped), kind="stable")
    return tuple(front.designs[row] for row in order.tolist())


def achievements(shares: Matrix, hoped: Sequence[float]) -> Matrix:
    """The achievement s of each design, (designs,); less is better.

    Args:
        shares: (designs, objectives), from 0 (best) to 1 (worst).
        hoped: an aspiration per objective, as a share; below 0 is better than every design.
    """
    shortfall = shares - np.asarray(hoped)
    value: Matrix = shortfall.max(axis=1) + AUGMENTATION * shortfall.sum(axis=1)
    return value
