"""A mechanism with what robot and person lack: slides, endless joints, oblique axes, turned placements."""

from __future__ import annotations

import math

from evodesign.body.inertia import Inertia
from evodesign.body.placement import Placement
from evodesign.tree.model import Joint, JointKind, Link, Tree


def crane() -> Tree:
    """trolley -> tower (oblique axis) -> boom (slide) -> hook (endless); a welded weight, a flag aside."""
    oblique = (1.0 / 3.0, -2.0 / 3.0, 2.0 / 3.0)
    links = (
        Link("trolley", own_inertia=solid(12.0, (0.1, -0.05, 0.2), 0.5)),
        Link("tower", own_inertia=solid(5.0, (0.0, 0.3, 0.4), 0.2)),
        Link("boom", own_inertia=solid(3.0, (0.6, 0.0, 0.1), 0.1)),
        Link("weight", own_inertia=solid(2.0, (0.0, 0.1, 0.0), 0.05)),
        Link("hook", own_inertia=solid(1.0, (0.05, 0.02, -0.3), 0.02)),
        Link("flag", own_inertia=solid(0.5, (-0.2, 0.1, 0.1), 0.01)),
    )
    joints = (
        joint("swing", JointKind.REVOLUTE, "trolley", "tower", (0.1, 0.2, 0.9), (0.3, -0.4, 1.1), oblique),
        joint(
            "reach", JointKind.PRISMATIC, "tower", "boom", (0.0, 0.1, 0.7), (-0.5, 0.2, 0.0), (0.6, 0.0, 0.8)
        ),
        joint("balance", JointKind.FIXED, "boom", "weight", (-0.4, 0.0, 0.1), (0.1, 0.2, 0.3)),
        joint(
            "twist", JointKind.CONTINUOUS, "boom", "hook", (1.1, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
        ),
        joint(
            "wave", JointKind.REVOLUTE, "trolley", "flag", (0.0, -0.5, 0.3), (1.5, 0.0, 0.2), (0.0, 1.0, 0.0)
        ),
    )
    return Tree("crane", links, joints)


def solid(mass: float, center: tuple[float, float, float], size: float) -> Inertia:
    """A lopsided body; its principal moments obey the triangle inequality."""
    a, b, c = (mass * size**2 * factor for factor in (0.9, 1.1, 1.4))
    d = 0.1 * a
    return Inertia(mass, center, ((a, d, -d), (d, b, 0.5 * d), (-d, 0.5 * d, c)))


def joint(
    name: str,
    kind: JointKind,
    parent: str,
    child: str,
    xyz: tuple[float, float, float],
    rpy: tuple[float, float, float],
    axis: tuple[float, float, float] = (1.0, 0.0, 0.0),
) -> Joint:
    """A joint; those that move within limits do so between -2 and 2."""
    place = Placement.from_xyz_rpy(xyz, rpy)
    limit = {JointKind.FIXED: 0.0, JointKind.CONTINUOUS: math.inf}.get(kind, 2.0)
    return Joint(name, kind, parent, child, place, axis, -limit, limit)
