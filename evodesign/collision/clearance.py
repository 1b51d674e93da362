"""How far bodies are apart: the signed distance of the nearest two of many convex solids.

A distance is negative where two solids overlap: minus how deep they are in each other. Pairs are measured by
coal in the order of their bounding balls' distances, for as long as a nearer one may follow. A mesh is
its convex hull, and where hulls are in each other its triangles (`collision.triangles`).

Beyond 300 lines: distances of hulls and of triangles share placed solids and their order.

Source: coal (formerly hpp-fcl): Gilbert, Johnson and Keerthi (1988), and expanding polytopes.
"""

from __future__ import annotations

from collections.abc import Callable, Container, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import coal
import numpy as np
from numpy.typing import NDArray

from evodesign.body.placement import Placement
from evodesign.collision.rules import FLOOR
from evodesign.collision.shapes import Array, ConvexSolid, solids_of
from evodesign.collision.triangles import (
    PlacedBody,
    are_in_each_other,
    depth_along,
    distance_apart,
    triangles_in_link,
)
from evodesign.tree.model import Tree

UP = np.array([0.0, 0.0, 1.0])

WHETHER = coal.CollisionRequest()
"""Asks whether solids are in each other, not where."""

WHETHER.enable_contact = False

ACCURACY = 0.002
"""Of meshes, which have few triangles [m]: overlaps that are not deeper are none."""

Indices = NDArray[np.intp]
"""Places of solids."""

Places = NDArray[np.intp]
"""Pairs of solids by their places, shape (n, 2)."""

PosturePair = tuple[int, str, str]
"""A posture's place, and the names of two bodies."""


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


@dataclass(frozen=True, eq=False)
class SolidBodies:
    """Convex solids by the names of the bodies that they belong to: one body may have several.

    Args:
        names: of each solid's body.
        solids: as many.
    """

    names: tuple[str, ...]
    solids: tuple[ConvexSolid, ...]

    @classmethod
    def of_tree(cls, tree: Tree, only: Container[str] | None = None) -> SolidBodies:
        """Those of a tree of numbers, by link; bare frames have none.

        Args:
            tree: whose links they are.
            only: the links by name; None: all.
        """
        links = (link for link in tree.links if only is None or link.name in only)
        found = [(link.name, solid) for link in links for solid in solids_of(link)]
        return cls(tuple(name for name, _ in found), tuple(solid for _, solid in found))

    @property
    def hulls(self) -> SolidBodies:
        """The same without the triangles of meshes."""
        return SolidBodies(self.names, tuple(replace(solid, mesh=None) for solid in self.solids))

    def named(self, name: Callable[[str], str]) -> SolidBodies:
        """The same by other names."""
        return SolidBodies(tuple(map(name, self.names)), self.solids)

    def beside(self, *others: SolidBodies) -> SolidBodies:
        """All together."""
        everyone = (self, *others)
        return SolidBodies(
            tuple(name for each in everyone for name in each.names),
            tuple(solid for each in everyone for solid in each.solids),
        )

    def placed(self, frames: Mapping[str, Placement]) -> PlacedSolids:
        """The solids where the frames are that they belong to.

        Args:
            frames: world_from_body, by name; of numbers.
        """
        turns = np.array([frames[name].rotation for name in self.names], float).reshape(-1, 3, 3)
        origins = np.array([frames[name].translation for name in self.names], float).reshape(-1, 3)
        return self.placed_at(turns, origins)

    @cached_property
    def links(self) -> tuple[tuple[str, ...], Indices]:
        """The bodies' names, once each, and which of them each solid is of."""
        places = {name: place for place, name in enumerate(dict.fromkeys(self.names))}
        return tuple(places), np.array([places[name] for name in self.names], np.intp)

    def placed_at(self, turns: Array, origins: Array) -> PlacedSolids:
        """The solids where their bodies' frames are, once or in several postures.

        Args:
            turns: rotations world_from_body, shape (n, 3, 3) or (postures, n, 3, 3).
            origins: in the world [m], likewise.
        """
        rotations, points = self._local
        placed = (origins[..., None, :] + points @ np.swapaxes(turns, -1, -2)).reshape(-1, 3, 3)
        return PlacedSolids(self, (turns @ rotations).reshape(-1, 3, 3), *placed.transpose(1, 0, 2))

    @cached_property
    def radii(self) -> Array:
        """Of the balls about the solids [m]."""
        return np.array([solid.radius for solid in self.solids])

    @cached_property
    def half_sides(self) -> Array:
        """Of the boxes about the solids, shape (n, 3) [m]."""
        return np.array([solid.half_sides for solid in self.solids]).reshape(-1, 3)

    @cached_property
    def _local(self) -> tuple[Array, Array]:
        """Rotations, and the middles of geometries, balls and boxes, in the bodies' frames."""
        rotations = np.array([solid.rotation for solid in self.solids]).reshape(-1, 3, 3)
        points = [
            (solid.position, solid.centre, solid.position + solid.rotation @ solid.middle)
            for solid in self.solids
        ]
        return rotations, np.array(points).reshape(-1, 3, 3)


