"""How much a joint and its link differ from another's mirror image in the plane y = 0 of the root.

All figures are those of the root's frame with every joint at zero, so that links' own frames may be turned in
any way. With M = diag(1, -1, 1):

    place       of a joint's origin, M p; a moving joint's may lie elsewhere along the axis (`Tolerance`)
    axis        a rotation's axis is a pseudovector: equal joint positions are mirror images when
                a' = -M a (sign +1); opposite ones when a' = M a (sign -1); a slide's axis the other way round
    limits      equal for sign +1, exchanged and negated for sign -1
    link        mass, centre of mass M c, tensor about it M I M

The two of a pair differ by what lies between them. What is its own image (a link of the middle line) differs
by half of what lies between it and its image: its distance from being symmetric. In either case half of a
pair's difference, or all of a middle one's, is what averaging moves.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from evodesign.body.inertia import Inertia
from evodesign.body.placement import Placement
from evodesign.tree.frames import link_frames
from evodesign.tree.model import Joint, JointKind, Tree

Array = NDArray[np.float64]

MIRROR: Array = np.array([1.0, -1.0, 1.0])
"""The diagonal of M."""


@dataclass(frozen=True, slots=True)
class Tolerance:
    """Up to which difference two are mirror images.

    Args:
        place: of an origin or a centre of mass [m]; of a slide's limits too.
        place_share: of an origin, as a share of the longest link between it and the root [-].
        angle: of an axis [rad].
        limits: of a turning joint's limits [rad].
        mass_share: of a mass [-].
        inertia_share: of a tensor's entry, as a share of the link's largest principal moment [-].
        light: a mass below this is compared as if it were this [kg].
        moment: mass times distance by which a centre of mass may differ though it is further off [kg m].
        small: a largest principal moment below this counts as this [kg m^2].
        slides: whether the origin of a moving joint may lie elsewhere along its axis, which moves nothing.
    """

    place: float
    place_share: float
    angle: float
    limits: float
    mass_share: float
    inertia_share: float
    light: float
    moment: float
    small: float
    slides: bool


EXACT = Tolerance(1e-9, 0.0, math.sqrt(2e-9), 1e-9, 1e-9, 1e-9, 1.0, 0.0, 1.0, slides=False)
"""Equal but for rounding: 1e-9 in every figure, and in the cosine of an axis."""

PLACE, SHARE, ANGLE, LIMIT, MASS, INERTIA = 1e-3, 0.01, math.radians(0.5), math.radians(1.0), 0.02, 0.05
LIGHT, BALANCE, SMALL = 0.003, 3e-4, 3e-5


def near(mass: float) -> Tolerance:
    """Equal as CAD exports are: 1 mm, 0.5 degree, 1 degree of a limit, 2 % of a mass, 5 % of an inertia.

    Origins may differ by 1 % of the longest link above them, where that is more: a shoulder that is off moves
    all of its arm.
    What is small beside the whole robot is not held to a share of itself: masses below 0.3 % of the robot's
    count as that; a centre of mass may be further off if that moves the robot's by no more than 0.3 mm;
    moments below 3e-5 m^2 times the robot's mass count as that.

    Args:
        mass: of the whole robot or person [kg].
    """
    return Tolerance(
        PLACE, SHARE, ANGLE, LIMIT, MASS, INERTIA, LIGHT * mass, BALANCE * mass, SMALL * mass, slides=True
    )


class Figure(StrEnum):
    """What may differ; the value is its name in messages."""

    PLACE = "place"
    AXIS = "axis"
    LIMITS = "limits"
    MASS = "mass"
    CENTER = "centre of mass"
    INERTIA = "inertia"


@dataclass(frozen=True, slots=True)
class Difference:
    """How much a joint or link differs from another's mirror image, or from its own.

    Args:
        figure: what differs.
        noun: `joint` or `link`.
        names: of both; the same name twice on the middle line.
        size: of the difference: [m], [rad], or a share [-] of a mass or of the largest moment.
        most: up to which the two are mirror images, in the same unit.
        unit: `m`, `rad` or `1`.
    """

    figure: Figure
    noun: str
    names: tuple[str, str]
    size: float
    most: float
    unit: str

    @property
    def excess(self) -> float:
        """The difference in parts of what is allowed: 1 at the tolerance."""
        return self.size / self.most

    def __str__(self) -> str:
        one, other = self.names
        whose = f"{one} from the middle" if one == other else f"{one} / {other}"
        return f"{_amount(self.size, self.unit)} in the {self.figure} of {self.noun} {whose}"

    @property
    def allowed(self) -> str:
        """The tolerance in words."""
        return _amount(self.most, self.unit)


def _amount(size: float, unit: str) -> str:
    factor, symbol = {"m": (1e3, "mm"), "rad": (180.0 / math.pi, "degrees"), "1": (100.0, "%")}[unit]
    return f"{factor * size:.2g} {symbol}" if factor * size < 99.5 else f"{factor * size:.0f} {symbol}"


@dataclass(frozen=True, slots=True, eq=False)
class Seen:
    """A link and the joint above it, in the root's frame with every joint at zero.

    Args:
        link: its name.
        joint: above it; None at the root.
        frame: root_from_link.
        place: of the joint's origin [m].
        axis: unit vector; zero where nothing moves.
        inertia: of the link, `center` and `about_center` in the root's frame.
        carries: whether the branch from here on has mass or a joint that moves; a bare frame has neither.
        reach: the largest distance between two joints that follow each other from the root to here [m].
    """

    link: str
    joint: Joint | None
    frame: Placement
    place: Array
    axis: Array
    inertia: Inertia
    carries: bool
    reach: float = 0.0

    @property
    def moves(self) -> bool:
        """Whether the joint can move."""
        return self.joint is not None and self.joint.kind is not JointKind.FIXED

    @property
    def anchor(self) -> Array:
        """A point that does not depend on where along the axis the origin lies: the nearest to the root's."""
        return self.place - (self.place @ self.axis) * self.axis if self.moves else self.place


