"""How far bodies are asked to be apart: the problem's margin, or what the robot's build leaves them.

Parts that are built two millimetres from each other cannot keep five. Nor can parts of meshes whose fitted
shapes (`collision.supports`), which programs know, are nearer than that while all joints are at zero and the
meshes' hulls are apart; a margin is negative there, and the check of the hulls decides.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping

import coal
import numpy as np

from evodesign.body.placement import Placement
from evodesign.collision.clearance import BodyDistance, SolidBodies, places_of
from evodesign.collision.rules import BodyPair
from evodesign.collision.shapes import ConvexSolid
from evodesign.collision.supports import ConvexShape, shapes_of
from evodesign.tree.frames import link_frames
from evodesign.tree.model import Tree

__all__ = ["narrow_margins"]


def narrow_margins(tree: Tree, pairs: Collection[BodyPair], margin: float) -> Mapping[BodyPair, float]:
    """The margins [m] of pairs of links that are built nearer to each other than a margin.

    Pairs that are in each other while all joints are at zero keep the whole margin: they are apart in nearly
    all other postures, or they would be exempt.

    Args:
        tree: of the agent, unscaled.
        pairs: that must not overlap; what is no link counts for nothing.
        margin: that is asked for [m].
    """
    fitted = [(link.name, _solid(shape)) for link in tree.links for shape in shapes_of(link)]
    shown = SolidBodies.of_tree(tree)
    known = SolidBodies(tuple(name for name, _ in fitted), tuple(solid for _, solid in fitted))
    inside = {(gap.first, gap.second) for gap in _near(tree, shown, pairs, 0.0)}
    near = _near(tree, known, [pair for pair in pairs if pair not in inside], margin)
    return {(gap.first, gap.second): gap.distance for gap in near}


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