@dataclass(frozen=True, slots=True, eq=False)
class PlacedSolids:
    """Solids in the world, once or in several postures: n of each, one posture after the other.

    Args:
        bodies: what they are in a posture.
        rotations, positions: world_from_geometry of each, shapes (n, 3, 3) and (n, 3) [m].
        centres: of the balls about them, shape (n, 3) [m].
        middles: of the boxes about them, shape (n, 3) [m].
    """

    bodies: SolidBodies
    rotations: Array
    positions: Array
    centres: Array
    middles: Array

    @property
    def names(self) -> tuple[str, ...]:
        """Of each solid's body, in a posture."""
        return self.bodies.names

    def in_all(self, places: Places) -> Places:
        """Pairs of solids of a posture in all postures."""
        starts = np.arange(0, len(self.positions), max(len(self.names), 1))
        return (starts[:, None, None] + places).reshape(-1, 2)

    @property
    def postures(self) -> int:
        """How many."""
        return len(self.positions) // len(self.names) if self.names else 0

    def pair_of(self, i: int, j: int) -> PosturePair:
        """The posture of a pair of solids, and their bodies."""
        count = len(self.names)
        return i // count, self.names[i % count], self.names[j % count]

    def named(self, name: Callable[[str], str]) -> PlacedSolids:
        """The same by other names."""
        return replace(self, bodies=self.bodies.named(name))

    def beside(self, *others: PlacedSolids) -> PlacedSolids:
        """All together."""
        everyone = (self, *others)
        places = ("rotations", "positions", "centres", "middles")
        return PlacedSolids(
            self.bodies.beside(*(each.bodies for each in others)),
            *(np.concatenate([getattr(each, k) for each in everyone]) for k in places),
        )

    def nearest(self, places: Places) -> BodyDistance:
        """The nearest two bodies of some pairs.

        Args:
            places: of the pairs among the solids, at least one; see `places_of`.
        """
        gaps = self._balls_apart(places)
        order = np.argsort(gaps, kind="stable").tolist()
        best = self._gap(places[order[0]])
        for at in order[1:]:
            if gaps[at] > best.distance:
                break
            best = min(best, self._gap(places[at]), key=lambda gap: gap.distance)
        return best

    def overlapping(self, places: Places, within: float = 0.0) -> list[BodyDistance]:
        """Those of some pairs that are nearer to each other than a distance [m], once each.

        Where overlaps are asked for, those of meshes by less than their accuracy are left out.
        """
        return [
            BodyDistance(first, second, gap) for (_, first, second), gap in self.gaps(places, within).items()
        ]

    def gaps(self, places: Places, within: float) -> dict[PosturePair, float]:
        """How far the bodies of some pairs are apart that are nearer to each other than a distance [m]."""
        found: dict[PosturePair, float] = {}
        for i, j in self.near(places, within).tolist():
            pair, distance = self.pair_of(i, j), self._distance(i, j, within)
            if distance < found.get(pair, within):
                found[pair] = distance
        return found

    def in_each_other(self, places: Places, least: float = ACCURACY) -> set[PosturePair]:
        """Those of some pairs whose bodies are in each other, not asked how deep, which takes longest.

        Args:
            places: of the pairs among the solids.
            least: overlaps of meshes that are not deeper [m] are left out.
        Returns:
            The posture of each such pair, and the names of its bodies.
        """
        found: set[PosturePair] = set()
        for i, j in self.near(places, 0.0).tolist():
            pair = self.pair_of(i, j)
            if pair not in found and self._overlap(i, j, least):
                found.add(pair)
        return found

    def near(self, places: Places, within: float) -> Places:
        """Those of some pairs that may be nearer to each other than a distance [m]: by balls and boxes."""
        places = places[self._balls_apart(places) < within]
        return places[self._boxes_apart(places) < within]

    def near_floor(self, floor: Indices, within: float = 0.0) -> list[BodyDistance]:
        """Those of some solids that are nearer to the floor z = 0 than a distance [m]."""
        low = floor[self.centres[floor, 2] - self.bodies.radii[floor] < within].tolist()
        found = [BodyDistance(self.names[i], FLOOR, self._above_floor(i)) for i in low]
        return [gap for gap in found if gap.distance < within]

    def _above_floor(self, i: int) -> float:
        """How far a solid is above the floor [m]."""
        request, result, ground = coal.DistanceRequest(), coal.DistanceResult(), coal.Halfspace(UP, 0.0)
        return float(coal.distance(*self._geometry(i), ground, coal.Transform3s(), request, result))

    def _balls_apart(self, places: Places) -> Array:
        """How far the balls about pairs of solids are apart [m]."""
        first, second = places.T
        between = self.centres[first] - self.centres[second]
        distances = np.sqrt(np.einsum("ij,ij->i", between, between))
        return np.asarray(distances - self.bodies.radii[places % len(self.names)].sum(axis=1))

    def _boxes_apart(self, places: Places) -> Array:
        """How far the boxes about pairs of solids are apart at least [m]: along the normals of faces."""
        first, second = places.T
        half, other_half = (self.bodies.half_sides[place % len(self.names)] for place in places.T)
        one, other = self.rotations[first], self.rotations[second]
        between = self.middles[second] - self.middles[first]
        turned = np.abs(one.transpose(0, 2, 1) @ other)
        along_one = np.abs(np.einsum("pij,pi->pj", one, between)) - half
        along_one -= np.einsum("pij,pj->pi", turned, other_half)
        along_other = np.abs(np.einsum("pij,pi->pj", other, between)) - other_half
        along_other -= np.einsum("pij,pi->pj", turned, half)
        return np.asarray(np.maximum(along_one, along_other).max(axis=1, initial=-np.inf))

    def _gap(self, places: Places, within: float = np.inf) -> BodyDistance:
        i, j = places.tolist()
        _, first, second = self.pair_of(i, j)
        return BodyDistance(first, second, self._distance(i, j, within))

    def _distance(self, i: int, j: int, within: float) -> float:
        """How far two solids are apart [m]; of meshes that are not in each other, no nearer than that."""
        distance, way, *_ = self.parted(i, j)
        if distance >= 0.0 or not self._has_mesh(i, j):
            return distance
        one, other = self._body(i), self._body(j)
        if self._meshes_overlap(one, other, distance, way, ACCURACY if within <= 0.0 else 0.0):
            return -depth_along(one, other, way, -distance)
        return distance_apart(one, other) if within > 0.0 else 0.0

    def _overlap(self, i: int, j: int, least: float) -> bool:
        """Whether two solids are in each other; meshes by more than `least` [m]."""
        if not coal.collide(*self._geometry(i), *self._geometry(j), WHETHER, coal.CollisionResult()):
            return False
        if not self._has_mesh(i, j):
            return True
        distance, way, *_ = self.parted(i, j)
        return self._meshes_overlap(self._body(i), self._body(j), distance, way, least)

    @staticmethod
    def _meshes_overlap(
        one: PlacedBody, other: PlacedBody, distance: float, way: Array, least: float
    ) -> bool:
        """Whether bodies with hulls at a distance [m] along a way are in each other by more than `least`."""
        if least > 0.0 and (distance > -least or not are_in_each_other(one, other.moved(least * way))):
            return False
        return are_in_each_other(one, other)

    def _body(self, place: int) -> PlacedBody:
        """A solid by its triangles, if it has any."""
        solid = self.solid(place)
        triangles = triangles_in_link(solid.mesh) if solid.mesh else None
        geometry = triangles.geometry if triangles else solid.geometry
        return PlacedBody(geometry, self.rotations[place], self.positions[place], triangles)

    def parted(self, i: int, j: int) -> tuple[float, Array, int, int]:
        """How far two convex solids are apart [m], the unit vector that parts them most, and their places.

        A mesh is its hull.
        """
        request, result = coal.DistanceRequest(), coal.DistanceResult()
        one, other = (self._geometry(place) for place in (i, j))
        return float(coal.distance(*one, *other, request, result)), np.array(result.normal), i, j

    def _geometry(self, place: int) -> tuple[Any, Any]:
        return self.solid(place).geometry, coal.Transform3s(self.rotations[place], self.positions[place])

    def _has_mesh(self, i: int, j: int) -> bool:
        return self.solid(i).mesh is not None or self.solid(j).mesh is not None

    def solid(self, place: int) -> ConvexSolid:
        """What stands at a place."""
        return self.bodies.solids[place % len(self.names)]
