"""Legs, arms, trunk and heading of a humanoid, from the places of its joints and the masses of its links.

limbs      two chains of at least three joints on one parent that are mirror images of each other (`limbs`):
           legs are those that reach lowest, arms the heaviest others. Legs begin at the trunk's lower end and
           point down; what begins at its upper end are arms, of a robot without legs
trunk      the bodies from the one that the legs are joined to to the one that the arms are joined to
heading    across the line between the hips; forward is from where a bent knee takes the foot away, what
           makes the side called left the left one, and where the feet reach beyond the ankles
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from evodesign.body.inertia import total
from evodesign.body.placement import Placement, Vector
from evodesign.errors import ModelError
from evodesign.guess.limbs import FEWEST_JOINTS, Limb, LimbPair, limb_from, limb_pairs
from evodesign.mechanics.agent import SIDES
from evodesign.problem.agent_tables import Facing
from evodesign.tree.frames import link_frames
from evodesign.tree.model import JointKind, Tree
from evodesign.tree.welded import WeldedBody, WeldedTree

SIGNIFICANT = 0.005
"""Distance [m] below which feet and knees say nothing of the heading."""

DOWN = 0.5
"""Least cosine between the way from hips to feet and down, and between the ways of two limbs."""

HANGING = 0.2
"""Lengths of a limb by which the trunk reaches below shoulders, but not below hips."""

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
    def stature(self) -> float:
        """From the lowest to the highest joint or centre of mass of a body [m]."""
        solid = [body for body in self.welded.bodies.values() if body.inertia.mass]
        heights = [float(body.inertia.center[2]) for body in solid]
        heights += [float(body.origin[2]) for body in solid if body.joint is not None]
        return max(heights) - min(heights)

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
        ModelError: it has no masses or no two legs, or does not stand on them with z up.
    """
    welded = WeldedTree(tree)
    pairs = sorted(limb_pairs(welded), key=lambda pair: pair.lowest)
    legs = _legs(welded, pairs)
    others = [pair for pair in pairs if pair.axis == legs.axis and not pair.bodies & legs.bodies]
    arms = max(others, key=lambda pair: pair.mass, default=None)
    leg_limbs = [limb_from(welded, name, low=True) for name in legs.names]
    facing, why = _facing(welded, leg_limbs, legs.axis)
    look = (facing or Facing.FORWARD).ahead
    return BodyPlan(
        welded,
        _by_side(leg_limbs, look),
        {} if arms is None else _by_side([limb_from(welded, name, low=False) for name in arms.names], look),
        _trunk(welded, legs.names[0], None if arms is None else arms.names[0]),
        facing,
        why,
    )


def _legs(welded: WeldedTree, pairs: Sequence[LimbPair]) -> LimbPair:
    """The pair of limbs that reaches lowest, or the reason why it carries no humanoid."""
    solid = [body for body in welded.bodies.values() if body.inertia.mass]
    if not solid:
        raise ModelError(welded.tree.name, "", "links with masses", "none")
    lowest = min(solid, key=lambda body: float(body.inertia.center[2]))
    bottom = float(lowest.inertia.center[2])
    near = 0.1 * (max(float(body.inertia.center[2]) for body in solid) - bottom)
    wanted = f"two legs, mirror images of each other, of at least {FEWEST_JOINTS} joints to a lowest link"
    if not pairs or pairs[0].lowest > bottom + near:
        lies = any(math.hypot(*pair.direction) > DOWN for pair in limb_pairs(welded, (2,)))
        why = (
            "limbs are mirror images across z, which is to be up"
            if lies
            else f"the lowest link is '{lowest.name}'"
        )
        raise ModelError(welded.tree.name, "", wanted, f"none ({why})")
    legs = pairs[0]
    first, second = legs.names
    if -legs.direction[2] < DOWN:
        wanted = "legs that point down while all joints are at zero, with z up in the root link"
        raise ModelError(welded.tree.name, "", wanted, f"'{first}' and '{second}', which do not")
    if any(pair.lowest < legs.lowest + near and not pair.bodies & legs.bodies for pair in pairs):
        raise ModelError(welded.tree.name, "", "two legs", "four or more")
    if (below := _trunk_below(welded, pairs)) is not None:
        why = f"'{first}' and '{second}' are arms, which begin above '{below.name}'"
        raise ModelError(welded.tree.name, "", wanted, f"none ({why})")
    return legs


