"""Limbs of a robot: chains of bodies, and pairs of them that are mirror images of each other."""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Iterator
from dataclasses import dataclass

from evodesign.body.placement import Vector
from evodesign.tree.welded import WeldedBody, WeldedTree

__all__ = [
    "FEWEST_JOINTS",
    "Limb",
    "height_of",
    "limb_from",
    "limb_pairs",
    "lowest_of",
    "lowest_of_all",
    "mass_of",
    "shares_bodies",
]

FEWEST_JOINTS = 3
"""Joints of a limb."""

LOPSIDED = 0.02
"""Largest distance of a limb's beginning from the mirror image of the other's [m]."""

GRASPING = re.compile(r"finger|thumb|gripper|claw|jaw|palm_joint|index|middle|ring|pinky", re.IGNORECASE)
"""Names of what is moved by a hand, and no part of an arm."""


@dataclass(frozen=True, slots=True)
class Limb:
    """The bodies of a leg or an arm, from hip or shoulder to foot or hand."""

    bodies: tuple[WeldedBody, ...]

    @property
    def joints(self) -> tuple[str, ...]:
        """Names of the joints that move them."""
        return tuple(body.joint.name for body in self.bodies if body.joint is not None)

    @property
    def end(self) -> WeldedBody:
        """Foot or hand."""
        return self.bodies[-1]

    @property
    def bend(self) -> int:
        """Index of the body that knee or elbow moves: its joint is farthest from both ends."""
        first, last = self.bodies[0].origin, self.end.inertia.center
        return max(
            range(1, len(self.bodies)),
            key=lambda i: min(
                math.dist(self.bodies[i].origin, first), math.dist(self.bodies[i].origin, last)
            ),
        )


def limb_pairs(welded: WeldedTree) -> Iterator[tuple[str, str]]:
    """Bodies of one parent that begin chains of joints at mirrored places, across x or y."""
    for names in welded.children.values():
        for one, other in itertools.combinations(names, 2):
            if min(_depth(welded, one), _depth(welded, other)) < FEWEST_JOINTS:
                continue
            if any(
                _mirrored(welded.bodies[one].origin, welded.bodies[other].origin, axis) for axis in (0, 1)
            ):
                yield one, other


def _mirrored(one: Vector, other: Vector, axis: int) -> bool:
    """Whether a point is the mirror image of another across an axis of the root, and off its plane."""
    image = [-value if i == axis else value for i, value in enumerate(one)]
    return math.dist(image, other) < LOPSIDED and abs(one[axis] - other[axis]) > LOPSIDED


def _depth(welded: WeldedTree, name: str) -> int:
    return 1 + max((_depth(welded, child) for child in welded.children[name]), default=0)


def mass_of(welded: WeldedTree, name: str) -> float:
    return sum(float(body.inertia.mass) for body in welded.beyond(name))


def lowest_of(welded: WeldedTree, pair: tuple[str, str]) -> float:
    """The lowest centre of mass of a pair's bodies [m]."""
    return max(min(float(body.inertia.center[2]) for body in welded.beyond(name)) for name in pair)


def lowest_of_all(welded: WeldedTree) -> float:
    return min(float(body.inertia.center[2]) for body in welded.bodies.values() if body.inertia.mass)


def height_of(welded: WeldedTree) -> float:
    heights = [float(body.inertia.center[2]) for body in welded.bodies.values() if body.inertia.mass]
    return max(heights) - min(heights)


def shares_bodies(welded: WeldedTree, pair: tuple[str, str], legs: tuple[str, str]) -> bool:
    """Whether a pair is part of a leg, or carries the legs."""
    bodies = {body.name for name in legs for body in welded.beyond(name)}
    return any(body.name in bodies for name in pair for body in welded.beyond(name))


def limb_from(welded: WeldedTree, name: str, *, low: bool) -> Limb:
    """The bodies from a limb's first to its foot (the lowest way) or its hand (where it divides)."""
    bodies = [welded.bodies[name]]
    while children := welded.children[bodies[-1].name]:
        if low:
            below = {
                child: min(body.inertia.center[2] for body in welded.beyond(child)) for child in children
            }
            bodies.append(welded.bodies[min(children, key=below.__getitem__)])
        elif len(children) == 1 and not _grasps(welded.bodies[children[0]]):
            bodies.append(welded.bodies[children[0]])
        else:
            break
    return Limb(tuple(bodies))


def _grasps(body: WeldedBody) -> bool:
    return body.joint is not None and any(GRASPING.search(name) for name in (body.name, body.joint.name))
