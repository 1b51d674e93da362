"""The candidates for a mirror image: the links on the parent's partner that are nobody's image so far.

The best one comes nearest to the image: in its place, what hangs below it, its centre of mass, its mass and
its range. Names decide among equals alone.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping

import numpy as np
from numpy.typing import NDArray

from evodesign.tree.mirror_images import MIRROR, Difference, Figure, Seen, Tolerance, differences
from evodesign.tree.model import Joint, JointKind, Tree

Array = NDArray[np.float64]

NEAREST = 8
"""So many candidates are compared in every figure; more are as near only where names have to decide."""

WIDEST = 1e3
"""Range of a joint [rad or m] beyond which all are taken for equal in choosing candidates."""

IMAGE: Array = np.tile(
    np.concatenate([MIRROR, MIRROR, MIRROR, -MIRROR, MIRROR, [1.0, 1.0, 1.0, -1.0, -1.0, 1.0, 1.0, 1.0]]), 2
)
"""What the plane does to the features of a link (`_figures`), and to their means over its branch."""

FAR = 0.02
"""A candidate whose features are further off than the nearest one's by this [m] is not the image, even if its
own figures fit: the axis of a hip's pitch is its own image, the leg below it is not."""

WHERE = frozenset({Figure.PLACE, Figure.AXIS})
"""Figures beyond whose tolerance a joint is another one, not the image that differs."""


class Unpaired(Exception):
    """A link without a mirror image.

    Args:
        seen: what has none.
        nearest: what comes nearest to it, if there is anything.
        beyond: the differences between both that are beyond the tolerance.
    """

    def __init__(self, seen: Seen, nearest: Seen | None, beyond: tuple[Difference, ...] = ()) -> None:
        super().__init__(seen.link)
        self.seen, self.nearest, self.beyond = seen, nearest, beyond

    @property
    def key(self) -> str:
        """What has no partner, as messages name it."""
        return f"link {self.seen.link}" if self.seen.joint is None else f"joint {self.seen.joint.name}"

    @property
    def found(self) -> str:
        """What was found in the place of a partner."""
        other = self.nearest
        if other is None or other.joint is None or other.link == self.seen.link:
            return "none"
        return f"none (the nearest is '{other.joint.name}')"


def beyond_of(found: Iterable[Difference]) -> tuple[Difference, ...]:
    """The differences that are larger than is allowed."""
    return tuple(each for each in found if each.excess > 1.0)


class Candidates:
    """The links without a partner so far, by what they hang on.

    Siblings are compared in numpy: 3,000 with each other take a fraction of a second.

    Args:
        tree: of numbers.
        seen: its links in the root's frame.
        tolerance: up to which they are mirror images.
        strict: whether limits, masses, centres and inertias must be within it, too.
    """

    def __init__(self, tree: Tree, seen: Mapping[str, Seen], tolerance: Tolerance, *, strict: bool) -> None:
        self._below, self._seen, self._tolerance, self._strict = tree.child_joints, seen, tolerance, strict
        self._forms, features = _forms(tree, seen), _features(tree, seen, slides=tolerance.slides)
        self._images = {name: IMAGE * row for name, row in features.items()}
        self._rows = {
            name: np.array([features[joint.child] for joint in joints])
            for name, joints in tree.child_joints.items()
        }
        self._taken = {name: np.zeros(len(joints), dtype=bool) for name, joints in tree.child_joints.items()}
        self._position = {
            joint.child: number
            for joints in tree.child_joints.values()
            for number, joint in enumerate(joints)
        }

    def discard(self, *partners: Seen) -> None:
        """These have a partner now."""
        for each in partners:
            self._taken[_joint(each).parent][self._position[each.link]] = True

    def best(self, one: Seen, parent: str) -> Seen | None:
        """The link below a parent that is the mirror image; None for a frame that has none.

        Raises:
            Unpaired: there is none, and it is no bare frame.
        """
        distances = self._distances(one, parent)
        near = self._near(one, parent, distances)
        ranked = sorted((self._rank(one, other, distances[number]), number) for number, other in near.items())
        for (fails, reserved, other_form, *_), number in ranked:
            other = near[number]
            if not fails and (one.carries or not reserved):
                return other
            beyond = self._beyond(one, other)
            elsewhere = any(each.figure in WHERE for each in beyond)
            if one.carries and not (self._strict or other_form or elsewhere):
                return other
            if one.carries and not (other.link == one.link and elsewhere):
                raise Unpaired(one, other, beyond)
        if one.carries:
            raise Unpaired(one, self._nearest(one, parent, distances))
        return None

    def _nearest(self, one: Seen, parent: str, distances: Array) -> Seen | None:
        """What comes nearest to the image, of whatever kind."""
        others = (joint.child for joint in self._below[parent])
        known = [(distance, name) for distance, name in zip(distances.tolist(), others, strict=False)]
        known = [(distance, name) for distance, name in known if np.isfinite(distance) and name != one.link]
        return self._seen[min(known)[1]] if known else None

    def _distances(self, one: Seen, parent: str) -> Array:
        """How far each link below is from the image in its features; infinite where it has a partner."""
        rows, taken = self._rows[parent], self._taken[parent]
        if bool(taken.all()):
            return np.full(len(taken), np.inf)
        found: Array = np.where(taken, np.inf, np.abs(rows - self._images[one.link]).sum(axis=1))
        return found

    def _near(self, one: Seen, parent: str, distances: Array) -> dict[int, Seen]:
        """The nearest that move and carry like this one, and the one of the mirrored name, by position."""
        joints, most, found = self._below[parent], math.inf, dict[int, Seen]()
        for number in np.argsort(distances, kind="stable").tolist():
            other = self._seen[joints[number].child]
            if distances[number] == math.inf or distances[number] > most or len(found) == NEAREST:
                break
            if _alike(one, other):
                most = min(most, float(distances[number]) + FAR)
                found[number] = other
        by_name = self._seen.get(_counterpart(one.link))
        if by_name is None or by_name.joint is None or by_name.joint.parent != parent:
            return found
        named = self._position[by_name.link]
        if distances[named] != math.inf and distances[named] <= most and _alike(one, by_name):
            found[named] = by_name
        return found

    def _rank(self, one: Seen, other: Seen, distance: float) -> tuple[bool, bool, bool, float, int]:
        """Least for the best: within the tolerance, nobody else's by name, of the same form below, near."""
        same_form = self._forms[one.link] == self._forms[other.link]
        names = (_counterpart(one.link), one.link) if one.link != _counterpart(one.link) else (one.link,)
        fitting = names.index(other.link) if other.link in names else len(names)
        fails, reserved = bool(self._beyond(one, other)), self._is_reserved(one, other)
        return fails, reserved, not same_form, round(float(distance), 6), fitting

    def _is_reserved(self, one: Seen, other: Seen) -> bool:
        """Whether a link is, by its name and in every figure, the image of a sibling of this one."""
        sibling = self._seen.get(_counterpart(other.link))
        if sibling is None or sibling.joint is None or sibling.link in (one.link, other.link):
            return False
        alike = sibling.joint.parent == _joint(one).parent and _alike(sibling, other)
        return alike and not self._beyond(sibling, other)

    def _beyond(self, one: Seen, other: Seen) -> tuple[Difference, ...]:
        return beyond_of(differences(one, other, self._tolerance))


