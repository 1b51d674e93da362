"""How far bodies are asked to be apart: the problem's margin, or what the robot's build leaves them.

Parts that are built two millimetres from each other cannot keep five. Nor can parts of meshes whose fitted
shapes (`collision.supports`), which programs know, are nearer than that while all joints are at zero and the
meshes are apart; a margin is negative there, and the check of the triangles decides. Where fitted shapes are
too near in many postures in which the meshes are apart, as those of wrists and shoulders are, the margin m is
the one that errs least in random postures, of fitted distances d,

    share(d < m, apart) + LET_THROUGH share(d >= m, in each other)

which may be minus infinity: then rows would refuse more than they are good for, and the check alone decides.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Mapping

import coal
import numpy as np
from numpy.typing import NDArray

from evodesign.body.placement import Placement
from evodesign.collision.clearance import BodyDistance, SolidBodies, places_of
from evodesign.collision.random_postures import images_of, placed_in_postures, with_image
from evodesign.collision.rules import BodyPair
from evodesign.collision.shapes import Array, ConvexSolid
from evodesign.collision.supports import ConvexShape, shapes_of
from evodesign.tree.frames import link_frames
from evodesign.tree.model import Tree

COARSE = 0.1
"""Share of postures in which fitted shapes are too near though the bodies are apart."""

LET_THROUGH = 3.0
"""How many postures that are refused although the bodies are apart count as one that is let through although
they overlap: the check refuses that one, and nothing steers away from it."""


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


def fitted_margins(
    tree: Tree, joints: Collection[str], pairs: Collection[BodyPair], margin: float
) -> Mapping[BodyPair, float]:
    """The margins [m] of pairs with meshes whose fitted shapes are often nearer than a margin in vain.

    A pair and its mirror image have the same; minus infinity stands for pairs without rows.

    Args:
        tree: of the agent, unscaled.
        joints: that move.
        pairs: that must not overlap; what is no link counts for nothing.
        margin: that is asked for [m].
    """
    links = tree.link_by_name
    exact = {name for name, link in links.items() if link.solids or not link.shown}
    own = [pair for pair in pairs if links.keys() >= set(pair) and not exact.issuperset(pair)]
    shown, known, images = SolidBodies.of_tree(tree), _fitted(tree), images_of(tree)
    if not own or not shown.names:
        return {}
    both = {pair: with_image(pair, images) for pair in own}
    postures = [*placed_in_postures(tree, joints, known)]
    gaps = [placed.gaps(placed.in_all(places_of(known.names, own)), margin) for placed in postures]
    enough = COARSE * 2 * sum(placed.postures for placed in postures)
    counts = Counter(frozenset(pair) for found in gaps for _, *pair in found)
    often = [pair for pair in own if sum(counts[names] for names in both[pair]) >= enough]
    asked = {names for pair in often for names in both[pair]}
    places = {pair: places_of(shown.names, [pair]) for pair in own if frozenset(pair) in asked}
    drawn: dict[frozenset[str], list[tuple[float, bool]]] = {names: [] for names in asked}
    for found, placed in zip(gaps, placed_in_postures(tree, joints, shown), strict=True):
        near = [each for each in found if frozenset(each[1:]) in asked]
        solids = [places[each[1:]] + each[0] * len(shown.names) for each in near]
        overlaps = placed.in_each_other(np.concatenate(solids), least=0.0) if near else set()
        for each in near:
            drawn[frozenset(each[1:])].append((found[each], each in overlaps))
    margins: dict[BodyPair, float] = {}
    for pair in often:
        distances, overlap = np.array([each for names in both[pair] for each in drawn[names]]).T
        if np.sum(overlap == 0.0) >= enough:
            margins[pair] = _least_wrong(distances, overlap == 1.0)
    return margins


def _least_wrong(distances: Array, overlap: NDArray[np.bool_]) -> float:
    """The margin [m] that errs least.

    Args:
        distances: of fitted shapes that are nearer than the largest margin [m], shape (n,).
        overlap: whether the bodies are in each other, shape (n,).
    """
    order = np.argsort(distances)
    below = np.concatenate([[0], np.cumsum(~overlap[order])])
    beyond = overlap.sum() - np.concatenate([[0], np.cumsum(overlap[order])])
    least = int(np.argmin(below + LET_THROUGH * beyond))
    ends = [-np.inf, *distances[order]]
    return float(ends[least])


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
