"""Designs closest to what somebody hopes for, by an achievement function.

    s(x) = max(0, max over the named objectives of w_i (f_i(x) - z_i))  +  rho * sum over all of w_i f_i(x)

f_i are minimised values, z_i the aspirations, w_i = 1 / range over the designs. The first term is the worst
shortfall from the aspirations, and nothing for a design that meets them all. The small sum decides between
designs of equal shortfall: among those that meet every aspiration the best over all objectives comes first.
Unlike a distance, s never prefers a dominated design to one that dominates it, and never punishes a design
for being better than the aspiration.

Source: Wierzbicki 1980, The use of reference objectives in multiobjective optimization, augmented as in
Miettinen 1999, Section 5.7. There the first term goes on below zero; here it stops, so that objectives that
nobody names count as soon as the named ones are good enough.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import msgspec
import numpy as np

from evodesign.analysis.front import to_minimise
from evodesign.analysis.scaling import Matrix, scaled
from evodesign.errors import InputError, nearest_name
from evodesign.records import Evaluation, Objective

__all__ = ["AUGMENTATION", "achievements", "aspiration_of", "closest"]

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
    _check(objectives, aspiration, "aspiration")
    front = scaled(objectives, designs)
    hoped = {
        column: front.share(column, to_minimise(objective, aspiration[objective.name]))
        for column, objective in enumerate(objectives)
        if objective.name in aspiration
    }
    order = np.argsort(achievements(front.shares, hoped), kind="stable")
    return tuple(front.designs[row] for row in order.tolist())


def achievements(shares: Matrix, hoped: Mapping[int, float]) -> Matrix:
    """The achievement s of each design, (designs,); less is better.

    Args:
        shares: (designs, objectives), from 0 (best) to 1 (worst).
        hoped: aspiration by column, as a share; below 0 is better than every design.
    """
    shortfall = shares[:, list(hoped)] - np.array(list(hoped.values()))
    value: Matrix = np.maximum(shortfall.max(axis=1), 0.0) + AUGMENTATION * shares.sum(axis=1)
    return value


def aspiration_of(objectives: Sequence[Objective], text: str, source: str) -> dict[str, float]:
    """The aspiration that a user wrote, such as `robot_torque=8, reach_height=1.5`.

    Args:
        objectives: of the run.
        text: as it was written.
        source: where, for messages.
    Raises:
        InputError: it is no such list, or names something that is no objective.
    """
    aspiration: dict[str, float] = {}
    for part in text.split(","):
        name, _, value = (piece.strip() for piece in part.partition("="))
        try:
            aspiration[name] = msgspec.convert(value, float, strict=False)
        except msgspec.ValidationError:
            raise InputError(source, "", "NAME=NUMBER, NAME=NUMBER, ...", f"'{part}'") from None
    _check(objectives, aspiration, source)
    return aspiration


def _check(objectives: Sequence[Objective], aspiration: Mapping[str, float], source: str) -> None:
    names = [objective.name for objective in objectives]
    if not aspiration:
        raise InputError(source, "", f"values of some of {', '.join(names)}", "none")
    for name, value in aspiration.items():
        if name not in names:
            found = f"'{name}'{nearest_name(name, names)}"
            raise InputError(source, "", f"objectives among {', '.join(names)}", found)
        if not np.isfinite(value):
            raise InputError(source, name, "a finite number", f"{value}")
