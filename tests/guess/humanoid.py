"""A small humanoid of boxes, turned, named and ordered in any way."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from random import Random

from evodesign.body.placement import Placement, Vector
from evodesign.body.shape import Box, Solid
from evodesign.tree.model import Joint, JointKind, Link, Tree

SIDE = {"left": 1.0, "right": -1.0}


@dataclass(frozen=True)
class Build:
    """How a humanoid is built.

    Args:
        yaw: by which all of it is turned about z in its root's frame [rad].
        named: what a side is called in names.
        knee: range of the knees [rad], about an axis to the left.
        toe: how far the feet's boxes reach ahead of the ankles' middle [m].
        arms, legs: whether it has any.
        horse: whether the legs are doubled.
        midline: whether both shoulders begin on the plane between left and right.
        order: in which links and joints stand in the file.
    """

    yaw: float = 0.0
    named: Callable[[str], str] = lambda side: f"{side}_"
    knee: tuple[float, float] = (-0.05, 2.4)
    toe: float = 0.05
    arms: bool = True
    legs: bool = True
    horse: bool = False
    midline: bool = False
    order: Random | None = None


def humanoid(build: Build) -> Tree:
    """The robot; its joints are where a person's are."""
    links, joints = (
        [
            _link("pelvis", (0.0, 0.0, 0.05), (0.2, 0.25, 0.1)),
            _link("chest", (0.0, 0.0, 0.2), (0.2, 0.3, 0.4)),
        ],
        [],
    )
    joints.append(_joint("waist", "pelvis", "chest", (0.0, 0.0, 0.1), (0.0, 1.0, 0.0), (-1.0, 1.0)))
    for side, sign in SIDE.items():
        prefix = build.named(side)
        for shift in ((0.3, -0.3) if build.horse else (0.0,)) if build.legs else ():
            _add_leg(links, joints, prefix + ("" if shift <= 0.0 else "front_"), sign, shift, build)
        if build.arms:
            _add_arm(links, joints, prefix, sign, build)
    if build.order is not None:
        build.order.shuffle(links)
        build.order.shuffle(joints)
    turn = Placement.from_xyz_rpy((0.0, 0.0, 0.0), (0.0, 0.0, build.yaw))
    root = Link("base")
    return Tree("humanoid", (root, *links), (Joint("turn", JointKind.FIXED, "base", "pelvis", turn), *joints))


def _add_leg(
    links: list[Link], joints: list[Joint], prefix: str, sign: float, shift: float, build: Build
) -> None:
    thigh, shank, ankle, foot = (prefix + name for name in ("thigh", "shank", "ankle", "foot"))
    hip = prefix + "hip"
    links += [
        _link(hip, (0.0, 0.0, 0.0), (0.06, 0.06, 0.06)),
        _link(thigh, (0.0, 0.0, -0.19), (0.1, 0.1, 0.38)),
        _link(shank, (0.0, 0.0, -0.18), (0.08, 0.08, 0.36)),
        _link(ankle, (0.0, 0.0, 0.0), (0.04, 0.04, 0.04)),
        _link(foot, (build.toe, 0.0, -0.06), (0.24, 0.1, 0.04)),
    ]
    joints += [
        _joint(prefix + "hip_roll", "pelvis", hip, (shift, sign * 0.1, 0.0), (1.0, 0.0, 0.0), (-0.5, 0.5)),
        _joint(prefix + "hip_pitch", hip, thigh, (0.0, 0.0, 0.0), (0.0, 1.0, 0.0), (-2.0, 0.5)),
        _joint(prefix + "knee", thigh, shank, (0.0, 0.0, -0.38), (0.0, 1.0, 0.0), build.knee),
        _joint(prefix + "ankle_pitch", shank, ankle, (0.0, 0.0, -0.36), (0.0, 1.0, 0.0), (-0.8, 0.8)),
        _joint(prefix + "ankle_roll", ankle, foot, (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (-0.4, 0.4)),
    ]


def _add_arm(links: list[Link], joints: list[Joint], prefix: str, sign: float, build: Build) -> None:
    beside = 0.0 if build.midline else 0.2
    shoulder, upper, fore, hand = (prefix + name for name in ("shoulder", "upper_arm", "forearm", "hand"))
    links += [
        _link(shoulder, (0.0, sign * 0.02, 0.0), (0.06, 0.06, 0.06)),
        _link(upper, (0.0, 0.0, -0.13), (0.07, 0.07, 0.26)),
        _link(fore, (0.0, 0.0, -0.12), (0.06, 0.06, 0.24)),
        _link(hand, (0.0, 0.0, -0.05), (0.04, 0.08, 0.1)),
        *(_link(f"{prefix}finger_{i}", (0.0, 0.0, -0.03), (0.01, 0.01, 0.06)) for i in range(3)),
    ]
    joints += [
        _joint(
            prefix + "shoulder_pitch",
            "chest",
            shoulder,
            (0.0, sign * beside, 0.36),
            (0.0, 1.0, 0.0),
            (-2.0, 2.0),
        ),
        _joint(
            prefix + "shoulder_roll",
            shoulder,
            upper,
            (0.0, sign * (0.23 - beside), 0.0),
            (1.0, 0.0, 0.0),
            (-1.5, 1.5),
        ),
        _joint(prefix + "elbow", upper, fore, (0.0, 0.0, -0.26), (0.0, 1.0, 0.0), (-2.2, 0.0)),
        _joint(prefix + "wrist", fore, hand, (0.0, 0.0, -0.24), (0.0, 0.0, 1.0), (-1.0, 1.0)),
        *(
            _joint(
                f"{prefix}bend_{i}",
                hand,
                f"{prefix}finger_{i}",
                (0.0, 0.02 * i - 0.02, -0.1),
                (0.0, 1.0, 0.0),
                (0.0, 1.0),
            )
            for i in range(3)
        ),
    ]


def _link(name: str, center: Vector, size: Vector) -> Link:
    return Link(name, solids=(Solid(Box(*size), Placement(translation=center), 600.0),))


def _joint(name: str, parent: str, child: str, at: Vector, axis: Vector, ends: tuple[float, float]) -> Joint:
    return Joint(name, JointKind.REVOLUTE, parent, child, Placement(translation=at), axis, *ends)


def leg_length() -> float:
    """From hip to sole [m]."""
    return math.fsum((0.38, 0.36, 0.08))
