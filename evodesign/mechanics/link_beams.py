"""Hollow links as beams: how near they are to yielding in a posture, and how far the hands give way.

What a section transmits are force and moment of all that acts beyond it: on the links further from the root,
or in the root link on those above.

    safety factor    of both ends of every beam, under the weights and wrenches of a posture
    deflection       of the hands, downwards on average, under the load alone: virtual work of the load's
                     wrenches with half a unit force on each hand, both carried by the two feet alike, over
                     all beams (bending, twist) and all actuators (windup)

Own weights of beams are left out of their moments.

Source: `hardware.structure`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from evodesign.body.placement import Placement
from evodesign.hardware.structure import (
    Failure,
    SectionLoad,
    bending_work,
    safety_factors,
    torsion_work,
)
from evodesign.mechanics.balance import GRAVITY
from evodesign.mechanics.beams import Beam, beams_of
from evodesign.tree.equip import actuators_of
from evodesign.tree.frames import link_frames
from evodesign.tree.model import Tree

Array = NDArray[np.float64]

Wrench = tuple[str, Array, Array]
"""A link, a force [N] at its origin and a moment [N m], in the axes in which the tree stands."""


class _Transmitted:
    """Force and moment about the origin that each link's subtree is under.

    Args:
        tree: of numbers.
        places: of its links.
        wrenches: on links.
    """

    def __init__(self, tree: Tree, places: Mapping[str, Placement], wrenches: Iterable[Wrench]) -> None:
        self._tree, self._places = tree, places
        self._forces = {link.name: np.zeros(3) for link in tree.links}
        self._moments = {link.name: np.zeros(3) for link in tree.links}
        for link, force, moment in wrenches:
            self._forces[link] = self._forces[link] + force
            self._moments[link] = self._moments[link] + moment + _cross(_origin(places, link), force)
        for joint in reversed(tree.joints):
            self._forces[joint.parent] = self._forces[joint.parent] + self._forces[joint.child]
            self._moments[joint.parent] = self._moments[joint.parent] + self._moments[joint.child]

    def beyond(self, beam: Beam, point: Array) -> tuple[Array, Array]:
        """Force, and moment about a point, of all beyond a beam."""
        force = sum((self._forces[child] for child in beam.beyond), start=np.zeros(3))
        moment = sum((self._moments[child] for child in beam.beyond), start=np.zeros(3))
        return force, moment - _cross(point, force)

    def torque(self, child: str, axis: Array) -> float:
        """The part of the moment about a link's origin, of all on its subtree, along an axis [N m]."""
        force, origin = self._forces[child], _origin(self._places, child)
        return float(axis @ (self._moments[child] - _cross(origin, force)))


def _cross(one: Array, other: Array) -> Array:
    """Their cross product, in a fifth of numpy's time for three numbers."""
    (a, b, c), (d, e, f) = one.tolist(), other.tolist()
    return np.array([b * f - c * e, c * d - a * f, a * e - b * d])


def _origin(places: Mapping[str, Placement], link: str) -> Array:
    return np.array(places[link].translation, float)


@dataclass(frozen=True, slots=True, order=True)
class Safety:
    """By how much what a beam transmits may grow, and how it gives way then."""

    factor: float
    failure: Failure


def link_safety(
    tree: Tree, base: Placement, joints: Mapping[str, float], wrenches: Sequence[Wrench]
) -> dict[str, Safety]:
    """The lesser safety of both ends of each of a tree's beams in a posture, by link.

    Args:
        tree: of numbers.
        base: where the root link is.
        joints: positions [rad] by name.
        wrenches: on hands and feet; weights are added.
    """
    found: dict[str, Safety] = {}
    for beam, load in loaded_ends(tree, base, joints, wrenches):
        for failure, factor in safety_factors(beam.section, load, beam.length, beam.material).items():
            safety = Safety(float(factor), failure)
            found[beam.link] = min(safety, found.get(beam.link, safety))
    return found


def loaded_ends(
    tree: Tree, base: Placement, joints: Mapping[str, float], wrenches: Sequence[Wrench]
) -> Iterator[tuple[Beam, SectionLoad]]:
    """What both ends of each of a tree's beams transmit in a posture; arguments as in `link_safety`."""
    places = link_frames(tree, base, joints)
    transmitted = _Transmitted(tree, places, [*wrenches, *weights(tree, places)])
    for beam in beams_of(tree, places):
        along, first, second = beam.axes
        for end in beam.ends:
            force, moment = transmitted.beyond(beam, end)
            bending = float(moment @ first), float(moment @ second)
            yield beam, SectionLoad(float(force @ along), bending, float(moment @ along))


