"""Legs, arms, trunk and heading of a humanoid, from the places of its joints and the masses of its links.

limbs      two bodies of one parent whose joints are mirror images of each other, with chains of at least
           three joints: legs are those that reach lowest, arms the heaviest others, joined higher up
trunk      the bodies from the one that the legs are joined to to the one that the arms are joined to
heading    across the line between the hips; forward is from where a bent knee takes the foot away, what
           makes the side called left the left one, and where the feet reach beyond the ankles
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass

from evodesign.body.placement import Placement, Vector
from evodesign.errors import ModelError
from evodesign.mechanics.scene import SIDES
from evodesign.problem.file import Facing
from evodesign.problem.guess.limbs import (
    FEWEST_JOINTS,
    Limb,
    height_of,
    limb_from,
    limb_pairs,
    lowest_of,
    lowest_of_all,
    mass_of,
    shares_bodies,
)
from evodesign.tree.frames import link_frames
from evodesign.tree.model import JointKind, Tree
from evodesign.tree.welded import WeldedBody, WeldedTree

__all__ = ["BodyPlan", "body_plan"]

SIGNIFICANT = 0.005
"""Distance [m] below which feet and knees say nothing of the heading."""

BEND = 0.5
"""Angle by which a knee is bent to see where the foot goes [rad]."""

ONE_WAY = 1.3
"""How much larger a knee's range must be in one direction than in the other."""


@dataclass(frozen=True, slots=True)
class BodyPlan:
    """What is where in a robot.

    Args:
        welded: its rigid bodies.
        legs, arms: limbs by side, seen by the robot; no arms if none were found.
        trunk: bodies from hips to shoulders.
        facing: the direction in which it looks; None if nothing says so.
        why: how that is known, in words.
    """

    welded: WeldedTree
    legs: Mapping[str, Limb]
    arms: Mapping[str, Limb]
    trunk: tuple[WeldedBody, ...]
    facing: Facing | None
    why: str

    @property
    def joints(self) -> tuple[str, ...]:
        """Names of the joints between hands and feet, in the file's order."""
        moving = {joint for limb in (*self.legs.values(), *self.arms.values()) for joint in limb.joints}
        inside = {name for body in self.trunk for name in body.links}
        moving |= {body.joint.name for body in self.trunk if body.joint and body.joint.parent in inside}
        return tuple(name for name in self.welded.tree.actuated if name in moving)


def body_plan(tree: Tree) -> BodyPlan:
    """The body plan of a robot of numbers.

    Raises:
        ModelError: it has no two legs.
    """
    welded = WeldedTree(tree)
    pairs = sorted(limb_pairs(welded), key=lambda pair: lowest_of(welded, pair))
    if not pairs or lowest_of(welded, pairs[0]) > lowest_of_all(welded) + 0.1 * height_of(welded):
        wanted = f"two legs, mirror images of each other, of at least {FEWEST_JOINTS} joints to a lowest link"
        lowest = min(welded.bodies.values(), key=lambda body: body.inertia.center[2])
        raise ModelError(tree.name, "", wanted, f"none (the lowest link is '{lowest.name}')")
    legs, others = pairs[0], [pair for pair in pairs[1:] if not shares_bodies(welded, pair, pairs[0])]
    if any(lowest_of(welded, pair) < lowest_of(welded, legs) + 0.1 * height_of(welded) for pair in others):
        raise ModelError(tree.name, "", "two legs", "four or more")
    arms = max(others, key=lambda pair: mass_of(welded, pair[0]), default=None)
    leg_limbs = [limb_from(welded, name, low=True) for name in legs]
    facing, why = _facing(welded, leg_limbs)
    look = (facing or Facing.FORWARD).ahead
    return BodyPlan(
        welded,
        _by_side(leg_limbs, look),
        {} if arms is None else _by_side([limb_from(welded, name, low=False) for name in arms], look),
        _trunk(welded, legs[0], None if arms is None else arms[0]),
        facing,
        why,
    )


