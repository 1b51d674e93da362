"""Links as beams: two arms of two tubes against finite elements, and stresses by hand."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from evodesign.body.inertia import Inertia
from evodesign.body.placement import Placement
from evodesign.body.shape import Box, Cylinder, Solid, Sphere
from evodesign.hardware.actuators import actuator_law
from evodesign.hardware.structure import STRENGTHS, Failure, RectangularTube, RoundTube
from evodesign.mechanics.balance import GRAVITY
from evodesign.mechanics.beams import beams_of
from evodesign.mechanics.link_beams import Safety, hand_deflection, link_safety, virtual_work
from evodesign.problem.build import build_problem
from evodesign.problem.source import read_source
from evodesign.tree.equip import with_actuators
from evodesign.tree.frames import link_frames
from evodesign.tree.model import Joint, JointKind, Link, Tree

UPPER, LOWER, WALL, DENSITY = 0.4, 0.3, 0.002, 2700.0
LYING = ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (-1.0, 0.0, 0.0))
"""Turns a cylinder's axis from z to x."""


def arms(lean: float = 0.0) -> Tree:
    """A block on two soles with two arms ahead: a tube, then a rectangular one, turned down by an angle."""
    links = [Link("root", own_inertia=Inertia(20.0))]
    joints = []
    for side, y in (("l", 0.2), ("r", -0.2)):
        upper = Solid(Cylinder(0.04, UPPER), Placement(LYING, (UPPER / 2, 0.0, 0.0)), DENSITY, WALL)
        lower = Solid(Box(LOWER, 0.05, 0.06), Placement(translation=(LOWER / 2, 0.0, 0.0)), DENSITY, WALL)
        links += [
            Link(f"{side}_upper", solids=(upper,)),
            Link(f"{side}_lower", solids=(lower,)),
            Link(f"{side}_hand"),
            Link(f"{side}_sole"),
        ]
        turns = {"kind": JointKind.REVOLUTE, "axis": (0.0, 1.0, 0.0), "lower": -2.0, "upper": 2.0}
        joints += [
            Joint(
                f"{side}_shoulder",
                parent="root",
                child=f"{side}_upper",
                parent_from_child=Placement(translation=(0.0, y, 0.0)),
                **turns,
            ),
            Joint(
                f"{side}_elbow",
                parent=f"{side}_upper",
                child=f"{side}_lower",
                parent_from_child=Placement(translation=(UPPER, 0.0, 0.0)),
                **turns,
            ),
            Joint(
                f"{side}_wrist",
                JointKind.FIXED,
                f"{side}_lower",
                f"{side}_hand",
                Placement(translation=(LOWER, 0.0, 0.0)),
            ),
            Joint(
                f"{side}_foot",
                JointKind.FIXED,
                "root",
                f"{side}_sole",
                Placement(translation=(0.0, y / 2, -0.5)),
            ),
        ]
    return Tree("arms", tuple(links), tuple(joints))


HANDS = ("l_hand", "r_hand")
SOLES = ("l_sole", "r_sole")
YOUNG = STRENGTHS["aluminium_6061"].young
TUBE, BOX = RoundTube(0.04, WALL), RectangularTube(0.05, 0.06, WALL)


def bent(elbow: float, force: np.ndarray) -> np.ndarray:
    """Displacement of a tip of two clamped beams by finite elements, in the plane x, z [m]."""
    first = np.array([1.0, 0.0])
    second = np.array([math.cos(elbow), -math.sin(elbow)])
    nodes = [np.zeros(2), UPPER * first, UPPER * first + LOWER * second]
    stiffness = np.zeros((9, 9))
    flexural = (YOUNG * TUBE.second_moments[0], YOUNG * BOX.second_moments[0])
    for place, ei in enumerate(flexural):
        along = nodes[place + 1] - nodes[place]
        length = float(np.linalg.norm(along))
        c, s = along / length
        turn = np.kron(np.eye(2), np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]))
        b, axial = ei / length**3, 1e12 / length
        local = np.array(
            [
                [axial, 0, 0, -axial, 0, 0],
                [0, 12 * b, 6 * b * length, 0, -12 * b, 6 * b * length],
                [0, 6 * b * length, 4 * b * length**2, 0, -6 * b * length, 2 * b * length**2],
                [-axial, 0, 0, axial, 0, 0],
                [0, -12 * b, -6 * b * length, 0, 12 * b, -6 * b * length],
                [0, 6 * b * length, 2 * b * length**2, 0, -6 * b * length, 4 * b * length**2],
            ]
        )
        rows = slice(3 * place, 3 * place + 6)
        stiffness[rows, rows] += turn.T @ local @ turn
    load = np.zeros(6)
    load[3:5] = force
    return np.linalg.solve(stiffness[3:, 3:], load)[3:5]