def weights(tree: Tree, places: Mapping[str, Placement]) -> Iterator[Wrench]:
    """Of all links."""
    for link in tree.links:
        inertia = link.inertia
        force = np.array([0.0, 0.0, -GRAVITY * float(inertia.mass)])
        centre = np.array(places[link.name].apply(inertia.center), float) - _origin(places, link.name)
        yield link.name, force, _cross(centre, force)


@dataclass(frozen=True, slots=True)
class Shares:
    """A deflection as the sum of its causes.

    Args:
        links: what the bending and twist of each beam add [m], by link.
        windup: what the gear of each actuator adds [m], by joint.
    """

    links: Mapping[str, float]
    windup: Mapping[str, float]

    @property
    def total(self) -> float:
        """The deflection [m]."""
        return sum(self.links.values()) + sum(self.windup.values())


def hand_deflection(
    tree: Tree,
    base: Placement,
    joints: Mapping[str, float],
    hands: Mapping[str, Array],
    soles: Sequence[str],
) -> Shares:
    """How far beams and actuators let the hands give way downwards under the load, the mean of both hands.

    Args:
        tree: of numbers.
        base: where the root link is.
        joints: positions [rad] by name.
        hands: force [N] and moment [N m] of the load on each hand, by its frame.
        soles: frames under the feet, which carry the load in equal parts.
    """
    places = link_frames(tree, base, joints)
    load = [(frame, wrench[:3], wrench[3:]) for frame, wrench in hands.items()]
    unit = [(frame, np.array([0.0, 0.0, -1.0 / len(hands)]), np.zeros(3)) for frame in hands]
    return virtual_work(tree, places, load, unit, soles)


def virtual_work(
    tree: Tree,
    places: Mapping[str, Placement],
    load: Sequence[Wrench],
    unit: Sequence[Wrench],
    soles: Sequence[str],
) -> Shares:
    """How far a load moves along a unit load.

    Args:
        tree: of numbers.
        places: of its links.
        load: wrenches on frames.
        unit: wrenches of a force of 1.
        soles: frames under the feet, which carry both in equal parts.
    """
    real, virtual = (
        _Transmitted(tree, places, [*wrenches, *carried(places, wrenches, soles)])
        for wrenches in (load, unit)
    )
    links: dict[str, float] = {}
    for beam in beams_of(tree, places):
        along, *across = beam.axes
        ends = [(real.beyond(beam, end)[1], virtual.beyond(beam, end)[1]) for end in beam.ends]
        for axis, moment in zip(across, beam.section.second_moments, strict=True):
            (big, small), (big_end, small_end) = ((float(m @ axis), float(v @ axis)) for m, v in ends)
            stiffness = beam.material.young * float(moment)
            bent = bending_work(beam.length, stiffness, (big, big_end), (small, small_end))
            links[beam.link] = links.get(beam.link, 0.0) + bent
        twist, unit_twist = (float(each @ along) for each in ends[0])
        stiffness = beam.material.shear * float(beam.section.torsion_constant)
        links[beam.link] += torsion_work(beam.length, stiffness, twist, unit_twist)
    windup = {}
    for name, actuator in actuators_of(tree).items():
        joint = tree.joint_by_name[name]
        axis = np.array(places[joint.child].rotation, float) @ np.array(joint.axis)
        torques = (each.torque(joint.child, axis) for each in (real, virtual))
        windup[name] = float(np.prod([*torques])) / float(actuator.stiffness)
    return Shares(links, windup)


def carried(
    places: Mapping[str, Placement], wrenches: Sequence[Wrench], soles: Sequence[str]
) -> Iterator[Wrench]:
    """What the feet answer to wrenches on hands, in equal parts."""
    middle = np.mean([_origin(places, sole) for sole in soles], axis=0)
    force = np.sum([each[1] for each in wrenches], axis=0)
    moment = np.sum(
        [each[2] + _cross(_origin(places, each[0]) - middle, each[1]) for each in wrenches], axis=0
    )
    for sole in soles:
        yield sole, -force / len(soles), -moment / len(soles)