def seen_in_root(tree: Tree) -> Mapping[str, Seen]:
    """Every link of a tree of numbers, by name."""
    frames = link_frames(tree, Placement(), {})
    carries = {link.name: bool(link.inertia.mass > 0.0) for link in tree.links}
    for joint in reversed(tree.joints):
        carries[joint.parent] |= carries[joint.child] or joint.kind is not JointKind.FIXED
    reach = {tree.root: 0.0}
    for joint in tree.joints:
        length = math.hypot(*joint.parent_from_child.translation)
        reach[joint.child] = max(reach[joint.parent], length)
    return {
        link.name: _seen(tree, link.name, frames[link.name], carries[link.name], reach[link.name])
        for link in tree.links
    }


def _seen(tree: Tree, name: str, frame: Placement, carries: bool, reach: float) -> Seen:
    joint, axis = tree.parent_joint.get(name), np.zeros(3)
    if joint is not None and joint.kind is not JointKind.FIXED:
        axis = np.array(frame.rotation) @ np.array(joint.axis)
        carries = True
    inertia = tree.link_by_name[name].inertia.moved(frame)
    place: Array = np.array(frame.translation, dtype=float)
    return Seen(name, joint, frame, place, axis, inertia, carries, reach)


def sign_of(one: Seen, other: Seen) -> float:
    """+1 if equal positions of the two joints are mirror images, -1 if opposite ones are."""
    if not one.moves or one.joint is None:
        return 1.0
    slides = one.joint.kind is JointKind.PRISMATIC
    return 1.0 if (float((MIRROR * one.axis) @ other.axis) > 0.0) == slides else -1.0


def differences(one: Seen, other: Seen, tolerance: Tolerance) -> Iterator[Difference]:
    """Every figure in which `other` may differ from the mirror image of `one`; both are of one kind."""
    share = 0.5 if one.link == other.link else 1.0
    if one.joint is not None and other.joint is not None:
        names = (one.joint.name, other.joint.name)
        for figure, size, most, unit in _of_joints(one, other, tolerance):
            yield Difference(figure, "joint", names, share * size, most, unit)
    if one.inertia.mass > 0.0 or other.inertia.mass > 0.0:
        for figure, size, most, unit in _of_links(one.inertia, other.inertia, tolerance):
            yield Difference(figure, "link", (one.link, other.link), share * size, most, unit)


def _of_joints(one: Seen, other: Seen, tolerance: Tolerance) -> Iterator[tuple[Figure, float, float, str]]:
    gap = MIRROR * one.place - other.place
    if tolerance.slides and other.moves:
        gap = gap - (gap @ other.axis) * other.axis
    most = max(tolerance.place, tolerance.place_share * min(one.reach, other.reach))
    yield Figure.PLACE, math.hypot(*gap.tolist()), most, "m"
    if not one.moves or one.joint is None or other.joint is None:
        return
    along = float((MIRROR * one.axis) @ other.axis)
    across = MIRROR * one.axis - along * other.axis
    angle = math.atan2(math.hypot(*across.tolist()), abs(along))
    yield Figure.AXIS, angle, tolerance.angle, "rad"
    lower, upper = one.joint.lower, one.joint.upper
    expected = (lower, upper) if sign_of(one, other) > 0.0 else (-upper, -lower)
    given = (other.joint.lower, other.joint.upper)
    apart = max(0.0 if a == b else abs(a - b) for a, b in zip(expected, given, strict=True))
    slides = one.joint.kind is JointKind.PRISMATIC
    most, unit = (tolerance.place, "m") if slides else (tolerance.limits, "rad")
    yield Figure.LIMITS, apart, most, unit


def _of_links(
    one: Inertia, other: Inertia, tolerance: Tolerance
) -> Iterator[tuple[Figure, float, float, str]]:
    mass = (float(one.mass) + float(other.mass)) / 2.0
    counted = max(mass, tolerance.light) / mass
    yield Figure.MASS, abs(float(one.mass) - float(other.mass)) / mass, tolerance.mass_share * counted, "1"
    if one.mass <= 0.0 or other.mass <= 0.0:
        return
    image = one.mirrored()
    apart = math.dist(image.center, other.center)
    yield Figure.CENTER, apart, max(tolerance.place, tolerance.moment / mass), "m"
    tensors: list[Array] = [np.array(each.about_center) for each in (image, other)]
    gap = float(np.abs(tensors[0] - tensors[1]).max())
    if gap > 0.0:
        largest = max(float(np.linalg.eigvalsh(tensor)[-1]) for tensor in tensors)
        yield (
            Figure.INERTIA,
            gap / largest,
            tolerance.inertia_share * max(1.0, tolerance.small / largest),
            "1",
        )
