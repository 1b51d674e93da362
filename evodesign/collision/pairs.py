"""Which bodies of an agent must not overlap: all but those that its build brings together.

Exempt are, of the agent as its file has it,

    joined         two links that one joint of one or more axes joins, or parts that are fixed to these
    still          two between which no joint moves
    touching       two that are in touch while all joints are at zero, and in at least a tenth of its
                   postures: arms that hang beside the hips are apart in nearly all others, and stay checked
    mostly         two that overlap in most of its postures
    holding        a hand and the load that it holds: the link to which the grasp is fixed, links that begin
                   less than a hand's length from it, as wrists do, and fingers that stand still

Where a pair is exempt, so is its mirror image. No design is asked: what only a resized robot brings together
is a fault of that design (`built_in_pairs`).

Source: MoveIt's matrix of allowed collisions: adjacent, in touch by default, always, never.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from itertools import combinations

import numpy as np

from evodesign.body.placement import Placement
from evodesign.collision.clearance import SolidBodies, places_of
from evodesign.collision.random_postures import images_of, shares_of_postures, with_image
from evodesign.collision.rules import FLOOR, LOAD, PARTNER, BodyPair
from evodesign.tree.frames import link_frames
from evodesign.tree.model import JointKind, Link, Tree
from evodesign.tree.once_per_tree import once_per_tree

HAND = 0.15
"""A hand's length [m]."""

TOUCH = 1e-6
"""Solids nearer than this [m] are in touch: shapes that end where another one begins."""

MOST, SELDOM = 0.55, 0.1
"""Shares of the postures: more than half of them, whichever are drawn, and so few that a touch is chance."""

JOINED, STILL = "joined by a joint", "no joint moves between them"


def checked_pairs(
    tree: Tree, joints: Collection[str], hands: Iterable[str], soles: Iterable[str]
) -> tuple[BodyPair, ...]:
    """Pairs of links, and of links with load, floor and partner, that must not overlap, in the tree's order.

    Args:
        tree: of the agent, unscaled.
        joints: that move; the others stand at zero.
        hands: frames at the grasps.
        soles: frames under the feet.
    """
    names = tuple(dict.fromkeys(SolidBodies.of_tree(tree).names))
    holding = holding_links(tree, joints, hands)
    standing = {link for sole in soles for link in _foot(tree, joints, sole)}
    return (
        *collision_pairs(tree, joints),
        *((name, LOAD) for name in names if name not in holding),
        *((name, FLOOR) for name in names if name not in standing),
        *((name, PARTNER) for name in names if name not in holding),
    )


def collision_pairs(tree: Tree, joints: Collection[str]) -> tuple[BodyPair, ...]:
    """Pairs of links that must not overlap, in the tree's order; for the arguments see `checked_pairs`."""
    exempt = exempt_pairs(tree, joints)
    return tuple(pair for pair in _link_pairs(tree) if pair not in exempt)


def exempt_pairs(tree: Tree, joints: Collection[str]) -> Mapping[BodyPair, str]:
    """Pairs of links that may overlap, in the tree's order, each with its reason.

    Args:
        tree: of the agent, unscaled.
        joints: that move.
    """
    return _exempt_pairs(tree, tuple(joints))


@once_per_tree
def _exempt_pairs(tree: Tree, joints: tuple[str, ...]) -> Mapping[BodyPair, str]:
    pairs = _link_pairs(tree)
    others = [pair for pair in pairs if not is_joined(tree, pair)]
    touching, images = _touching(tree, others), images_of(tree)
    near = {names for pair in touching for names in with_image(pair, images)}
    seldom = [pair for pair in others if frozenset(pair) in near]
    mostly = [pair for pair in others if frozenset(pair) not in near]
    shares = {
        **shares_of_postures(tree, joints, seldom, SELDOM),
        **shares_of_postures(tree, joints, mostly, MOST),
    }
    found: dict[BodyPair, str] = {}
    for pair in pairs:
        share = shares.get(pair, 0.0)
        if is_joined(tree, pair):
            found[pair] = JOINED
        elif _is_still(tree, joints, pair):
            found[pair] = STILL
        elif pair in touching and share >= SELDOM:
            found[pair] = f"in touch while all joints are at zero, and in {share:.0%} of postures"
        elif share > MOST:
            found[pair] = f"overlap in {share:.0%} of postures"
    return found


