"""How far bodies are apart: the signed distance of the nearest two of many convex solids.

A distance is negative where two solids overlap: minus how deep they are in each other. Pairs are measured by
coal in the order of their bounding balls' distances, for as long as a nearer one may follow.

Source: coal (formerly hpp-fcl): Gilbert, Johnson and Keerthi (1988), and expanding polytopes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import coal
import numpy as np
from numpy.typing import NDArray

from evodesign.body.placement import Placement
from evodesign.collision.shapes import Array, ConvexSolid, solids_of
from evodesign.tree.model import Tree

__all__ = ["BodyDistance", "PlacedSolids", "Places", "SolidBodies", "places_of"]


Places = NDArray[np.intp]
"""Pairs of solids by their places, shape (n, 2)."""


def places_of(names: Sequence[str], pairs: Iterable[tuple[str, str]]) -> Places:
    """Every solid of the first with every one of the second body of each pair.

    Args:
        names: of each solid's body.
        pairs: of bodies; those without solids count for nothing.
    """
    by_name: dict[str, list[int]] = {}
    for place, name in enumerate(names):
        by_name.setdefault(name, []).append(place)
    found = [(i, j) for a, b in pairs for i in by_name.get(a, ()) for j in by_name.get(b, ())]
    return np.array(found, np.intp).reshape(-1, 2)


@dataclass(frozen=True, slots=True)
class BodyDistance:
    """How far two bodies are apart.

    Args:
        first, second: their names.
        distance: [m], negative where they overlap.
    """

    first: str
    second: str
    distance: float


@dataclass(frozen=True, slots=True, eq=False)
class SolidBodies:
    """Convex solids by the names of the bodies that they belong to: one body may have several.

    Args:
        names: of each solid's body.
        solids: as many.
    """

    names: tuple[str, ...]
    solids: tuple[ConvexSolid, ...]

    @classmethod
    def of_tree(cls, tree: Tree) -> SolidBodies:
        """Those of a tree of numbers, by link; bare frames have none."""
        found = [(link.name, solid) for link in tree.links for solid in solids_of(link)]
        return cls(tuple(name for name, _ in found), tuple(solid for _, solid in found))

    def placed(self, frames: Mapping[str, Placement]) -> PlacedSolids:
        """The solids where the frames are that they belong to.

        Args:
            frames: world_from_body, by name; of numbers.
        """
        turns = np.array([frames[name].rotation for name in self.names], float)
        origins = np.array([frames[name].translation for name in self.names], float)
        local = [(solid.rotation, solid.position, solid.centre) for solid in self.solids]
        rotations, positions, centres = (np.array([each[k] for each in local]) for k in range(3))
        return PlacedSolids(
            self.names,
            self.solids,
            turns @ rotations,
            origins + (turns @ positions[:, :, None])[:, :, 0],
            origins + (turns @ centres[:, :, None])[:, :, 0],
        )


@dataclass(frozen=True, slots=True, eq=False)
class PlacedSolids:
    """Solids in the world.

    Args:
        names: of each solid's body.
        solids: as many.
        rotations, positions: world_from_geometry of each, shapes (n, 3, 3) and (n, 3) [m].
        centres: of the balls about them, shape (n, 3) [m].
    """

    names: tuple[str, ...]
    solids: tuple[ConvexSolid, ...]
    rotations: Array
    positions: Array
    centres: Array

    def named(self, name: Callable[[str], str]) -> PlacedSolids:
        """The same by other names."""
        return PlacedSolids(
            tuple(map(name, self.names)), self.solids, self.rotations, self.positions, self.centres
        )

    def beside(self, *others: PlacedSolids) -> PlacedSolids:
        """All together."""
        everyone = (self, *others)
        return PlacedSolids(
            tuple(name for each in everyone for name in each.names),
            tuple(solid for each in everyone for solid in each.solids),
            *(
                np.concatenate([getattr(each, k) for each in everyone])
                for k in ("rotations", "positions", "centres")
            ),
        )

    def nearest(self, places: Places) -> BodyDistance:
        """The nearest two bodies of some pairs.

        Args:
            places: of the pairs among the solids, at least one; see `places_of`.
        """
        order, gaps = self._by_balls(places)
        best = self._gap(places[order[0]])
        for at in order[1:]:
            if gaps[at] > best.distance:
                break
            best = min(best, self._gap(places[at]), key=lambda gap: gap.distance)
        return best

    def overlapping(self, places: Places) -> list[BodyDistance]:
        """Those of some pairs that overlap, once each."""
        order, gaps = self._by_balls(places)
        found: dict[tuple[str, str], BodyDistance] = {}
        for at in order:
            if gaps[at] >= 0.0:
                break
            gap = self._gap(places[at])
            known = found.get((gap.first, gap.second))
            if gap.distance < (0.0 if known is None else known.distance):
                found[gap.first, gap.second] = gap
        return list(found.values())

    def _by_balls(self, places: Places) -> tuple[list[int], Array]:
        """The order of pairs by the distances of the balls about them, and these [m]."""
        first, second = places.T
        radii = np.array([solid.radius for solid in self.solids])
        between = np.linalg.norm(self.centres[first] - self.centres[second], axis=1)
        gaps = between - radii[first] - radii[second]
        return np.argsort(gaps, kind="stable").tolist(), gaps

    def _gap(self, places: Places) -> BodyDistance:
        i, j = places.tolist()
        return BodyDistance(self.names[i], self.names[j], self._distance(i, j))

    def _distance(self, i: int, j: int) -> float:
        request, result = coal.DistanceRequest(), coal.DistanceResult()
        one, other = (self._geometry(place) for place in (i, j))
        return float(coal.distance(*one, *other, request, result))

    def _geometry(self, place: int) -> tuple[Any, Any]:
        where = coal.Transform3s(self.rotations[place], self.positions[place])
        return self.solids[place].geometry, where
