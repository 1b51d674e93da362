"""Mirror symmetry of a tree in the plane y = 0 of its root.

A link has a mirror partner when its joint, its limits, its mass and all its children are the mirror images of
the partner's:

    placement   R' = M R M, p' = M p with M = diag(1, -1, 1)
    axis        a rotation's axis is a pseudovector: equal joint positions are mirror images when
                a' = -M a (sign +1); opposite ones when a' = M a (sign -1); a slide's axis the other way round
    limits      equal for sign +1, exchanged and negated for sign -1

Frames without mass at the end of a branch need only be at mirrored places. Links on the middle line are their
own partners. A joint of the middle line with sign -1 (a roll or a yaw) is zero in every symmetric posture.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from heapq import merge
from operator import itemgetter

from evodesign.body.inertia import Inertia
from evodesign.body.placement import Placement, Vector, mirrored_matrix, mirrored_point
from evodesign.errors import ModelError
from evodesign.tree.model import Joint, JointKind, Link, Tree

__all__ = ["Mirror", "left_half", "mirror_of"]

TOLERANCE = 1e-9
"""Largest difference of figures [m, kg, kg m^2, rad] between mirror images."""

WIDEST = 1e6
"""Range of a joint [rad or m] beyond which `Waiting` takes all for equal."""


@dataclass(frozen=True, slots=True)
class Mirror:
    """Which link and joint is whose mirror image.

    Args:
        links: partner by link name.
        joints: partner by joint name.
        signs: +1 if the partner's position and torque are equal in a symmetric posture, -1 if opposite.
    """

    links: Mapping[str, str]
    joints: Mapping[str, str]
    signs: Mapping[str, float]

    def is_middle(self, link: str) -> bool:
        """Whether a link is its own partner."""
        return self.links[link] == link


def mirror_of(tree: Tree) -> Mirror:
    """The mirror symmetry of a tree of numbers.

    Raises:
        ModelError: naming a link that has no mirror partner, with the one that comes nearest.
    """
    links: dict[str, str] = {tree.root: tree.root}
    joints: dict[str, str] = {}
    signs: dict[str, float] = {}
    _refuse_unequal(tree, tree.link_by_name[tree.root], tree.link_by_name[tree.root])
    waiting = Waiting(tree)
    for joint in tree.joints:
        if joint.name in joints:
            continue
        partner = _partner(tree, joint, links[joint.parent], waiting)
        waiting.discard(joint, partner)
        for one, other in ((joint, partner), (partner, joint)):
            links[one.child], joints[one.name] = other.child, other.name
            signs[one.name] = _sign(joint, partner)
    return Mirror(links, joints, signs)


class Waiting:
    """The joints without a partner so far; mirror images are found without looking at all of them.

    Each joint has a number of its own, a weighted sum of its place, its range and its link's inertia. That of
    a joint's mirror image is known up to the tolerances, so that only joints of such numbers are looked at.

    Args:
        tree: of numbers.
    """

    WEIGHTS = tuple(1.0 + (k * 0.6180339887498949) % 1.0 for k in range(14))

    def __init__(self, tree: Tree) -> None:
        self._tree = tree
        self._joints: dict[tuple[str, JointKind], dict[float, dict[str, tuple[int, Joint]]]] = {}
        for order, joint in enumerate(tree.joints):
            same = self._joints.setdefault((joint.parent, joint.kind), {}).setdefault(self._number(joint), {})
            same[joint.name] = (order, joint)
        self._numbers = {place: sorted(numbers) for place, numbers in self._joints.items()}

    def among(self, parent: str) -> list[Joint]:
        """All that wait below a link, in the tree's order."""
        groups = [same for kind in JointKind for same in self._joints.get((parent, kind), {}).values()]
        return [
            joint
            for _, joint in sorted((entry for same in groups for entry in same.values()), key=itemgetter(0))
        ]

    def like(self, joint: Joint, parent: str) -> Iterator[Joint]:
        """Those that wait below a link and may be a joint's mirror image, in the tree's order."""
        place = (parent, joint.kind)
        numbers = self._numbers.get(place, [])
        least, most = self._image(joint)
        groups = []
        for number in numbers[bisect_left(numbers, least) :]:
            if number > most:
                break
            groups.append(self._joints[place][number].values())
        return (candidate for _, candidate in merge(*groups, key=itemgetter(0)))

    def discard(self, *joints: Joint) -> None:
        """These have a partner now."""
        for joint in joints:
            self._joints[joint.parent, joint.kind][self._number(joint)].pop(joint.name, None)

    def _number(self, joint: Joint) -> float:
        figures = _figures(
            joint, joint.parent_from_child.translation, self._tree.link_by_name[joint.child].inertia
        )
        return sum(weight * figure for weight, figure in zip(self.WEIGHTS, figures, strict=True))

    def _image(self, joint: Joint) -> tuple[float, float]:
        """Least and largest number of a joint's mirror image: tolerances, and what is lost in rounding."""
        place = mirrored_point(joint.parent_from_child.translation)
        figures = _figures(joint, place, self._tree.link_by_name[joint.child].inertia.mirrored())
        parts = [weight * figure for weight, figure in zip(self.WEIGHTS, figures, strict=True)]
        slack = 2.0 * TOLERANCE * sum(self.WEIGHTS) + 1e-14 * sum(map(abs, parts))
        return sum(parts) - slack, sum(parts) + slack


