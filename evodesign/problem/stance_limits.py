"""Where feet and trunk may be, as a file says or by the size of who stands.

By a person's size:

    feet apart: from the breadth of a sole, where the feet touch, to b + 2 l sin(a)
    trunk clear: d / 2 + 2 cm

with b the distance of the hip joints, l from hip to ankle, a each leg's angle outwards and d the depth of the
trunk. No document that was read says how far people go; a measured posture (`human.measured_posture`) keeps
off both bounds.
"""

from __future__ import annotations

import math
from dataclasses import replace

from evodesign.body.placement import Placement
from evodesign.body.shape import Box
from evodesign.errors import InputError
from evodesign.mechanics.agent import Agent, StanceLimits
from evodesign.problem.file import ProblemFile
from evodesign.records import ProblemSource
from evodesign.tree.frames import link_frames
from evodesign.tree.model import Tree


def stance_of(tables: ProblemFile, source: ProblemSource, person: Agent | None = None) -> StanceLimits:
    """Where feet and trunk may be.

    Args:
        tables: of the problem.
        source: likewise, for messages.
        person: a generated one, from whose size follows what the file leaves out.
    Raises:
        InputError: distances of the feet that do not rise.
    """
    limits, usual = tables.limits, StanceLimits()
    if person is not None:
        apart = feet_apart(person.tree, person.feet[0].sole.width)
        usual = replace(usual, feet_apart=apart, trunk_clearance=trunk_clearance(person.tree))
    least, most = apart = limits.feet_apart_m or usual.feet_apart
    clear = usual.trunk_clearance if limits.trunk_clearance_m is None else limits.trunk_clearance_m
    if least >= most:
        raise InputError(source.path, "limits.feet_apart_m", "a rising pair", f"[{least:g}, {most:g}]")
    return StanceLimits(
        trunk_clearance=clear,
        feet_apart=apart,
        feet_stagger=limits.feet_stagger_m,
        foot_yaw=limits.foot_yaw_rad,
        base_tilt=limits.base_tilt_rad,
        push=limits.push_n,
        feet_gap=limits.feet_gap_m,
    )


LEG_OUTWARDS = math.radians(20.0)
"""Largest angle of a leg from upright, to the side: our choice, half of what hip joints allow."""

CLEAR = 0.02
"""From the trunk's front to the load [m]: our choice."""


def feet_apart(tree: Tree, sole_width: float) -> tuple[float, float]:
    """Least and largest sideways distance of the feet [m] of a generated person."""
    frames = link_frames(tree, Placement(), {})
    left, right, foot = (
        frames[f"{link}"].translation for link in ("LeftUpperLeg", "RightUpperLeg", "LeftFoot")
    )
    return sole_width, math.dist(left, right) + 2.0 * math.dist(left, foot) * math.sin(LEG_OUTWARDS)


def trunk_clearance(tree: Tree) -> float:
    """Least distance of the trunk's frames from the load's near edge [m] of a generated person."""
    depth = max(float(look.shape.x) for look in tree.link_by_name["T8"].looks if isinstance(look.shape, Box))
    return depth / 2.0 + CLEAR
