"""Whether the parts of a robot go together: actuators that are bodies, beside each other and in their links.

An actuator is the cylinder of its housing (`hardware.mounting.Mounting`). While all joints are at zero it
keeps clear of

    all other actuators
    links                but for the one that holds it and those that a joint joins to that one

and two links that a joint joins stay in touch, or as near to each other as in the robot of the file. An
actuator touches the link that holds it. What holds one whose middle is in the joint is as thick as it:
across the link's length, the housing lies within the link's solid,

    ball            r >= |(R, h)|
    cylinder        r >= R where both axes are alike, else r >= |(R, h)|
    box             each of the two shorter half sides >= h |u_i| + R sqrt(1 - u_i^2)

with R the radius and h half the length of the housing, u its axis in the solid's frame. Of a link with
several solids the roomiest counts; of one without solids nothing is known.

Source: distances by coal; the support of a cylinder.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Set
from dataclasses import dataclass
from functools import lru_cache
from itertools import chain, combinations

import numpy as np

from evodesign.body.placement import Placement
from evodesign.body.shape import Cylinder, Solid, Sphere
from evodesign.collision.clearance import BodyDistance, PlacedSolids, Places, SolidBodies, places_of
from evodesign.collision.pairs import TOUCH, is_joined
from evodesign.collision.rules import BodyPair
from evodesign.collision.shapes import Array, solid_of
from evodesign.hardware.actuators import Actuator, mounted_solid
from evodesign.tree.frames import link_frames
from evodesign.tree.model import Joint, Tree
from evodesign.tree.once_per_tree import once_per_tree

ALIKE = 0.7
"""Cosine of two axes from which on they count as alike."""

PART = "actuator of "
"""How the names of actuators begin."""

Mounted = tuple[Joint, Actuator, Solid]


@dataclass(frozen=True, slots=True)
class PartClearance:
    """How much room the parts of a robot have.

    Args:
        least: of the two parts that have least, negative where they do not go together.
        lacking: the sum of what all pairs lack [m]; 0 where all go together.
        decisive: the pairs that lack room, or the one that has least.
    """

    least: BodyDistance
    lacking: float
    decisive: frozenset[BodyPair]

    @property
    def apart(self) -> float:
        """The least room [m], or minus what is lacking: continuous, and smooth while the same pairs lack."""
        return -self.lacking if self.lacking > 0.0 else self.least.distance


def part_clearance(tree: Tree, unscaled: Tree, among: Set[BodyPair] | None = None) -> PartClearance | None:
    """How much room the parts of a robot have; None where no actuator is a body.

    Args:
        tree: of a design, numbers, with its actuators.
        unscaled: that of the file.
        among: the pairs that count, as `PartClearance.decisive` has them; None: all.
    """
    concerned = None if among is None else {name for pair in among for name in pair}
    mounted = [each for each in _mounted(tree) if concerned is None or part_name(each[0]) in concerned]
    if not mounted and among is None:
        return None
    own = SolidBodies(
        tuple(part_name(joint) for joint, _, _ in mounted),
        tuple(solid_of(solid.shape, solid.link_from_solid) for _, _, solid in mounted),
    )
    frames = link_frames(tree, Placement(), {})
    at = {part_name(joint): frames[joint.parent] for joint, _, _ in mounted}
    links = SolidBodies.of_tree(tree, concerned).hulls
    placed = own.placed(at).beside(links.placed(frames))
    asked = unscaled, placed.names, len(own.names)
    if among is None:
        places = _places(*asked)
    else:
        places = places_of(placed.names, [pair for pair in _kept_apart(*asked) if pair in among])
    loose = [*_held(placed, unscaled, among), *_loose(placed, tree, mounted, among)]
    found = [*_thickness(tree, mounted), *loose, *placed.overlapping(places)]
    if among is not None:
        found = [gap for gap in found if (gap.first, gap.second) in among]
    lacking = sum(max(0.0, -gap.distance) for gap in found)
    if lacking == 0.0 and len(places):
        found.append(placed.nearest(places))
    if not found:
        return None
    least = min(found, key=lambda gap: gap.distance)
    decisive = [gap for gap in found if gap.distance < 0.0] or [least]
    return PartClearance(least, lacking, frozenset((gap.first, gap.second) for gap in decisive))


def part_name(joint: Joint) -> str:
    """What a joint's actuator is called."""
    return f"{PART}{joint.name}"


def _mounted(tree: Tree) -> Iterator[Mounted]:
    for joint in tree.joints:
        actuator = joint.actuator
        if actuator is not None and actuator.mounting is not None:
            yield joint, actuator, mounted_solid(actuator, joint.parent_from_child, joint.axis)


