"""Limbs of a robot: chains of bodies, and pairs of them that are mirror images of each other.

Two bodies that one parent carries begin a pair of limbs if their whole chains are mirror images across a
plane through the root: every chain is followed to its far end, and the mean distance of one chain's joints
from the mirror images of the other's is small beside the chains' length. Where the chains begin does not
matter: both shoulders may be on the plane.
"""

from __future__ import annotations

import functools
import itertools
import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

from evodesign.body.placement import Vector, add, scale
from evodesign.tree.welded import WeldedBody, WeldedTree

FEWEST_JOINTS = 3
"""Joints of a limb."""

UNLIKE = 0.05
"""Largest mean distance of a limb's joints from the mirror images of the other's, in lengths of the limb."""

APART = 0.05
"""Least mean distance between the two limbs' joints across the plane, likewise."""

MAIN = 0.8
"""Share of what a body carries beyond which it is the limb that goes on, and not one of several fingers."""

GRASPING = re.compile(r"finger|thumb|gripper|claw|jaw|palm_joint|index|middle|ring|pinky", re.IGNORECASE)
"""Names of what is moved by a hand, and no part of an arm."""

Axis = Literal[0, 1, 2]
"""x, y or z of the root."""


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
    def points(self) -> tuple[Vector, ...]:
        """Where its joints are, and the centre of mass of its end."""
        return (*(body.origin for body in self.bodies), self.end.inertia.center)

    @property
    def length(self) -> float:
        """From joint to joint, and to the centre of mass of its end [m]."""
        return sum(math.dist(one, other) for one, other in itertools.pairwise(self.points))

    @property
    def middle(self) -> Vector:
        """Mean of its points, which is beside the plane between two limbs whose first joints are on it."""
        return scale(1.0 / len(self.points), functools.reduce(add, self.points))

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


@dataclass(frozen=True, slots=True)
class LimbPair:
    """Two limbs that are mirror images of each other.

    Args:
        welded: the robot's bodies.
        limbs: both, each along its longest way.
        axis: of the root, across which they are.
    """

    welded: WeldedTree
    limbs: tuple[Limb, Limb]
    axis: Axis

    @property
    def names(self) -> tuple[str, str]:
        """Of their first bodies."""
        return self.limbs[0].bodies[0].name, self.limbs[1].bodies[0].name

    @property
    def bodies(self) -> frozenset[str]:
        """Names of all bodies of both."""
        return frozenset(body.name for name in self.names for body in self.welded.beyond(name))

    @property
    def mass(self) -> float:
        """Of the first one [kg]."""
        return sum(float(body.inertia.mass) for body in self.welded.beyond(self.names[0]))

    @property
    def begins(self) -> float:
        """Mean height of their first joints [m]."""
        return sum(float(limb.bodies[0].origin[2]) for limb in self.limbs) / 2.0

    @property
    def lowest(self) -> float:
        """The lowest centre of mass of their bodies, of the two limbs the higher one [m]."""
        return max(
            min(float(body.inertia.center[2]) for body in self.welded.beyond(name)) for name in self.names
        )

    @property
    def direction(self) -> Vector:
        """Mean way from the first joints to the ends, in ways: shorter than 1 where the limbs part."""
        ways = [add(limb.points[-1], scale(-1.0, limb.points[0])) for limb in self.limbs]
        return scale(1.0 / max(sum(math.hypot(*way) for way in ways), 1e-9), add(*ways))


def limb_pairs(welded: WeldedTree, axes: Sequence[Axis] = (0, 1)) -> Iterator[LimbPair]:
    """Every two bodies of one parent that begin chains of joints which are mirror images across an axis."""
    for names in welded.children.values():
        limbs = [Limb(_longest_way(welded, name)) for name in names]
        long = [limb for limb in limbs if len(limb.bodies) >= FEWEST_JOINTS]
        for one, other in itertools.combinations(long, 2):
            for axis in axes:
                if _mirrored(one, other, axis):
                    yield LimbPair(welded, (one, other), axis)


def _longest_way(welded: WeldedTree, name: str) -> tuple[WeldedBody, ...]:
    """The bodies from one to the end of the longest chain of joints that it carries."""
    body = welded.bodies[name]
    ways = [(body, *_longest_way(welded, child)) for child in welded.children[name]]
    return max(ways, key=lambda way: Limb(way).length, default=(body,))


def _mirrored(one: Limb, other: Limb, axis: Axis) -> bool:
    """Whether a limb is the mirror image of another across an axis of the root, and apart from it."""
    pairs = [*zip(one.points, other.points, strict=False)]
    length = min(one.length, other.length)
    images = [tuple(-value if i == axis else value for i, value in enumerate(point)) for point, _ in pairs]
    away = sum(math.dist(image, point) for image, (_, point) in zip(images, pairs, strict=True)) / len(pairs)
    apart = abs(sum(float(a[axis] - b[axis]) for a, b in pairs)) / len(pairs)
    return away < UNLIKE * length and apart > APART * length


def limb_from(welded: WeldedTree, name: str, *, low: bool) -> Limb:
    """The bodies from a limb's first to its foot (the lowest way) or its hand (where it divides).

    An arm does not divide where one of its branches carries nearly everything: beside a rod of an open
    linkage it goes on.
    """
    bodies = [welded.bodies[name]]
    while children := welded.children[bodies[-1].name]:
        carried = {child: [*welded.beyond(child)] for child in children}
        if low:
            lowest = {
                child: min(body.inertia.center[2] for body in beyond) for child, beyond in carried.items()
            }
            bodies.append(welded.bodies[min(children, key=lowest.__getitem__)])
            continue
        masses = {
            child: sum(float(body.inertia.mass) for body in beyond) for child, beyond in carried.items()
        }
        main = max(children, key=masses.__getitem__)
        if masses[main] < MAIN * sum(masses.values()) or _grasps(welded.bodies[main]):
            break
        bodies.append(welded.bodies[main])
    return Limb(tuple(bodies))


def _grasps(body: WeldedBody) -> bool:
    return body.joint is not None and any(GRASPING.search(name) for name in (body.name, body.joint.name))
