"""What a search attains for certain: surfaces that a share of its seeds reaches.

A point of the objective space is attained by a run when a design of the run is nowhere worse. The surface of
a level of 50 % bounds what at least half of the seeds attain: the median front of a search that depends on
chance. The 100 % surface bounds what every seed attains, the lowest level what any one does.

Surfaces are drawn for two objectives at a time, whatever the others are.

Source: Grunert da Fonseca, Fonseca and Hall 2001, computed by moocore (Fonseca et al. 2011).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import moocore
import numpy as np

from evodesign.analysis.front import comparable, front, to_minimise
from evodesign.records import Evaluation, Objective

__all__ = ["AttainmentSurface", "attainment_surfaces"]


@dataclass(frozen=True, slots=True)
class AttainmentSurface:
    """Corners of the staircase that a share of the runs attains.

    Args:
        share: of the runs, from 0 (exclusive) to 1.
        corners: natural values of the two objectives, in rising order of the first.
    """

    share: float
    corners: tuple[tuple[float, float], ...]


def attainment_surfaces(
    pair: tuple[Objective, Objective], runs: Sequence[Sequence[Evaluation]]
) -> tuple[AttainmentSurface, ...]:
    """Surfaces that one run, half of the runs and all of them attain; equal shares once.

    Args:
        pair: the two objectives.
        runs: the front of each run, in all of its objectives; a run without one attains nothing.
    Returns:
        None is empty: a surface that nothing attains is left out.
    """
    fronts = [_values(pair, run) for run in runs]
    filled = [points for points in fronts if points]
    if not filled:
        return ()
    counts = sorted({1, -(-len(runs) // 2), len(runs)})
    points = np.array([point for run in filled for point in run])
    sets = np.repeat(np.arange(len(filled)), [len(run) for run in filled])
    surfaces = []
    for count in counts:
        if count <= len(filled):
            corners = moocore.eaf(points, sets, percentiles=[100.0 * count / len(filled)])[:, :2]
            surfaces.append(AttainmentSurface(count / len(runs), _natural(pair, corners.tolist())))
    return tuple(surfaces)


def _values(pair: tuple[Objective, Objective], run: Sequence[Evaluation]) -> list[tuple[float, ...]]:
    return [values for _, values in comparable(pair, front(pair, run))]


def _natural(
    pair: tuple[Objective, Objective], corners: Sequence[Sequence[float]]
) -> tuple[tuple[float, float], ...]:
    turned = [(to_minimise(pair[0], first), to_minimise(pair[1], second)) for first, second in corners]
    return tuple(sorted(turned))
