"""Where a humanoid's soles and palms are: frames of its own, or new ones from geometry.

    sole   the rectangle under the lowest two centimetres of the foot's shapes and meshes; without any, under
           a box of the foot's mass and moments of inertia
    palm   a bare frame of such a name, if it is not at the wrist; otherwise the centre of mass of the hand
           with all that it moves; at the far end of a forearm that no wrist moves

Left and right are made mirror images of each other, as long as they nearly are. Soles that no robot of its
stature has are none.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from evodesign.body.inertia import total
from evodesign.body.placement import (
    Matrix,
    Placement,
    Vector,
    mirrored_point,
    rotate,
    rpy_from_matrix,
    transpose,
)
from evodesign.body.shape import Box, Cylinder, Shape
from evodesign.guess.body_plan import BodyPlan
from evodesign.guess.limbs import Limb
from evodesign.mechanics.agent import SIDES
from evodesign.problem.agent_tables import Facing
from evodesign.tree.mesh_write import in_frame, vertices_of
from evodesign.tree.welded import WeldedBody, WeldedTree

SLAB = 0.02
"""Height above a foot's lowest point up to which it counts as its sole [m]."""

LARGEST_SOLE = 1.0 / 3.0
"""Largest length of a sole in statures: a person's is 0.15, of robots with large feet 0.28."""

SMALLEST_SOLE = 0.005
"""Least width of a sole [m]."""

LIKENESS = 0.03
"""Largest distance of a point from the mirror image of the other side's that is a matter of accuracy [m]."""

ALIKE = 0.005
"""Distances of links from a point that are no more apart count as equal [m]."""

PALM = re.compile(r"palm|grasp|tcp|tool", re.IGNORECASE)
"""Names of frames that meet a load."""

HAND = re.compile(r"hand$|hand_frame", re.IGNORECASE)
"""Names of frames that meet a load, or are where a hand begins."""

