"""Walls and actuators in a tree: mass, centre and inertia by hand, derivatives, and what is refused."""

from __future__ import annotations

import math
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

from evodesign.body.placement import Placement
from evodesign.body.shape import Box, Solid
from evodesign.errors import ModelError
from evodesign.hardware.actuators import actuator_law
from evodesign.tree.equip import (
    WallOfLink,
    actuators_of,
    rated_torques,
    with_actuators,
    with_walls,
)
from evodesign.tree.model import Joint, JointKind, Link, Tree

ARM = Tree(
    "arm",
    (
        Link("upper", solids=(Solid(Box(0.1, 0.08, 0.4), Placement(translation=(0.0, 0.0, -0.2)), 600.0),)),
        Link("lower", solids=(Solid(Box(0.06, 0.06, 0.3), Placement(), 500.0),)),
    ),
    (
        Joint(
            "elbow",
            JointKind.REVOLUTE,
            "upper",
            "lower",
            Placement(translation=(0.0, 0.01, -0.4)),
            axis=(0.0, 1.0, 0.0),
            lower=-1.0,
            upper=1.0,
        ),
    ),
)


def test_an_actuator_moves_mass_and_centre_of_the_link_before_its_joint() -> None:
    actuator = actuator_law().at(20.0)
    driven = with_actuators(ARM, {"elbow": actuator})
    upper, lower = driven.links
    own, ball = 0.1 * 0.08 * 0.4 * 600.0, float(actuator.mass)
    assert upper.mass == pytest.approx(own + ball, rel=1e-12)
    assert upper.inertia.mass == pytest.approx(own + ball, rel=1e-12)
    centre = (own * np.array([0, 0, -0.2]) + ball * np.array([0, 0.01, -0.4])) / (own + ball)
    assert np.array(upper.inertia.center) == pytest.approx(centre, abs=1e-12)
    radius = (3 * ball / (4 * math.pi * 3000.0)) ** (1 / 3)
    between = own * ball / (own + ball) * (0.01**2 + 0.2**2)  # two bodies about their common centre
    about_x = own * (0.08**2 + 0.4**2) / 12 + 0.4 * ball * radius**2 + between
    assert upper.inertia.about_center[0][0] == pytest.approx(about_x, rel=1e-12)
    assert lower is ARM.links[1]
    (joint,) = driven.joints
    assert (joint.effort, joint.velocity) == (actuator.peak, actuator.speed)
    assert actuators_of(driven) == {"elbow": actuator}
    assert rated_torques(driven) == {"elbow": 20.0}
    assert rated_torques(with_actuators(ARM, {"elbow": replace(actuator, holds=False)})) == {}


def test_the_derivative_of_every_inertia_by_the_rated_torque_is_exact() -> None:
    symbol = ca.SX.sym("rated")

    def figures(rated: object) -> list[object]:
        inertia = with_actuators(ARM, {"elbow": actuator_law().at(rated)}).links[0].inertia
        return [inertia.mass, *inertia.center, *(entry for row in inertia.about_center for entry in row)]

    column = ca.vertcat(*figures(symbol))
    slope = np.array(ca.Function("f", [symbol], [ca.jacobian(column, symbol)])(30.0)).ravel()
    step = 1e-4
    samples = [np.array(figures(30.0 + count * step), float) for count in (-2, -1, 1, 2)]
    difference = (8 * (samples[2] - samples[1]) - (samples[3] - samples[0])) / (12 * step)
    assert slope == pytest.approx(difference, rel=1e-7, abs=1e-10)


def test_a_wall_takes_the_place_of_the_density_and_leaves_a_share_of_the_mass() -> None:
    hollow = with_walls(ARM, {"upper": WallOfLink(0.002, 2700.0, 0.3)})
    full = 0.1 * 0.08 * 0.4
    shell = full - 0.096 * 0.076 * 0.396
    assert hollow.links[0].mass == pytest.approx(2700.0 * shell + 0.3 * 600.0 * full, rel=1e-12)
    assert hollow.links[1] is ARM.links[1]
    later = with_walls(ARM, {"upper": WallOfLink(0.002, None, 0.0)})
    assert later.links[0].mass == pytest.approx(600.0 * shell, rel=1e-12)


def test_hardware_that_the_tree_cannot_carry_is_refused() -> None:
    frame = replace(ARM, links=(*ARM.links, Link("tool")), joints=(*ARM.joints, welded("tool")))
    with pytest.raises(ModelError, match="wall of link tool: wanted a link made of"):
        with_walls(frame, {"tool": WallOfLink(0.001, 2700.0, 0.3)})
    with pytest.raises(ModelError, match="joint tool_joint: wanted a joint that turns, found a fixed one"):
        with_actuators(frame, {"tool_joint": actuator_law().at(1.0)})
    with pytest.raises(ModelError, match="no such joint"):
        with_actuators(frame, {"knee": actuator_law().at(1.0)})


def welded(name: str) -> Joint:
    return Joint(f"{name}_joint", JointKind.FIXED, "lower", name, Placement())


def test_a_tree_without_hardware_is_the_same_object() -> None:
    assert with_walls(ARM, {}) is ARM
    assert with_actuators(ARM, {}) is ARM
