"""Seats of motors: what the link that holds a motor is cut and given for it.

    body = (walls - housings) + flanges

A housing cuts a bore of its diameter through the walls of its link. A flange is a flat ring about the housing
across its axis, as thick as the wall and within the link's outer surface: nothing of a seat is where the
link was not, so what keeps clear of the link keeps clear of its seats. Along the axis the flange is where
most of its bore is within the link; of such places where the link has a wall already, and of these at the one
nearest to the joint. It is the narrowest, of at least `LIP`, that reaches the wall over `REACHED` of its
circumference; one that the link's end cuts off joins the wall there. A full link needs no flange. A motor
whose rim is outside of its link has no seat.

Balls, which the mass model takes for motors without a mounting, have no seats.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from evodesign.body.placement import Placement
from evodesign.body.shape import Box, Cylinder, Shape, Solid, Sphere
from evodesign.report.cad import kernel
from evodesign.report.cad.outlines import Array
from evodesign.report.cad.parts import LinkPart, MotorPart, Parts
from evodesign.tree.mesh_write import in_frame

LIP = 0.15
"""Least width of a flange, as a share of the bore's radius."""

REACHED = 0.25
"""Share of a whole flange, by angle, that ends in the wall at least."""

AROUND, ALONG = 180, 61
"""Directions about a motor's axis, and places along it, that are tried."""

STEP = 1e-3
"""From one radius of a flange that is tried to the next [m]."""


Flags = NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class Seat:
    """Where a motor is held in its link.

    Args:
        motor: that it is for.
        solid: number of the link's solid that has the flange.
        along: from the middle of the housing to that of the flange, along the axis [m].
        outside: radius of the flange [m].
        thickness: of the flange [m]; 0 in a full link, which is the flange.
        held: share of the bore's circumference that is within the link at the flange.
    """

    motor: MotorPart
    solid: int
    along: float
    outside: float
    thickness: float
    held: float


@dataclass(frozen=True, slots=True)
class SeatedLink:
    """The bodies of a link, by solid, and the seats of the motors that it holds."""

    bodies: tuple[kernel.Body, ...]
    seats: tuple[Seat, ...]


def seated_links(parts: Parts) -> Mapping[str, SeatedLink]:
    """The bodies of all links with solids, by name."""
    return {part.name: _seated(part, parts) for part in parts.links}


def _seated(part: LinkPart, parts: Parts) -> SeatedLink:
    solids = part.link.solids
    mounted = [motor for motor in parts.motors_of(part.name) if motor.actuator.mounting is not None]
    seats = [seat for motor in mounted for seat in _seats(motor, solids)]
    bores = [_housing(seat.motor, seat.motor.link_from_motor) for seat in seats]
    bodies = [kernel.body_of(solid) for solid in solids]
    for seat in seats:
        if seat.thickness > 0.0:
            flange = _flange(seat, solids[seat.solid], part, parts)
            bodies[seat.solid] = kernel.united([bodies[seat.solid], flange])
    return SeatedLink(tuple(kernel.cut(body, bores) for body in bodies), tuple(seats))


def _flange(seat: Seat, solid: Solid, part: LinkPart, parts: Parts) -> kernel.Body:
    """A flange in its link's frame, less the housings of all motors."""
    disc = kernel.solid_body(Cylinder(seat.outside, seat.thickness), None)
    place = seat.motor.link_from_motor @ Placement(translation=(0.0, 0.0, seat.along))
    link_from_root = part.root_from_link.inverse
    near = (motor for motor in parts.motors if _is_near(motor, seat.motor))
    tools = [_housing(motor, link_from_root @ motor.root_from_motor) for motor in near]
    return kernel.cut(kernel.common(kernel.outer_body(solid), kernel.placed(disc, place)), tools)


def _seats(motor: MotorPart, solids: Sequence[Solid]) -> Iterator[Seat]:
    """The seat of a motor in the solid that holds most of its rim; none where its rim is outside of all."""
    found = [seat for number, solid in enumerate(solids) for seat in _places(motor, number, solid)]
    if found:
        best = max(score for *score, _ in found)
        alike = [seat for *score, seat in found if score == best]
        yield alike[len(alike) // 2]


def _places(motor: MotorPart, number: int, solid: Solid) -> Iterator[tuple[float, float, float, Seat]]:
    """Places of a motor's flange in a solid, each after what it is chosen for, the more the better."""
    diameter, length = map(float, motor.actuator.size)
    radius, wall = diameter / 2.0, 0.0 if solid.wall is None else float(solid.wall)
    solid_from_motor = solid.link_from_solid.inverse @ motor.link_from_motor
    joint = -motor.actuator.mounting.share * length if motor.actuator.mounting else 0.0
    for along in np.linspace(-(length - wall) / 2.0, (length - wall) / 2.0, ALONG).tolist():
        within = _is_in(solid.shape, _circle(radius, along, solid_from_motor))
        if within.any():
            walled = _is_in(
                solid.shape, middle := _circle((1.0 + LIP / 2.0) * radius, along, solid_from_motor)
            )
            if wall > 0.0:
                walled &= ~_is_in(solid.shape.inside(wall), middle)
            width = LIP * radius
            if wall > 0.0 and within.all():
                width = _width(solid, radius, along, solid_from_motor)
            seat = Seat(motor, number, along, radius + width, wall, float(within.mean()))
            yield round(seat.held, 1), round(float(walled.mean()), 1), -round(abs(along - joint), 2), seat


def _width(solid: Solid, radius: float, along: float, solid_from_motor: Placement) -> float:
    """The least width of a flange that reaches the wall [m]."""
    cavity, width = solid.shape.inside(float(solid.wall or 0.0)), LIP * radius
    while np.mean(~_is_in(cavity, _circle(radius + width, along, solid_from_motor))) < REACHED:
        width += STEP
    return width


def _circle(radius: float, along: float, solid_from_motor: Placement) -> Array:
    """Points about a motor's axis in the solid's frame, shape (AROUND, 3) [m]."""
    angles = np.linspace(0.0, 2.0 * np.pi, AROUND, endpoint=False)
    points = np.column_stack([radius * np.cos(angles), radius * np.sin(angles), np.full(AROUND, along)])
    return in_frame(points, solid_from_motor)


def _is_in(shape: Shape, points: Array) -> Flags:
    """Which points are within a shape, in its frame."""
    match shape:
        case Sphere(radius):
            return np.asarray(np.linalg.norm(points, axis=1) <= float(radius))
        case Cylinder(radius, length):
            across = np.linalg.norm(points[:, :2], axis=1) <= float(radius)
            return np.asarray(across & (np.abs(points[:, 2]) <= float(length) / 2.0))
        case Box():
            return np.asarray((np.abs(points) <= np.array(shape.sides, float) / 2.0).all(axis=1))


def _is_near(one: MotorPart, other: MotorPart) -> bool:
    """Whether a motor may touch the flange of another, by balls about both."""
    places = (np.array(each.root_from_motor.translation, float) for each in (one, other))
    return bool(
        np.linalg.norm(np.subtract(*places)) < sum(map(sum, (one.actuator.size, other.actuator.size)))
    )


def _housing(motor: MotorPart, place: Placement) -> kernel.Body:
    return kernel.placed(kernel.solid_body(motor.solid.shape, None), place)