@pytest.mark.parametrize("elbow", [0.0, 0.7, 1.5])
def test_hands_give_way_as_finite_elements_say(elbow: float) -> None:
    force = np.array([5.0, -40.0])
    hands = {hand: np.array([force[0], 0.0, force[1], 0.0, 0.0, 0.0]) for hand in HANDS}
    joints = {"l_elbow": elbow, "r_elbow": elbow}
    found = hand_deflection(arms(), Placement(), joints, hands, SOLES)
    assert found.total == pytest.approx(-bent(elbow, force)[1], rel=1e-6)


def test_gears_add_what_they_wind_up_by() -> None:
    tree, force = arms(), 40.0
    hands = {hand: np.array([0.0, 0.0, -force, 0.0, 0.0, 0.0]) for hand in HANDS}
    stiff = hand_deflection(tree, Placement(), {}, hands, SOLES)
    actuator = actuator_law().at(20.0)
    driven = with_actuators(tree, dict.fromkeys(("l_shoulder", "r_shoulder"), actuator))
    found = hand_deflection(driven, Placement(), {}, hands, SOLES)
    assert found.links == stiff.links
    assert sum(found.windup.values()) == pytest.approx(
        force * (UPPER + LOWER) ** 2 / actuator.stiffness, rel=1e-9
    )


def test_the_least_safety_factor_is_that_of_the_shoulder_by_hand() -> None:
    tree, force = arms(), 40.0
    wrenches = [(hand, np.array([0.0, 0.0, -force]), np.zeros(3)) for hand in HANDS]
    lower = float(tree.link_by_name["l_lower"].mass) * GRAVITY
    moment = force * (UPPER + LOWER) + lower * (UPPER + LOWER / 2)
    strength = STRENGTHS["aluminium_6061"].strength
    bending = moment * 0.04 / TUBE.second_moments[0]
    least = min(link_safety(tree, Placement(), {}, wrenches).values())
    assert least == Safety(pytest.approx(strength / bending, rel=1e-9), Failure.YIELD)


def test_beams_are_hollow_solids_along_their_links() -> None:
    tree = arms()
    beams = {beam.link: beam for beam in beams_of(tree, link_frames(tree, Placement(), {}))}
    assert set(beams) == {"l_upper", "r_upper", "l_lower", "r_lower"}
    assert beams["l_upper"].length == pytest.approx(UPPER)
    assert beams["l_upper"].axes[0] == pytest.approx([1.0, 0.0, 0.0])
    assert beams["l_lower"].section == BOX
    for solid in (
        Solid(Sphere(0.05), Placement(), DENSITY, WALL),
        Solid(Cylinder(0.04, UPPER), Placement(), DENSITY, WALL),  # across
        Solid(Cylinder(0.04, UPPER), Placement(LYING), DENSITY),  # full
        Solid(Cylinder(0.04, UPPER), Placement(LYING), 1234.5, WALL),  # of nobody knows what
    ):
        links = tuple(
            replace(link, solids=(solid,)) if link.name == "l_upper" else link for link in tree.links
        )
        other = tree.reshaped(links, tree.joints)
        found = beams_of(other, link_frames(other, Placement(), {}))
        assert "l_upper" not in {beam.link for beam in found}


def test_a_robot_that_is_turned_gives_way_alike(repository: Path) -> None:
    """Of an iCub, whose hips sit at the middle of its pelvis: rounding may not say on which side."""
    problem = build_problem(read_source(repository / "problems" / "icub_hardware.toml"))
    space, robot, generator = problem.space, problem.scene.robot, np.random.default_rng(5)
    tree = space.resized(robot.tree, space.given(space.unscaled(robot.tree), {}))
    joints = dict(zip(robot.joints, generator.normal(size=len(robot.joints)).tolist(), strict=True))
    wrenches = {hand.frame: generator.normal(size=6) for hand in robot.hands}
    found = []
    for angles in generator.normal(size=(8, 3)).tolist():
        base = Placement.from_xyz_rpy((0.1, 0.2, 1.0), tuple(angles))
        turn = np.array(base.rotation)
        turned = {f: np.concatenate([turn @ w[:3], turn @ w[3:]]) for f, w in wrenches.items()}
        # hands give way along the robot's own z, which is down for those who stand
        places = link_frames(tree, base, joints)
        load = [(frame, wrench[:3], wrench[3:]) for frame, wrench in turned.items()]
        unit = [(frame, turn @ np.array([0.0, 0.0, -0.5]), np.zeros(3)) for frame in turned]
        found.append(virtual_work(tree, places, load, unit, robot.foot_frames).total)
    assert found == pytest.approx([found[0]] * len(found), rel=1e-9)
