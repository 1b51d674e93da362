"""Seats of motors: volumes by hand, one piece each, and no wall where a housing is."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import pytest

from evodesign.body.placement import Placement
from evodesign.body.shape import Box, Shape, Solid, Sphere
from evodesign.hardware.actuators import actuator_of_row, catalogue
from evodesign.hardware.mounting import Mounting
from evodesign.report.cad import kernel
from evodesign.report.cad.clashes import motor_clashes
from evodesign.report.cad.parts import Parts, parts_of
from evodesign.report.cad.seats import SeatedLink, seated_links
from evodesign.tree.equip import with_actuators
from evodesign.tree.model import Joint, JointKind, Link, Tree
from tests.report.cad.robots import designed

WALL = 0.002


def held(
    shape: Shape, joint: Placement, share: float = 0.0, wall: float | None = WALL
) -> tuple[Parts, SeatedLink]:
    """A link that holds an X6-60 about z of a joint, and its seat."""
    links = (Link("arm", (Solid(shape, Placement(), 2700.0, wall),)), Link("hand"))
    tree = Tree("arm", links, (Joint("wrist", JointKind.CONTINUOUS, "arm", "hand", joint, (0.0, 0.0, 1.0)),))
    motor = replace(actuator_of_row(catalogue()["X6-60"]), mounting=Mounting(share, (1.0, 0.0, 0.0)))
    parts = parts_of(with_actuators(tree, {"wrist": motor}), {})
    return parts, seated_links(parts)["arm"]


def radius_of(parts: Parts) -> float:
    return float(parts.motors[0].actuator.size[0]) / 2.0


def test_a_motor_that_floats_in_a_ball_gets_a_flange_out_to_the_wall() -> None:
    parts, link = held(Sphere(0.07), Placement())
    ((body,), (seat,)) = link.bodies, link.seats
    assert (seat.held, seat.thickness) == (1.0, WALL)
    shell = 4.0 / 3.0 * math.pi * (0.07**3 - 0.068**3)
    ring = math.pi * ((0.068**2 - radius_of(parts) ** 2) * WALL - WALL**3 / 12.0)
    assert kernel.volume(body) == pytest.approx(shell + ring, rel=1e-9)
    assert len(kernel.pieces(body)) == 1


def test_the_wall_that_a_housing_passes_through_is_its_flange() -> None:
    """Only a bore through one end: what is left of the end holds the motor."""
    parts, link = held(Box(0.12, 0.12, 0.3), Placement(translation=(0.0, 0.0, 0.149)))
    ((body,), (seat,)) = link.bodies, link.seats
    assert seat.held == 1.0
    assert seat.along == pytest.approx(0.0, abs=1e-9)
    shell = 0.12 * 0.12 * 0.3 - 0.116 * 0.116 * 0.296
    assert kernel.volume(body) == pytest.approx(shell - math.pi * radius_of(parts) ** 2 * WALL, rel=1e-9)


def test_a_full_link_has_a_bore_and_a_motor_beside_its_link_has_no_seat() -> None:
    parts, link = held(Box(0.12, 0.12, 0.3), Placement(), wall=None)
    motor = parts.motors[0].solid.shape
    assert kernel.volume(link.bodies[0]) == pytest.approx(0.12 * 0.12 * 0.3 - motor.volume, rel=1e-9)
    assert link.seats[0].thickness == 0.0
    _, apart = held(Box(0.12, 0.12, 0.3), Placement(translation=(0.0, 0.0, 0.151)), share=0.5)
    assert apart.seats == ()


def test_links_of_a_design_stay_in_one_piece_and_leave_housings_their_place(repository: Path) -> None:
    parts = parts_of(*designed(repository, "icub_geometry", 7, (2.0, 12.0)))
    seated = seated_links(parts)
    seats = [seat for link in seated.values() for seat in link.seats]
    assert len(seats) >= 20
    assert all(len(kernel.pieces(body)) == 1 for link in seated.values() for body in link.bodies)
    own = {(seat.motor.name, seat.motor.joint.parent) for seat in seats}
    assert [clash for clash in motor_clashes(parts, seated) if (clash.part, clash.link) in own] == []