def _joint(seen: Seen) -> Joint:
    if seen.joint is None:
        raise ValueError("the root hangs on no joint")
    return seen.joint


def _alike(one: Seen, other: Seen) -> bool:
    """Whether two move in the same manner and are both frames or both not."""
    return _joint(one).kind is _joint(other).kind and one.carries == other.carries


def _forms(tree: Tree, seen: Mapping[str, Seen]) -> Mapping[str, int]:
    """A number for each link, the same where the branches below have the same form, frames left out."""
    below: dict[str, list[tuple[JointKind, int]]] = {link.name: [] for link in tree.links}
    known: dict[tuple[tuple[JointKind, int], ...], int] = {}
    forms: dict[str, int] = {}
    for joint in reversed(tree.joints):
        forms[joint.child] = known.setdefault(tuple(sorted(below[joint.child])), len(known))
        if seen[joint.child].carries:
            below[joint.parent].append((joint.kind, forms[joint.child]))
    return forms


def _features(tree: Tree, seen: Mapping[str, Seen], *, slides: bool) -> Mapping[str, Array]:
    """What tells a link from its siblings: its own figures, and their means over the branch from there on."""
    own = {name: _figures(each, slides=slides) for name, each in seen.items()}
    sums, counts = dict(own), dict.fromkeys(own, 1)
    for joint in reversed(tree.joints):
        if seen[joint.child].carries:
            sums[joint.parent] = sums[joint.parent] + sums[joint.child]
            counts[joint.parent] += counts[joint.child]
    return {name: np.concatenate([own[name], sums[name] / counts[name]]) for name in own}


def _figures(seen: Seen, *, slides: bool) -> Array:
    """Place and centre of mass [m], and a hundredth of the first moment, limits, axis as a line, mass, range.

    The middle of a joint's limits times its axis does not depend on the axis' sign; it is a pseudovector for
    a turn. Where the origin may lie elsewhere along the axis, the place is the anchor.
    """
    mass, joint = float(seen.inertia.mass), seen.joint
    place = seen.anchor if slides else seen.place
    center = np.array(seen.inertia.center, dtype=float) if mass > 0.0 else place
    lower, upper = (0.0, 0.0) if joint is None else (joint.lower, joint.upper)
    middle = (lower + upper) / 2.0 if math.isfinite(lower) and math.isfinite(upper) else 0.0
    straight = joint is not None and joint.kind is JointKind.PRISMATIC
    turn, slide = (0.0, middle) if straight else (middle, 0.0)
    (x, y, z), span = seen.axis, min(upper - lower, WIDEST)
    others = [x * x, y * y, z * z, x * y, y * z, z * x, mass, span]
    small = np.concatenate([mass * center, turn * seen.axis, slide * seen.axis, others])
    return np.concatenate([place, center, 0.01 * small])


SIDE = re.compile(r"(?i:left|right)|(?<![A-Za-z])[LRlr](?![a-z])|(?<=[a-z])[LR](?![a-z])")
OTHER_SIDE = {"left": "right", "right": "left", "l": "r", "r": "l"}


def _counterpart(name: str) -> str:
    """The name with left and right exchanged; the same name where it says neither."""

    def exchanged(found: re.Match[str]) -> str:
        word, other = found[0], OTHER_SIDE[found[0].lower()]
        return other.upper() if word.isupper() else other.capitalize() if word[0].isupper() else other

    return SIDE.sub(exchanged, name)
