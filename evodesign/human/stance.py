"""How a person stands at a load: how far apart the feet are, and how near the trunk comes.

    feet apart: from the breadth of a sole, where the feet touch, to b + 2 l sin(a)
    trunk clear: d / 2 + 2 cm

with b the distance of the hip joints, l from hip to ankle, a each leg's angle outwards and d the depth of the
trunk. No document that was read says how far people go; a measured posture (`human.measured_posture`) keeps
off both bounds.
"""

from __future__ import annotations

import math

from evodesign.body.placement import Placement
from evodesign.body.shape import Box
from evodesign.tree.frames import link_frames
from evodesign.tree.model import Tree

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