def _trunk(welded: WeldedTree, leg: str, arm: str | None) -> tuple[WeldedBody, ...]:
    """The bodies from the one that a leg is joined to to the one that an arm is joined to."""
    root = welded.body_of(welded.tree.root)
    below, above = ((root, *welded.chain(name)[:-1]) for name in (leg, arm or leg))
    same = sum(one is other for one, other in zip(below, above, strict=False))
    return (*reversed(below[same:]), *above[same - 1 :])


def _by_side(limbs: list[Limb], look: Vector) -> dict[str, Limb]:
    """Limbs by side: left is the side to which (-look_y, look_x) points."""
    ordered = sorted(
        limbs, key=lambda limb: look[1] * limb.bodies[0].origin[0] - look[0] * limb.bodies[0].origin[1]
    )
    return dict(zip(SIDES, ordered, strict=True))


def _facing(welded: WeldedTree, legs: list[Limb]) -> tuple[Facing | None, str]:
    """The heading for which most of knees, names and feet speak; knees count most, feet least."""
    one, other = (leg.bodies[0].origin for leg in legs)
    lateral = 0 if abs(one[0] - other[0]) > abs(one[1] - other[1]) else 1
    choices = (Facing.FORWARD, Facing.BACK) if lateral == 1 else (Facing.LEFT, Facing.RIGHT)
    ahead = choices[0].ahead
    to_the_left = (-ahead[1], ahead[0], 0.0)
    said = {
        "knees": (2.5, sum(_bent(welded, leg, ahead) for leg in legs) / 2.0),
        "names of the sides": (2.0, _named_side(*legs) * _along(one, other, to_the_left)),
        "feet": (1.0, sum(_along(leg.end.inertia.center, leg.end.origin, ahead) for leg in legs) / 2.0),
    }
    votes = {
        part: math.copysign(weight, value)
        for part, (weight, value) in said.items()
        if abs(value) > SIGNIFICANT
    }
    if not votes:
        return None, "knees, names and feet do not say where it looks"
    facing = choices[0 if sum(votes.values()) > 0.0 else 1]
    agree = [part for part, vote in votes.items() if vote * sum(votes.values()) > 0.0]
    against = [part for part in votes if part not in agree]
    but = f", but not {' and '.join(against)}" if against else ""
    return facing, f"{' and '.join(agree)} say so{but}"


SIDE_NAMES = (("left", "right"), ("Left", "Right"), ("LEFT", "RIGHT"), ("l", "r"), ("L", "R"))


def _named_side(one: Limb, other: Limb) -> int:
    """1 if the names say that the first limb is the left one, -1 if the right one, 0 if they say nothing."""
    for left, right in SIDE_NAMES:
        for first, second, sign in ((one.end.name, other.end.name, 1), (other.end.name, one.end.name, -1)):
            ends = [match.end() for match in re.finditer(left, first)]
            if any(first[: end - len(left)] + right + first[end:] == second for end in ends):
                return sign
    return 0


def _along(point: Vector, origin: Vector, direction: Vector) -> float:
    return float(sum((a - b) * d for a, b, d in zip(point, origin, direction, strict=True)))


def _bent(welded: WeldedTree, leg: Limb, ahead: Vector) -> float:
    """How far the knee comes ahead of the foot when it bends to where its range is larger [m]."""
    joint = leg.bodies[leg.bend].joint
    if joint is None or joint.kind is JointKind.PRISMATIC or not math.isfinite(joint.upper - joint.lower):
        return 0.0
    if max(joint.upper, -joint.lower) < ONE_WAY * min(joint.upper, -joint.lower):
        return 0.0
    angle = BEND if joint.upper > -joint.lower else -BEND
    bent = link_frames(welded.tree, Placement(), {joint.name: angle})[leg.end.name].translation
    return -_along(bent, leg.end.origin, ahead)
