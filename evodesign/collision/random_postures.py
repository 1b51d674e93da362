"""Bodies in random postures, always the same ones: which pairs of them are in each other, and how often."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence

import numpy as np

from evodesign.collision.clearance import PlacedSolids, SolidBodies, places_of
from evodesign.collision.rules import BodyPair
from evodesign.errors import ModelError
from evodesign.tree.frames import link_poses
from evodesign.tree.model import Joint, Tree
from evodesign.tree.symmetry import mirror_of

SAMPLES, AT_ONCE = 500, 50
"""Postures in which pairs are looked at, and of how many bodies are placed at once, for memory's sake."""

HALF_TURN = np.pi  # [rad]


def shares_of_postures(
    tree: Tree,
    joints: Collection[str],
    pairs: Sequence[BodyPair],
    least: float,
    *,
    bodies: SolidBodies | None = None,
    images: Mapping[str, str] | None = None,
) -> Mapping[BodyPair, float]:
    """In what share of postures pairs are in each other, with their mirror images.

    Args:
        tree: of the agent.
        joints: that move; their positions are drawn from their ranges, always the same ones.
        pairs: of links.
        least: share of those that are given.
        bodies: the links' solids; left out, the tree's own.
        images: the mirror image of each link; left out, the tree's own.
    """
    if not pairs:
        return {}
    bodies = SolidBodies.of_tree(tree) if bodies is None else bodies
    images = images_of(tree) if images is None else images
    counts: Counter[frozenset[str]] = Counter()
    both = {pair: with_image(pair, images) for pair in pairs}
    samples = 0
    for placed in placed_in_postures(tree, joints, bodies):
        in_each_other = placed.in_each_other(placed.in_all(places_of(bodies.names, pairs)))
        counts.update(frozenset(pair) for _, *pair in in_each_other)
        samples += placed.postures
        wanted = 2 * (least * SAMPLES - (SAMPLES - samples))
        pairs = [pair for pair in pairs if sum(counts[each] for each in both[pair]) >= wanted]
    shares = {pair: sum(counts[each] for each in both[pair]) / (2 * samples) for pair in pairs}
    return {pair: share for pair, share in shares.items() if share >= least}


def placed_in_postures(tree: Tree, joints: Collection[str], bodies: SolidBodies) -> Iterator[PlacedSolids]:
    """Solids in random postures, always the same ones, many at once.

    Args:
        tree: of the agent.
        joints: that move; their positions are drawn from their ranges.
        bodies: the links' solids.
    """
    rng = np.random.default_rng(0)
    ranges = {joint.name: _range(joint) for joint in tree.joints if joint.name in joints}
    lower, upper = np.array([*ranges.values()]).reshape(-1, 2).T
    drawn = rng.uniform(lower, upper, (SAMPLES, len(ranges)))
    poses = link_poses(tree, dict(zip(ranges, drawn.T, strict=True)))
    turns, origins = (np.stack([poses[name][part] for name in bodies.names], axis=1) for part in (0, 1))
    for first in range(0, len(turns), AT_ONCE):  # one where nothing moves
        yield bodies.placed_at(turns[first : first + AT_ONCE], origins[first : first + AT_ONCE])


def _range(joint: Joint) -> tuple[float, float]:
    """Its limits, or half a turn to either side where they are a turn apart."""
    wide = joint.upper - joint.lower >= 2.0 * HALF_TURN
    return (-HALF_TURN, HALF_TURN) if wide else (joint.lower, joint.upper)


def images_of(tree: Tree) -> Mapping[str, str]:
    """The mirror image of each link, if the tree is symmetric."""
    try:
        return mirror_of(tree).links
    except ModelError:
        return {}


def with_image(pair: BodyPair, images: Mapping[str, str]) -> tuple[frozenset[str], frozenset[str]]:
    """The names of a pair, and of its mirror image."""
    first, second = pair
    return frozenset(pair), frozenset((images.get(first, first), images.get(second, second)))
