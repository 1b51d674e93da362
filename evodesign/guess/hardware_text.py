"""The part of a new problem file that is commented out: walls, actuators, and postures that size them.

A line that begins with `#` and no space behind it is part of the problem as soon as its `#` is gone.

    walls        of all links that are made of shapes, 2 mm of aluminium
    actuators    one for each group of joints: hip, knee, ankle, shoulder, elbow, torso
    squat        both knees bent by 45 degrees and the hips by 35, balanced by the ankles
    one leg      the right knee bent by 60 degrees and its hip by 30, balanced by the left ankle
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from textwrap import wrap

from evodesign.body.placement import Placement, Vector, dot, rotate
from evodesign.guess.body_plan import BodyPlan
from evodesign.guess.limbs import Limb
from evodesign.mechanics.agent import SIDES
from evodesign.problem.agent_tables import Facing
from evodesign.tree.frames import link_frames
from evodesign.tree.model import Joint

ALONG = 0.7
"""Least cosine between a joint's axis and the direction about which it turns."""

WALL, THINNEST = 0.002, 0.01
"""Thickness of a wall, and the smallest dimension of a shape that has room for two [m]."""

SQUAT, ONE_LEG = (45.0, 35.0), (60.0, 30.0)
"""Angles of knee and hip [degrees]."""

PROBED = 0.3
"""Angle by which a hip is turned to see where the knee goes [rad]."""

WIDTH = 96
"""Letters of a line of names."""


def hardware_text(plan: BodyPlan) -> Iterator[str]:
    """The lines."""
    yield ""
    yield "# Hardware: part of the problem once each line that begins with # and no space has lost its #."
    yield "# Actuators add their mass to the links', of which 0.3 stay beside a wall (docs/hardware.md)."
    yield from _walls(plan)
    for name, joints in _joint_groups(plan).items():
        yield from ("#", "#[[design.actuator]]", f'#name = "{name}"', *_named("joints", joints))
        yield "#margin = [1.0, 4.0]  # rated torque over what the lift and the load cases ask"
    yield from _load_cases(plan)


def _named(key: str, names: Iterable[str]) -> Iterator[str]:
    """A list of names, over as many lines as it takes."""
    names = [*names]
    if len(line := f"{key} = {json.dumps(names)}") <= WIDTH:
        yield f"#{line}"
        return
    yield f"#{key} = ["
    for line in wrap(
        ", ".join(map(json.dumps, names)), WIDTH, break_long_words=False, break_on_hyphens=False
    ):
        yield f"#{line.removesuffix(',')},"
    yield "#]"


def _walls(plan: BodyPlan) -> Iterator[str]:
    links = [
        link.name
        for link in plan.welded.tree.links
        if link.solids and min(float(solid.shape.least_width) for solid in link.solids) >= THINNEST
    ]
    if not links:
        yield "#"
        yield "# no [[design.wall]]: that is for links of boxes, cylinders and spheres. Others keep their"
        yield "# mass, in which a real robot's motors are: with actuators they count twice."
        return
    yield from ("#", "#[[design.wall]]", '#name = "links"', *_named("links", links))
    yield from (f"#thickness_m = {WALL}", '#material = "aluminium_6061"')


def _joint_groups(plan: BodyPlan) -> Mapping[str, tuple[str, ...]]:
    """Joints by the part of the body that they move, left ones first."""
    found: dict[str, list[str]] = {}
    for limbs, names in ((plan.legs, ("hip", "knee", "ankle")), (plan.arms, ("shoulder", "elbow", "elbow"))):
        for limb in limbs.values():
            bend = limb.bend
            for name, joints in zip(
                names,
                (limb.joints[:bend], limb.joints[bend : bend + 1], limb.joints[bend + 1 :]),
                strict=True,
            ):
                found.setdefault(name, []).extend(joints)
    taken = {joint for joints in found.values() for joint in joints}
    found["torso"] = [joint for joint in plan.joints if joint not in taken]
    return {name: tuple(joints) for name, joints in found.items() if joints}


def _load_cases(plan: BodyPlan) -> Iterator[str]:
    pitches = {side: _about(plan, leg, leg.bend + 1, across=True) for side, leg in plan.legs.items()}
    rolls = {side: _about(plan, leg, leg.bend + 1, across=False) for side, leg in plan.legs.items()}
    bent = {side: _bent(plan, leg, *SQUAT) for side, leg in plan.legs.items()}
    left, right = SIDES
    if not all(pitches.values()) or not all(bent.values()):
        yield "#"
        yield "# no [[load_case]]: hips and ankles have no joints about the line from left to right"
        return
    both = {joint: angle for side in SIDES for joint, angle in bent[side].items()}
    yield from _load_case("squat", both, [[pitches[side] for side in SIDES]])
    if rolls[left]:
        lifted = _bent(plan, plan.legs[right], *ONE_LEG)
        yield from _load_case("one leg", lifted, [[pitches[left]], [rolls[left]]], f'#feet = "{left}"')


def _load_case(
    name: str, angles: Mapping[str, float], balance: Sequence[Sequence[str]], *more: str
) -> Iterator[str]:
    """A posture in which the robot stands alone."""
    given = ", ".join(f"{json.dumps(joint)} = {angle:g}" for joint, angle in angles.items())
    yield from ("#", "#[[load_case]]", f'#name = "{name}"', *more)
    yield f"#joints_deg = {{ {given} }}"
    yield f"#balance = {json.dumps(balance)}"


def _about(plan: BodyPlan, limb: Limb, first: int, *, across: bool) -> str:
    """The first joint of a limb, from one on, that turns about left (across) or ahead; else nothing."""
    ahead = (plan.facing or Facing.FORWARD).ahead
    wanted: Vector = (-ahead[1], ahead[0], 0.0) if across else ahead
    for body in limb.bodies[first:]:
        joint = body.joint
        if joint is not None:
            axis = rotate(plan.welded.places[joint.child].rotation, joint.axis)
            if abs(float(dot(axis, wanted))) > ALONG:
                return joint.name
    return ""


def _bent(plan: BodyPlan, leg: Limb, knee_deg: float, hip_deg: float) -> dict[str, float]:
    """Angles [degrees] of a leg that is lifted ahead and bent, within its limits; none if no hip does so."""
    joints, knee = plan.welded.tree.joint_by_name, leg.joints[leg.bend]
    hip = _about(plan, leg, 0, across=True)
    if hip not in leg.joints[: leg.bend]:
        return {}
    ahead = (plan.facing or Facing.FORWARD).ahead
    frames = link_frames(plan.welded.tree, Placement(), {hip: PROBED})
    forward = dot(frames[leg.bodies[leg.bend].name].translation, ahead) > dot(
        leg.bodies[leg.bend].origin, ahead
    )
    folds = joints[knee].upper > -joints[knee].lower
    return {
        knee: _within(joints[knee], knee_deg if folds else -knee_deg),
        hip: _within(joints[hip], hip_deg if forward else -hip_deg),
    }


def _within(joint: Joint, degrees: float) -> float:
    """An angle, or the whole degrees next to it within a joint's limits."""
    lower, upper = math.degrees(joint.lower), math.degrees(joint.upper)
    if lower <= degrees <= upper:
        return degrees
    return float(math.ceil(lower) if degrees < lower else math.floor(upper))