def _figures(joint: Joint, place: Vector, inertia: Inertia) -> tuple[float, ...]:
    """What a joint and its mirror image have in common: place, range, mass, centre and tensor."""
    span = min(joint.upper - joint.lower, WIDEST) if joint.upper > joint.lower else 0.0
    rows = inertia.about_center
    tensor = (rows[0][0], rows[0][1], rows[0][2], rows[1][1], rows[1][2], rows[2][2])
    return tuple(float(figure) for figure in (*place, span, inertia.mass, *inertia.center, *tensor))


def _partner(tree: Tree, joint: Joint, parent: str, waiting: Waiting) -> Joint:
    """The mirror image of a joint among those of its parent's partner."""
    link = tree.link_by_name[joint.child]
    for candidate in waiting.like(joint, parent):
        body = tree.link_by_name[candidate.child]
        if _same_place(tree, joint, candidate) and _sign_fits(joint, candidate) and _same_body(link, body):
            return candidate
    candidates = waiting.among(parent)
    for candidate in candidates:
        if _same_place(tree, joint, candidate) and _sign_fits(joint, candidate):
            _refuse_unequal(tree, link, tree.link_by_name[candidate.child])
    nearest = min((c for c in candidates if c is not joint), key=lambda c: _distance(joint, c), default=None)
    found = "none" if nearest is None else f"none (the nearest is '{nearest.name}')"
    raise ModelError(tree.name, f"joint {joint.name}", "a mirror image in the plane y = 0", found)


def _same_place(tree: Tree, joint: Joint, other: Joint) -> bool:
    """Whether two joints are at mirrored places; a bare frame may be turned as it likes."""
    if joint.kind is not other.kind or _distance(joint, other) > TOLERANCE:
        return False
    if all(_is_bare(tree, one.child) for one in (joint, other)):
        return True
    mine, its = joint.parent_from_child, other.parent_from_child
    image = mirrored_matrix(mine.rotation)
    turned = max(
        abs(a - b) for r, s in zip(image, its.rotation, strict=True) for a, b in zip(r, s, strict=True)
    )
    return bool(turned <= TOLERANCE)


def _is_bare(tree: Tree, link: str) -> bool:
    return not tree.child_joints[link] and bool(tree.link_by_name[link].inertia.mass == 0.0)


def _distance(joint: Joint, other: Joint) -> float:
    image = mirrored_point(joint.parent_from_child.translation)
    return float(max(abs(a - b) for a, b in zip(image, other.parent_from_child.translation, strict=True)))


def _sign(joint: Joint, other: Joint) -> float:
    """+1 or -1, or 0 when the axes are no mirror images."""
    if joint.kind is JointKind.FIXED:
        return 1.0
    image = mirrored_point(joint.axis)
    along = sum(a * b for a, b in zip(image, other.axis, strict=True))
    if abs(abs(along) - 1.0) > TOLERANCE:
        return 0.0
    slides = joint.kind is JointKind.PRISMATIC
    return 1.0 if (along > 0.0) == slides else -1.0


def _sign_fits(joint: Joint, other: Joint) -> bool:
    sign = _sign(joint, other)
    if sign == 0.0:
        return False
    expected = (joint.lower, joint.upper) if sign > 0.0 else (-joint.upper, -joint.lower)
    given = (other.lower, other.upper)
    return all(a == b or abs(a - b) <= TOLERANCE for a, b in zip(expected, given, strict=True))


def _refuse_unequal(tree: Tree, link: Link, image: Link) -> None:
    if not _same_body(link, image):
        found = f"'{image.name}', whose mass or shape differs"
        if link.name == image.name:
            found = "a mass or shape that is not symmetric"
        raise ModelError(tree.name, f"link {link.name}", "a mirror image in the plane y = 0", found)


def _same_body(link: Link, image: Link) -> bool:
    mine, its = link.inertia, image.inertia
    expected = mine.mirrored()
    pairs = [(expected.mass, its.mass), *zip(expected.center, its.center, strict=True)]
    for r, s in zip(expected.about_center, its.about_center, strict=True):
        pairs += zip(r, s, strict=True)
    return all(abs(a - b) <= TOLERANCE for a, b in pairs)


def left_half(tree: Tree, mirror: Mirror) -> tuple[Tree, frozenset[str]]:
    """The middle line and the left branches of a symmetric tree, which may hold expressions.

    Returns:
        The smaller tree, and the joints at which its left branches begin: each stands for a right one too.
    """
    kept = {tree.root}
    begins = set()
    for joint in tree.joints:
        if joint.parent not in kept:
            continue
        begins_here = mirror.is_middle(joint.parent) and not mirror.is_middle(joint.child)
        if begins_here and not _is_left(tree, joint, mirror):
            continue
        kept.add(joint.child)
        if begins_here:
            begins.add(joint.name)
    links = tuple(link for link in tree.links if link.name in kept)
    joints = tuple(joint for joint in tree.joints if joint.child in kept)
    return Tree(tree.name, links, joints), frozenset(begins)


def _is_left(tree: Tree, joint: Joint, mirror: Mirror) -> bool:
    """Whether the branch below a joint of the middle line goes to the left (y > 0), at zero positions."""
    first: Placement = joint.parent_from_child
    names = [joint.child]
    places = {joint.child: first}
    while names:
        name = names.pop(0)
        if abs(float(places[name].translation[1])) > TOLERANCE:
            return float(places[name].translation[1]) > 0.0
        for below in tree.child_joints[name]:
            places[below.child] = places[name] @ below.parent_from_child
            names.append(below.child)
    return joint.name < mirror.joints[joint.name]