@once_per_tree
def _places(unscaled: Tree, names: tuple[str, ...], count: int) -> Places:
    """Which solids keep clear of each other."""
    return places_of(names, _kept_apart(unscaled, names, count))


def _kept_apart(unscaled: Tree, names: tuple[str, ...], count: int) -> Iterator[BodyPair]:
    """Which bodies keep clear of each other, of which so many, the first by name, are actuators."""
    parents = {part_name(joint): joint.parent for joint in unscaled.joints}
    own, links = names[:count], dict.fromkeys(names[count:])
    beside = ((one, link) for one in own for link in links if not is_joined(unscaled, (parents[one], link)))
    return chain(combinations(own, 2), beside)


def _held(placed: PlacedSolids, unscaled: Tree, among: Set[BodyPair] | None) -> Iterator[BodyDistance]:
    """By how much links are farther from the next ones than in the file, as negative numbers."""
    before = _joined_distances(unscaled)
    if among is not None:
        before = {pair: distance for pair, distance in before.items() if pair in among}
    for pair, distance in _distances(placed, tuple(before)).items():
        if distance > before[pair] + TOUCH:
            yield BodyDistance(*pair, before[pair] - distance)


def _loose(
    placed: PlacedSolids, tree: Tree, mounted: Iterable[Mounted], among: Set[BodyPair] | None
) -> Iterator[BodyDistance]:
    """How far actuators are from the links that hold them, as negative numbers."""
    pairs = ((part_name(joint), joint.parent) for joint, _, _ in mounted if _has_solids(tree, joint.parent))
    chosen = tuple(pair for pair in pairs if among is None or pair in among)
    for pair, distance in _distances(placed, chosen).items():
        if distance > TOUCH:
            yield BodyDistance(*pair, -distance)


def _has_solids(tree: Tree, link: str) -> bool:
    return bool(tree.link_by_name[link].solids)


@once_per_tree
def _joined_distances(unscaled: Tree) -> Mapping[BodyPair, float]:
    """How far links are from those that a joint joins to them [m], 0 of those in touch."""
    solid = {link.name for link in unscaled.links if link.solids}
    pairs = [(joint.parent, joint.child) for joint in unscaled.joints if {joint.parent, joint.child} <= solid]
    placed = SolidBodies.of_tree(unscaled).hulls.placed(link_frames(unscaled, Placement(), {}))
    return {pair: max(0.0, distance) for pair, distance in _distances(placed, tuple(pairs)).items()}


def _distances(placed: PlacedSolids, pairs: tuple[BodyPair, ...]) -> dict[BodyPair, float]:
    """How far the links of some pairs are apart [m]."""
    places = _places_of_each(placed.names, pairs)
    return {pair: placed.nearest(own).distance for pair, own in zip(pairs, places, strict=True)}


@lru_cache(maxsize=16)
def _places_of_each(names: tuple[str, ...], pairs: tuple[BodyPair, ...]) -> tuple[Places, ...]:
    return tuple(places_of(names, [pair]) for pair in pairs)


def _thickness(tree: Tree, mounted: list[Mounted]) -> Iterator[BodyDistance]:
    """How much thicker links are than what they hold in their joints."""
    for joint, actuator, solid in mounted:
        holders = tree.link_by_name[joint.parent].solids
        if actuator.mounting is not None and actuator.mounting.share == 0.0 and holders:
            axis = np.array(solid.link_from_solid.rotation, float)[:, 2]
            diameter, length = map(float, actuator.size)
            clearance = max(clearance_in(holder, axis, diameter / 2.0, length / 2.0) for holder in holders)
            yield BodyDistance(part_name(joint), joint.parent, clearance)


def clearance_in(holder: Solid, axis: Array, radius: float, half: float) -> float:
    """How much thicker a solid is than a housing that it holds [m], across its length.

    Args:
        holder: of a link.
        axis: of the housing, a unit vector in the link's frame.
        radius: of the housing [m].
        half: of its length [m].
    """
    shape = holder.shape
    if isinstance(shape, Sphere):
        return float(shape.radius) - math.hypot(radius, half)
    turned = np.abs(np.array(holder.link_from_solid.rotation, float).T @ axis)
    if isinstance(shape, Cylinder):
        return float(shape.radius) - (radius if turned[2] > ALIKE else math.hypot(radius, half))
    sides = np.array(shape.sides, float) / 2.0
    rooms = sides - half * turned - radius * np.sqrt(np.maximum(0.0, 1.0 - turned**2))
    return float(np.delete(rooms, np.argmax(sides)).min())
