"""Which bodies of an agent must not overlap: all but those that its build brings together.

    neighbours     joined links, by way of at most one more with a body (an elbow's cross) or of three axes (a
                   hip's, a shoulder's); bare frames do not count; and links between which no joint moves
                   that the problem names
    always         pairs that overlap in most of the agent's postures
    a hand         may touch the load that it holds, and so may links that begin less than a hand's length
                   from the grasp, as wrists do, and fingers that stand still

So MoveIt fills its matrix of allowed collisions: adjacent, always, never.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from itertools import combinations

import numpy as np

from evodesign.body.placement import Placement
from evodesign.collision.clearance import SolidBodies, places_of
from evodesign.collision.rules import FLOOR, LOAD, PARTNER, BodyPair
from evodesign.tree.frames import link_frames, link_poses
from evodesign.tree.model import Joint, JointKind, Tree

__all__ = ["checked_pairs", "collision_pairs", "feet_pairs", "holding_links"]

BETWEEN, AXES = 1, 3
"""Links with a body, or joints that move, between two neighbours."""

HAND = 0.15
"""A hand's length [m]."""

SAMPLES, MOST = 100, 0.5
"""Postures that are looked at, and the share of them in which a pair overlaps that always does."""

TURN = np.pi  # [rad], of a joint without limits


def checked_pairs(
    tree: Tree,
    joints: Collection[str],
    hands: Mapping[str, str],
    soles: Mapping[str, str],
    resized: Sequence[Tree] = (),
) -> tuple[BodyPair, ...]:
    """Pairs of links, and of links with load, floor and partner, that must not overlap, in the tree's order.

    Args:
        tree: of the agent, unscaled.
        joints: that move; the others stand at zero.
        hands: frames at the grasps, by side.
        soles: frames under the feet, by side.
        resized: trees of some designs: what always overlaps in one of them is a matter of its build.
    """
    names = tuple(dict.fromkeys(SolidBodies.of_tree(tree).names))
    holding = holding_links(tree, joints, hands)
    standing = {link for sole in soles.values() for link in _foot(tree, joints, sole)}
    return (
        *collision_pairs(tree, joints, resized),
        *((name, LOAD) for name in names if name not in holding),
        *((name, FLOOR) for name in names if name not in standing),
        *((name, PARTNER) for name in names if name not in holding),
    )


def collision_pairs(
    tree: Tree, joints: Collection[str], resized: Sequence[Tree] = ()
) -> tuple[BodyPair, ...]:
    """Pairs of links that must not overlap, in the tree's order; for the arguments see `checked_pairs`."""
    bodies = SolidBodies.of_tree(tree)
    names = tuple(dict.fromkeys(bodies.names))
    pairs = [pair for pair in combinations(names, 2) if not _near_by(tree, joints, frozenset(names), *pair)]
    always = frozenset[BodyPair]().union(
        *(_always_in_touch(each, joints, pairs) for each in (tree, *resized))
    )
    return tuple(pair for pair in pairs if pair not in always)


def feet_pairs(
    tree: Tree, joints: Collection[str], soles: Mapping[str, str], checked: Collection[BodyPair]
) -> tuple[BodyPair, ...]:
    """Each part of a foot with that of the other foot, of the pairs that must not overlap.

    Args:
        tree: of the agent.
        joints: that move.
        soles: frames under the feet, by side.
        checked: pairs that must not overlap.
    """
    feet = [[*_foot(tree, joints, sole)] for sole in soles.values()]
    both = {frozenset(pair) for one, other in combinations(feet, 2) for pair in zip(one, other, strict=False)}
    return tuple(pair for pair in checked if frozenset(pair) in both)


def holding_links(tree: Tree, joints: Collection[str], hands: Mapping[str, str]) -> frozenset[str]:
    """Links that may touch the load: those of hands, and the links near the grasp.

    Args:
        tree: of the agent, unscaled.
        joints: that move.
        hands: frames at the grasp, by side.
    """
    frames = link_frames(tree, Placement(), {})
    found: set[str] = set()
    for hand in hands.values():
        grasp, name = np.array(frames[hand].translation, float), hand
        while np.linalg.norm(np.array(frames[name].translation, float) - grasp) < HAND:
            found |= {name, *_still_below(tree, joints, name)}
            if name not in tree.parent_joint:
                break
            name = tree.parent_joint[name].parent
    return frozenset(found)


def _foot(tree: Tree, joints: Collection[str], sole: str) -> Iterator[str]:
    """All below the last joint that moves above a sole, and what is below that: a toe."""
    name = sole
    while name in tree.parent_joint and tree.parent_joint[name].name not in joints:
        name = tree.parent_joint[name].parent
    yield name
    yield from _below(tree, name)


def _below(tree: Tree, name: str) -> Iterator[str]:
    for joint in tree.child_joints[name]:
        yield joint.child
        yield from _below(tree, joint.child)


def _still_below(tree: Tree, joints: Collection[str], name: str) -> Iterator[str]:
    """Links below one that nothing moves against it: fingers that stay."""
    for joint in tree.child_joints[name]:
        if joint.name not in joints:
            yield joint.child
            yield from _still_below(tree, joints, joint.child)


def _near_by(tree: Tree, joints: Collection[str], bodies: frozenset[str], first: str, second: str) -> bool:
    """Whether hardly anything is between two links."""
    above, beyond = tree.to_root(first), tree.to_root(second)
    common = next(link for link in above if link in beyond)
    legs = above[: above.index(common)] + beyond[: beyond.index(common)]
    between = [tree.parent_joint[link] for link in legs]
    if not any(joint.name in joints for joint in between):
        return True
    axes = sum(joint.kind is not JointKind.FIXED for joint in between)
    return axes <= AXES or len({*legs, common} & bodies - {first, second}) <= BETWEEN


def _always_in_touch(tree: Tree, joints: Collection[str], pairs: Collection[BodyPair]) -> frozenset[BodyPair]:
    """Pairs that overlap in most postures, drawn from the joints' ranges; always the same ones."""
    rng, bodies = np.random.default_rng(0), SolidBodies.of_tree(tree)
    ranges = {joint.name: _range(joint) for joint in tree.joints if joint.name in joints}
    lower, upper = np.array([*ranges.values()]).reshape(-1, 2).T
    drawn = rng.uniform(lower, upper, (SAMPLES, len(ranges)))
    poses = link_poses(tree, dict(zip(ranges, drawn.T, strict=True)))
    turns, origins = (np.array([poses[name][part] for name in bodies.names]) for part in (0, 1))
    counts: Counter[tuple[str, str]] = Counter()
    places = places_of(bodies.names, pairs)
    samples = turns.shape[1]  # one where nothing moves
    for sample in range(samples):
        placed = bodies.placed_at(turns[:, sample], origins[:, sample])
        counts.update((gap.first, gap.second) for gap in placed.overlapping(places))
    return frozenset(pair for pair, count in counts.items() if count > MOST * samples)


def _range(joint: Joint) -> tuple[float, float]:
    return max(joint.lower, -TURN), min(joint.upper, TURN)
