"""Which joint and link of a tree is whose mirror image, by geometry; names only decide among equals.

Partners hang on partners, from the root outwards (`mirror_candidates`). Frames that carry neither mass nor a
joint that moves need no partner: they are loose then, and nothing but their place matters.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from evodesign.tree.mirror_candidates import Candidates, Unpaired, beyond_of
from evodesign.tree.mirror_images import Difference, Seen, Tolerance, differences, seen_in_root, sign_of
from evodesign.tree.model import Tree

IN_THE_MIDDLE = 1e-9
"""Of links nearer than this to the plane [m] it is not asked whether they lie to the left."""


@dataclass(frozen=True, slots=True)
class Mirror:
    """Which link and joint is whose mirror image.

    Args:
        links: partner by link name.
        joints: partner by joint name.
        signs: +1 if the partner's position and torque are equal in a symmetric posture, -1 if opposite.
        left: links of the branches to the left (y > 0 at zero positions).
        loose: bare frames without a partner, each noted as its own.
    """

    links: Mapping[str, str]
    joints: Mapping[str, str]
    signs: Mapping[str, float]
    left: frozenset[str] = frozenset()
    loose: frozenset[str] = frozenset()

    def is_middle(self, link: str) -> bool:
        """Whether a link is its own partner."""
        return self.links[link] == link


@dataclass(frozen=True, slots=True, eq=False)
class Pairs:
    """A mirror with the figures that it was found by.

    Args:
        mirror: who is whose image.
        seen: every link as it was compared.
        differences: of all pairs and links of the middle line, in the tree's order.
    """

    mirror: Mirror
    seen: Mapping[str, Seen]
    differences: tuple[Difference, ...]


def mirror_pairs(tree: Tree, tolerance: Tolerance, *, strict: bool = True) -> Pairs:
    """The mirror symmetry of a tree of numbers.

    Args:
        tree: of numbers.
        tolerance: up to which two are mirror images.
        strict: whether limits, masses, centres and inertias beyond the tolerance are refused; otherwise they
            are among the differences, so that all of them are known.
    Raises:
        Unpaired: a link has no mirror image within the tolerance.
    """
    seen = seen_in_root(tree)
    candidates = Candidates(tree, seen, tolerance, strict=strict)
    root = seen[tree.root]
    found = list(differences(root, root, tolerance))
    if strict and (beyond := beyond_of(found)):
        raise Unpaired(root, root, beyond)
    links, loose = {tree.root: tree.root}, set[str]()
    for joint in tree.joints:
        if joint.child in links:
            continue
        one = seen[joint.child]
        other = None if joint.parent in loose else candidates.best(one, links[joint.parent])
        if other is None:  # a frame
            links[joint.child] = joint.child
            loose.add(joint.child)
            continue
        found += differences(one, other, tolerance)
        links[one.link], links[other.link] = other.link, one.link
        candidates.discard(one, other)
    return Pairs(_mirror(tree, seen, links, frozenset(loose)), seen, tuple(found))


def _mirror(tree: Tree, seen: Mapping[str, Seen], links: Mapping[str, str], loose: frozenset[str]) -> Mirror:
    above = tree.parent_joint
    joints = {joint.name: above[links[joint.child]].name for joint in tree.joints}
    signs = {joint.name: sign_of(seen[joint.child], seen[links[joint.child]]) for joint in tree.joints}
    left: set[str] = set()
    decided: set[str] = set()
    for joint in tree.joints:
        one, other = joint.child, links[joint.child]
        if joint.parent in left and one not in loose:
            left.add(one)
        elif links[joint.parent] == joint.parent and one != other and one not in decided:
            decided |= {one, other}
            left.add(one if _is_left(tree, seen, one, other) else other)
    return Mirror(links, joints, signs, frozenset(left), loose)


def _is_left(tree: Tree, seen: Mapping[str, Seen], one: str, other: str) -> bool:
    """Whether the branch of a link goes to the left (y > 0) rather than its partner's."""
    names = [one]
    for name in names:  # which grows meanwhile
        y = float(seen[name].place[1])
        if abs(y) > IN_THE_MIDDLE:
            return y > 0.0
        names.extend(joint.child for joint in tree.child_joints[name])
    return one < other