def built_in_pairs(
    tree: Tree,
    joints: Collection[str],
    checked: Collection[BodyPair],
    resized: Iterable[Tree],
    margin: float = 0.0,
) -> tuple[BodyPair, ...]:
    """Pairs of links that the build of some design brings together.

    They are nearer to each other in it than a margin while all joints are at zero, and overlap in a tenth of
    its postures at least, and are farther apart in the unscaled robot at zero. Those that are nearer there,
    but not in touch, count where they are in touch in the design. Meshes are their hulls.

    Args:
        tree: of the agent, unscaled.
        joints: that move.
        checked: pairs that must not overlap; those between which no joint moves count as well.
        resized: trees of some designs.
        margin: least distance that is asked for [m].
    """
    known = {frozenset(pair) for pair in checked}
    own = [
        pair
        for pair in _link_pairs(tree)
        if frozenset(pair) in known or (not is_joined(tree, pair) and _is_still(tree, joints, pair))
    ]
    hulls, images = SolidBodies.of_tree(tree).hulls, images_of(tree)
    apart, found = {*own} - _touching(tree, own, hulls), set[BodyPair]()
    clear = apart - _touching(tree, own, hulls, margin)
    for each in resized:
        hulls = SolidBodies.of_tree(each).hulls
        near = sorted(_touching(each, apart - found, hulls) | _touching(each, clear - found, hulls, margin))
        found |= shares_of_postures(each, joints, near, SELDOM, bodies=hulls, images=images).keys()
    found |= {(images.get(one, one), images.get(other, other)) for one, other in found}
    return tuple(pair for pair in own if pair in found or pair[::-1] in found)


def feet_pairs(
    tree: Tree, joints: Collection[str], soles: Iterable[str], checked: Collection[BodyPair]
) -> tuple[BodyPair, ...]:
    """Each part of a foot with that of the other foot, of the pairs that must not overlap.

    Args:
        tree: of the agent.
        joints: that move.
        soles: frames under the feet.
        checked: pairs that must not overlap.
    """
    feet = [[*_foot(tree, joints, sole)] for sole in soles]
    both = {frozenset(pair) for one, other in combinations(feet, 2) for pair in zip(one, other, strict=False)}
    return tuple(pair for pair in checked if frozenset(pair) in both)


def holding_links(tree: Tree, joints: Collection[str], hands: Iterable[str]) -> frozenset[str]:
    """Links that may touch the load: those to which the grasp is fixed, and the links near it.

    Args:
        tree: of the agent, unscaled.
        joints: that move.
        hands: frames at the grasp.
    """
    frames = link_frames(tree, Placement(), {})
    found: set[str] = set()
    for hand in hands:
        grasp, name = np.array(frames[hand].translation, float), hand
        fixed = True
        while fixed or np.linalg.norm(np.array(frames[name].translation, float) - grasp) < HAND:
            found |= {name, *_still_below(tree, joints, name)}
            if name not in tree.parent_joint:
                break
            joint = tree.parent_joint[name]
            fixed, name = fixed and joint.kind is JointKind.FIXED, joint.parent
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


def _link_pairs(tree: Tree) -> tuple[BodyPair, ...]:
    """All pairs of links that have solids, in the tree's order."""
    return tuple(combinations(dict.fromkeys(SolidBodies.of_tree(tree).names), 2))


def _between(tree: Tree, pair: BodyPair) -> frozenset[str]:
    """Names of the joints between two links."""
    one, other = (
        frozenset(tree.parent_joint[link].name for link in tree.to_root(name)[:-1]) for name in pair
    )
    return one ^ other


def is_joined(tree: Tree, pair: BodyPair) -> bool:
    """Whether one joint joins two links, or none, beside fixed ones; it may have several axes."""
    between = (tree.joint_by_name[name] for name in _between(tree, pair))
    moved = [joint.child for joint in between if joint.kind is not JointKind.FIXED]
    return sum(child in pair or not _is_bare(tree.link_by_name[child]) for child in moved) <= 1


def _is_bare(link: Link) -> bool:
    """Whether a link is a bare frame, as between the axes of a joint of several."""
    return not (link.mass or link.looks or link.meshes)


def _is_still(tree: Tree, joints: Collection[str], pair: BodyPair) -> bool:
    """Whether nothing moves two links against each other."""
    return not _between(tree, pair).intersection(joints)


def _touching(
    tree: Tree, pairs: Collection[BodyPair], bodies: SolidBodies | None = None, within: float = TOUCH
) -> set[BodyPair]:
    """Those of some pairs that are in touch, or nearer than a distance [m], while all joints are at zero.

    Solids may be others than the tree's.
    """
    bodies = SolidBodies.of_tree(tree) if bodies is None else bodies
    placed = bodies.placed(link_frames(tree, Placement(), {}))
    return {(gap.first, gap.second) for gap in placed.overlapping(places_of(bodies.names, pairs), within)}
