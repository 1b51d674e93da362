"""Whether the build of a design brings bodies together: how near they are while all joints are at zero.

The distance of two convex bodies is the largest of what any unit vector n parts them by,

    d(n) = n . (c_2 - c_1) - s_1(n) - s_2(-n)

so its derivative along a design is that of d(n) with n held (envelope theorem). A mesh is its hull.

Source: Boyd and Vandenberghe, Convex Optimization, section 8.2; coal finds n.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import coal
import numpy as np

from evodesign.body.placement import Placement
from evodesign.collision.clearance import BodyDistance, PlacedSolids, SolidBodies, places_of
from evodesign.collision.rules import BodyPair, CollisionRules
from evodesign.collision.shapes import Array, solids_of
from evodesign.tree.frames import link_frames
from evodesign.tree.model import Tree


def built_in_slack(tree: Tree, rules: CollisionRules | None) -> tuple[float, BodyDistance] | None:
    """By how much bodies that designs may bring together are farther apart than asked [m], and which two.

    All joints are at zero. The slack is negative where the design cannot be built so; None stands for an
    agent whose bodies may pass through anything, or none of whose designs brings any together.

    Args:
        tree: of a design.
        rules: of its agent.
    """
    if rules is None or not rules.built_in:
        return None
    bodies = SolidBodies.of_tree(tree).hulls
    placed = bodies.placed(_at_zero(tree))
    gaps = [placed.nearest(places_of(bodies.names, [pair])) for pair in rules.built_in]
    slacks = [gap.distance - max(rules.margin_of((gap.first, gap.second)), 0.0) for gap in gaps]
    least = min(range(len(gaps)), key=slacks.__getitem__)
    return slacks[least], gaps[least]


def distance_along(tree: Tree, pair: BodyPair) -> Callable[[Tree], float]:
    """How far two links are apart at zero [m], to first order about a design: from trees of other designs.

    Args:
        tree: of the design.
        pair: of links with solids.
    """
    bodies = _solids_of(tree, pair)
    placed, places = bodies.placed(_at_zero(tree)), places_of(bodies.names, [pair]).tolist()
    _, normal, one, other = min((placed.parted(*both) for both in places), key=lambda found: found[0])

    def along(resized: Tree) -> float:
        there = _solids_of(resized, pair).placed(_at_zero(resized))
        apart = float(normal @ (there.positions[other] - there.positions[one]))
        return apart - _support(there, one, normal) - _support(there, other, -normal)

    return along


def _at_zero(tree: Tree) -> Mapping[str, Placement]:
    return link_frames(tree, Placement(), {})


def _solids_of(tree: Tree, pair: BodyPair) -> SolidBodies:
    """Those of two links."""
    found = [(name, solid) for name in pair for solid in solids_of(tree.link_by_name[name])]
    return SolidBodies(tuple(name for name, _ in found), tuple(solid for _, solid in found))


def _support(placed: PlacedSolids, place: int, direction: Array) -> float:
    """How far a solid reaches from its origin along a unit vector of the world [m]."""
    x, y, z = placed.rotations[place].T @ direction
    match placed.bodies.solids[place].geometry:
        case coal.Sphere() as ball:
            return float(ball.radius)
        case coal.Cylinder() as cylinder:
            return float(cylinder.radius * np.hypot(x, y) + cylinder.halfLength * abs(z))
        case coal.Box() as box:
            return float(box.halfSide @ np.abs([x, y, z]))
        case hull:
            return float(max(hull.points() @ np.array([x, y, z])))