CORNERS = np.array([(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])


@dataclass(frozen=True, slots=True)
class GuessedContact:
    """A frame that meets load or ground.

    Args:
        frame: its name.
        link: that a new frame is fixed to; nothing for one that the file has.
        place: of a new frame in its link.
    """

    frame: str
    link: str = ""
    place: Placement = field(default_factory=Placement)


@dataclass(frozen=True, slots=True)
class Contacts:
    """Palms and soles by side, the size of a sole [m] along x and y, and how they were found, in words.

    Args:
        hands, soles: none where nothing believable was found.
        sole_size: length and width [m].
        why_hands, why_soles: how they were found, or why they were not.
    """

    hands: Mapping[str, GuessedContact]
    soles: Mapping[str, GuessedContact]
    sole_size: tuple[float, float]
    why_hands: str
    why_soles: str


def contacts(plan: BodyPlan) -> Contacts:
    """The contacts of a body plan.

    Args:
        plan: with or without arms; without them no hands are found.
    """
    facing = plan.facing or Facing.FORWARD
    hands, why_hands = _hands(plan, facing)
    soles, size, why_soles = _soles(plan, facing)
    return Contacts(hands, soles, size, why_hands, why_soles)


def _soles(plan: BodyPlan, facing: Facing) -> tuple[dict[str, GuessedContact], tuple[float, float], str]:
    turn = facing.axes
    points = {side: _points(plan.welded, leg.end) @ np.array(turn) for side, leg in plan.legs.items()}
    why = "the lowest 2 cm of the feet's shapes"
    if not all(len(found) for found in points.values()):
        points = {side: _equivalent_box(leg.end) @ np.array(turn) for side, leg in plan.legs.items()}
        why = "boxes of the feet's mass and inertia, for their shapes are not known: to be checked"
    centres, sizes = {}, []
    for side, found in points.items():
        low = found[found[:, 2] < found[:, 2].min() + SLAB]
        least, most = low.min(axis=0), low.max(axis=0)
        centres[side] = (*((least + most) / 2.0)[:2], found[:, 2].min())
        sizes.append(most - least)
    centres = _alike(centres)
    length, width = (round(float(extent), 3) for extent in np.mean(sizes, axis=0)[:2])
    if doubt := _doubt(plan, (length, width), centres):
        return {}, (0.0, 0.0), f"{doubt} ({why.partition(':')[0]})"
    soles = {
        side: _new_frame(plan.welded, leg, f"{side}_sole", rotate(turn, centres[side]), turn)
        for side, leg in plan.legs.items()
    }
    return soles, (length, width), why


def _doubt(plan: BodyPlan, size: tuple[float, float], centres: Mapping[str, Vector]) -> str:
    """Why no robot of this stature has such soles; nothing if one may."""
    most = LARGEST_SOLE * plan.stature
    if max(size) > most:
        return f"{size[0]:g} x {size[1]:g} m is more than a third of the robot's {plan.stature:.2f} m"
    if min(size) < SMALLEST_SOLE:
        return f"{size[0]:g} x {size[1]:g} m is no sole to stand on"
    deep = max(leg.end.origin[2] - centres[side][2] for side, leg in plan.legs.items())
    found = f"{deep:.3g} m below the last joints is deeper than the robot's {plan.stature:.2f} m"
    return found if deep > plan.stature else ""


def _hands(plan: BodyPlan, facing: Facing) -> tuple[dict[str, GuessedContact], str]:
    if not plan.arms:
        return {}, "no two arms"
    turn = facing.axes
    named = {side: _named(plan.welded, arm) for side, arm in plan.arms.items()}
    for left, left_at in named["left"].items():
        for right, right_at in named["right"].items():
            places = [rotate(transpose(turn), at) for at in (left_at, right_at)]
            if math.dist(places[0], mirrored_point(places[1])) < LIKENESS:
                return {"left": GuessedContact(left), "right": GuessedContact(right)}, "frames of such a name"
    wristless = all(arm.bend == len(arm.bodies) - 1 for arm in plan.arms.values())
    palm = _far_end if wristless else _hand_center
    centres = {side: rotate(transpose(turn), palm(plan.welded, arm)) for side, arm in plan.arms.items()}
    centres = _alike(centres)
    found = {
        side: _new_frame(plan.welded, arm, f"{side}_palm", rotate(turn, centres[side]), turn)
        for side, arm in plan.arms.items()
    }
    return (
        found,
        "the far ends of forearms without wrists" if wristless else "the centres of mass of the hands",
    )


def _hand_center(welded: WeldedTree, arm: Limb) -> Vector:
    """Centre of mass of a hand with all that it moves, in the root's frame [m]."""
    return total([body.inertia for body in welded.beyond(arm.end.name)]).center


def _far_end(welded: WeldedTree, arm: Limb) -> Vector:
    """Where the last body of an arm ends on the way from its joint to its centre of mass and beyond [m]."""
    way = np.array(arm.end.inertia.center, dtype=float) - arm.end.origin
    points = _points(welded, arm.end)
    farthest = (
        float(((points - arm.end.origin) @ way).max() / max(float(way @ way), 1e-12)) if len(points) else 2.0
    )
    x, y, z = (arm.end.origin + farthest * way).tolist()
    return x, y, z


def _named(welded: WeldedTree, arm: Limb) -> dict[str, Vector]:
    """Places in the root's frame of the bare frames of a hand whose names say that they meet a load.

    One that is only called a hand is where the hand begins if it is nearer to the wrist than to the hand's
    centre of mass.
    """
    center, wrist = _hand_center(welded, arm), arm.end.origin
    bare = [name for name in arm.end.links if not welded.tree.link_by_name[name].inertia.mass]
    places = {name: welded.places[name].translation for name in bare}
    return {
        name: at
        for name, at in places.items()
        if PALM.search(name) or (HAND.search(name) and math.dist(at, wrist) > math.dist(at, center))
    }


def _alike(points: Mapping[str, Sequence[float]]) -> dict[str, Vector]:
    """Points of both sides, made mirror images of each other if they nearly are."""
    left, right = (np.array(points[side], dtype=float) for side in SIDES)
    image = right * (1.0, -1.0, 1.0)
    if np.linalg.norm(left - image) < LIKENESS:
        left = (left + image) / 2.0
        right = left * (1.0, -1.0, 1.0)
    return {
        side: (float(p[0]), float(p[1]), float(p[2])) for side, p in zip(SIDES, (left, right), strict=True)
    }


def _new_frame(welded: WeldedTree, limb: Limb, name: str, at: Vector, axes: Matrix) -> GuessedContact:
    """A frame at a point of the root's frame, with axes there, fixed to the nearest link of a limb's end.

    A foot without an ankle does not grow with the shank that it is fixed to, and so its sole must not either.
    """
    link = _nearest(welded, limb.end, at)
    while name in welded.tree.link_by_name:
        name += "_"
    return GuessedContact(name, link, welded.places[link].inverse @ Placement(axes, at))


def frame_xyz_rpy(contact: GuessedContact) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Place of a new frame in its link as a problem file has it: [m] to the micrometre, [rad]."""
    xyz = tuple(round(value, 6) + 0.0 for value in contact.place.translation)
    rpy = tuple(round(value, 9) + 0.0 for value in rpy_from_matrix(contact.place.rotation))
    return xyz, rpy


def _nearest(welded: WeldedTree, body: WeldedBody, at: Vector) -> str:
    """The link of a body whose box, along the root's axes, is nearest to a point; of several the heaviest."""
    points = {name: found for name in body.links if len(found := _points_of(welded, name))}
    away = {
        name: float(np.linalg.norm(np.clip(at, each.min(axis=0), each.max(axis=0)) - at))
        for name, each in points.items()
    }
    near = [name for name in away if away[name] < min(away.values()) + ALIKE]
    return welded.heaviest(near or body.links)


def _points(welded: WeldedTree, body: WeldedBody) -> np.ndarray:
    """Points of a body in the root's frame, one per row: of a link's meshes, or else of its shapes."""
    return np.vstack([_points_of(welded, name) for name in body.links])


def _points_of(welded: WeldedTree, name: str) -> np.ndarray:
    """The same of one link."""
    link, place, found = welded.tree.link_by_name[name], welded.places[name], [np.empty((0, 3))]
    if link.shown:
        found += [in_frame(vertices_of(mesh), place) for mesh in link.shown]
    else:
        shapes = [(solid.shape, solid.link_from_solid) for solid in link.solids]
        shapes += [(look.shape, look.link_from_look) for look in link.looks]
        found += [in_frame(_outline(shape), place @ at) for shape, at in shapes]
    return np.vstack(found)


def _outline(shape: Shape) -> np.ndarray:
    """Points on a shape that span its box [m]."""
    if isinstance(shape, Box):
        return np.array(CORNERS * [float(side) for side in shape.sides])
    if isinstance(shape, Cylinder):
        return np.array([*_ring(float(shape.radius), float(shape.length))])
    return np.array(CORNERS * 2.0 * float(shape.radius))


def _ring(radius: float, length: float) -> Iterator[tuple[float, float, float]]:
    for angle in np.linspace(0.0, 2.0 * math.pi, 24, endpoint=False):
        for z in (-length / 2.0, length / 2.0):
            yield radius * math.cos(angle), radius * math.sin(angle), z


def _equivalent_box(body: WeldedBody) -> np.ndarray:
    """Corners, in the root's frame, of a box along its axes with a body's mass and diagonal moments."""
    inertia = body.inertia
    moments = np.array([float(inertia.about_center[i][i]) for i in range(3)])
    squares = 6.0 * (moments.sum() - 2.0 * moments) / float(inertia.mass)
    return np.array(CORNERS * np.sqrt(np.maximum(squares, 1e-4)) + [float(x) for x in inertia.center])
