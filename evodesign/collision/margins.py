"""How far bodies are asked to be apart: the problem's margin, or what the robot's build leaves them.

Parts that are built two millimetres from each other cannot keep five. Nor can parts of meshes whose fitted
shapes (`collision.supports`), which programs know, are nearer than that while all joints are at zero and the
hulls of the meshes' parts are apart; a margin is negative there, and the check of the hulls decides. Where
fitted shapes are too near in many postures in which the hulls are apart, as those of wrists and shoulders
are, programs have no rows: the check alone decides.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping

import coal
import numpy as np

from evodesign.body.placement import Placement
from evodesign.collision.clearance import BodyDistance, SolidBodies, places_of
from evodesign.collision.pairs import shares_of_postures
from evodesign.collision.rules import BodyPair
from evodesign.collision.shapes import ConvexSolid
from evodesign.collision.supports import ConvexShape, shapes_of
from evodesign.tree.frames import link_frames
from evodesign.tree.model import Tree

__all__ = ["coarse_pairs", "narrow_margins"]

COARSE = 0.1
"""Share of postures in which fitted shapes are too near though the bodies are apart."""


def narrow_margins(tree: Tree, pairs: Collection[BodyPair], margin: float) -> Mapping[BodyPair, float]:
    """The margins [m] of pairs of links that are built nearer to each other than a margin.

    Pairs that are in each other while all joints are at zero keep the whole margin: they are apart in nearly
    all other postures, or they would be exempt.

    Args:
        tree: of the agent, unscaled.
        pairs: that must not overlap; what is no link counts for nothing.
        margin: that is asked for [m].
    """
    shown, known = SolidBodies.of_tree(tree), _fitted(tree)
    inside = {(gap.first, gap.second) for gap in _near(tree, shown, pairs, 0.0)}
    near = _near(tree, known, [pair for pair in pairs if pair not in inside], margin)
    return {(gap.first, gap.second): gap.distance for gap in near}


def coarse_pairs(
    tree: Tree, joints: Collection[str], pairs: Collection[BodyPair], margin: float
) -> frozenset[BodyPair]:
    """Pairs with meshes whose fitted shapes are often nearer than a margin where the hulls are apart.

    Args:
        tree: of the agent, unscaled.
        joints: that move.
        pairs: that must not overlap; what is no link counts for nothing.
        margin: that is asked for [m].
    """
    links = tree.link_by_name
    exact = {name for name, link in links.items() if link.solids or not link.shown}
    own = [pair for pair in pairs if links.keys() >= set(pair) and not exact.issuperset(pair)]
    overlap = shares_of_postures(tree, joints, own)
    near = shares_of_postures(tree, joints, own, margin, bodies=_fitted(tree))
    return frozenset(pair for pair, share in near.items() if share - overlap.get(pair, 0.0) >= COARSE)


def _fitted(tree: Tree) -> SolidBodies:
    """The shapes that programs know."""
    found = [(link.name, _solid(shape)) for link in tree.links for shape in shapes_of(link)]
    return SolidBodies(tuple(name for name, _ in found), tuple(solid for _, solid in found))


def _near(tree: Tree, bodies: SolidBodies, pairs: Collection[BodyPair], within: float) -> list[BodyDistance]:
    """Pairs that are nearer to each other than a distance [m] while all joints are at zero."""
    placed = bodies.placed(link_frames(tree, Placement(), {}))
    return placed.overlapping(places_of(bodies.names, pairs), within)


def _solid(shape: ConvexShape) -> ConvexSolid:
    """A fitted shape of numbers as coal knows it; stretched ones do not occur in an unscaled tree."""
    half = np.array(shape.half_sides, float)
    if shape.disc:
        geometry, reach = (
            coal.Cylinder(float(shape.disc), 2.0 * half[2]),
            half + np.array([shape.disc, shape.disc, 0.0]),
        )
    elif shape.ball:
        geometry, reach = coal.Capsule(float(shape.ball), 2.0 * half[2]), half + shape.ball
    else:
        geometry, reach = coal.Box(*(2.0 * half)), half
    place = shape.link_from_shape
    rotation, position = np.array(place.rotation, float), np.array(place.translation, float)
    return ConvexSolid(
        geometry, rotation, position, position, float(np.linalg.norm(reach)), np.zeros(3), reach
    )