def _trunk_below(welded: WeldedTree, pairs: Sequence[LimbPair]) -> WeldedBody | None:
    """The lowest body of the trunk if the lowest limbs are arms: hips are at its lower end, shoulders not."""
    legs, limbs = pairs[0], frozenset().union(*(pair.bodies for pair in pairs))
    trunk = [body for name, body in welded.bodies.items() if name not in limbs and body.inertia.mass]
    if not trunk:
        return None
    lowest = min(trunk, key=lambda body: float(body.inertia.center[2]))
    depth = legs.begins - float(lowest.inertia.center[2])
    middle = float(total([body.inertia for body in trunk]).center[2])
    return lowest if middle < legs.begins and depth > HANGING * legs.limbs[0].length else None


def _trunk(welded: WeldedTree, leg: str, arm: str | None) -> tuple[WeldedBody, ...]:
    """The bodies from the one that a leg is joined to to the one that an arm is joined to."""
    root = welded.body_of(welded.tree.root)
    below, above = ((root, *welded.chain(name)[:-1]) for name in (leg, arm or leg))
    same = sum(one is other for one, other in zip(below, above, strict=False))
    return (*reversed(below[same:]), *above[same - 1 :])


def _by_side(limbs: list[Limb], look: Vector) -> dict[str, Limb]:
    """Limbs by side: left is the side to which (-look_y, look_x) points."""
    ordered = sorted(limbs, key=lambda limb: look[1] * limb.middle[0] - look[0] * limb.middle[1])
    return dict(zip(SIDES, ordered, strict=True))


def _facing(welded: WeldedTree, legs: list[Limb], lateral: int) -> tuple[Facing | None, str]:
    """The heading for which most of knees, names and feet speak; knees count most, feet least."""
    one, other = (leg.middle for leg in legs)
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


def opposite_knees(plan: BodyPlan) -> tuple[str, ...]:
    """Names of the knees where one bends ahead and the other back; none otherwise."""
    knees = [leg.bodies[leg.bend].joint for leg in plan.legs.values()]
    bent = [_bent(plan.welded, leg, Facing.FORWARD.ahead) for leg in plan.legs.values()]
    sideways = [_bent(plan.welded, leg, Facing.LEFT.ahead) for leg in plan.legs.values()]
    opposite = any(min(ways) < -SIGNIFICANT and max(ways) > SIGNIFICANT for ways in (bent, sideways))
    return tuple(knee.name for knee in knees if knee is not None) if opposite else ()


SIDE_NAMES = (("left", "right"), ("Left", "Right"), ("LEFT", "RIGHT"), ("l", "r"), ("L", "R"))


def _named_side(one: Limb, other: Limb) -> int:
    """1 if the names say that the first limb is the left one, -1 if the right one, 0 if they say nothing."""
    for left, right in SIDE_NAMES:
        for first, second, sign in ((one.end.name, other.end.name, 1), (other.end.name, one.end.name, -1)):
            ends = [match.end() for match in re.finditer(left, first)]
            others = [first[: end - len(left)] + right + first[end:] for end in ends]
            if second in (*others, first.replace(left, right)) and ends:
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
    bent, straight = link_frames(welded.tree, Placement(), {joint.name: angle}), welded.places
    moved, center = bent[leg.end.name] @ straight[leg.end.name].inverse, leg.end.inertia.center
    return -_along(moved.apply(center), center, ahead)
