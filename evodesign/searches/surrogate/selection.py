"""Which members of an evolved population are worth an evaluation: those that together dominate most.

One after another is chosen by the hypervolume that it is expected to add to the front and to those chosen
before. What a member adds can only become less as others are chosen, so that most need not be measured again.
Members that would add nothing are chosen at random; where none is expected to be feasible, the least
infeasible ones are.

Source: Minoux, Accelerated greedy algorithms for maximizing submodular set functions, 1978.
"""

from __future__ import annotations

import heapq

import moocore
import numpy as np
from numpy.typing import NDArray

from evodesign.searches.surrogate.evolution import Members

Array = NDArray[np.float64]

FRONT = {3: 500, 4: 200, 5: 80}
"""Points of the front that are reckoned with, at most, with so many objectives: hypervolumes grow dear."""

APART = 1e-6
"""Squared distance of genomes below which two are the same."""


def _hypervolume(points: Array) -> float:
    """Of scaled objectives, whose reference is 1 in each."""
    inside = points[(points < 1.0).all(axis=1)]
    return float(moocore.hypervolume(inside, ref=1.0)) if len(inside) else 0.0


def chosen(members: Members, front: Array, count: int, generator: np.random.Generator) -> list[int]:
    """Positions of so many members, fewer if there are fewer different ones.

    Args:
        members: of an evolved population.
        front: scaled objectives of known designs that no other dominates, and of designs on their way.
        count: how many.
        generator: for those that would add nothing.
    """
    feasible = np.flatnonzero(members.infeasibility == 0.0)
    if not len(feasible):
        order = np.argsort(members.infeasibility, kind="stable").tolist()
        return _different(members.points, order, count)
    known = front
    volume = _hypervolume(known)
    queue = [
        (-(_hypervolume(np.vstack([known, members.objectives[place]])) - volume), place)
        for place in feasible.tolist()
    ]
    heapq.heapify(queue)
    found: list[int] = []
    while queue and len(found) < count:
        _, place = heapq.heappop(queue)
        gain = _hypervolume(np.vstack([known, members.objectives[place]])) - volume
        if gain <= 0.0:
            continue
        if queue and gain < -queue[0][0]:
            heapq.heappush(queue, (-gain, place))
            continue
        if len(_different(members.points, [*found, place], count)) > len(found):
            found.append(place)
            known, volume = np.vstack([known, members.objectives[place]]), volume + gain
    rest = generator.permutation(feasible).tolist()
    return _different(members.points, [*found, *rest], count)


def _different(points: Array, order: list[int], count: int) -> list[int]:
    """The first so many of an order whose points are apart from each other."""
    found: list[int] = []
    for place in order:
        if len(found) == count:
            break
        if all(((points[place] - points[other]) ** 2).sum() > APART for other in found):
            found.append(place)
    return found
