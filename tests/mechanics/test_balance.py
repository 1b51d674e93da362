"""Statics by cutting on mechanisms that can be solved by hand."""

from __future__ import annotations

import math

import casadi as ca
import pytest
from hypothesis import given
from hypothesis import strategies as st

from evodesign.body.inertia import Inertia
from evodesign.body.placement import Placement
from evodesign.mechanics.balance import GRAVITY, AppliedWrench, cut, standing_height_of_mass
from evodesign.tree.kinematics import Pose, axis_rotation, forward
from evodesign.tree.model import Joint, JointKind, Link, Tree

ORIGIN = Pose(ca.DM.eye(3), ca.DM.zeros(3))
angles = st.floats(-3.0, 3.0)


def pendulum(mass: float, length: float) -> Tree:
    """base -> rod turning about y, with a point mass at its end, on z below the joint."""
    rod = Link("rod", own_inertia=Inertia(mass, (0.0, 0.0, -length)))
    joint = Joint("hinge", JointKind.REVOLUTE, "base", "rod", Placement(), (0.0, 1.0, 0.0), -4.0, 4.0)
    return Tree("pendulum", (Link("base"), rod), (joint,))


@given(angles, st.floats(0.1, 50.0), st.floats(0.1, 2.0))
def test_pendulum_needs_m_g_l_sine(angle: float, mass: float, length: float) -> None:
    tree = pendulum(mass, length)
    balance = cut(tree, forward(tree, ORIGIN, {"hinge": ca.DM(angle)}), [])
    assert float(balance.torques["hinge"]) == pytest.approx(
        mass * GRAVITY * length * math.sin(angle), abs=1e-9
    )
    assert float(balance.force[2]) == pytest.approx(-mass * GRAVITY)


@given(angles)
def test_hand_under_the_mass_takes_the_torque_away(angle: float) -> None:
    tree = pendulum(2.0, 0.7)
    poses = forward(tree, ORIGIN, {"hinge": ca.DM(angle)})
    end = poses["rod"].point(ca.DM([0.0, 0.0, -0.7]))
    hand = AppliedWrench("rod", end, ca.DM([0.0, 0.0, 2.0 * GRAVITY]), ca.DM.zeros(3))
    balance = cut(tree, poses, [hand])
    assert float(balance.torques["hinge"]) == pytest.approx(0.0, abs=1e-9)
    assert float(ca.norm_2(balance.force)) == pytest.approx(0.0, abs=1e-9)


def test_lift_carries_the_weight_above_it() -> None:
    cabin = Link("cabin", own_inertia=Inertia(10.0))
    joint = Joint("lift", JointKind.PRISMATIC, "base", "cabin", Placement(), (0.0, 0.0, 1.0), 0.0, 1.0)
    tree = Tree("lift", (Link("base"), cabin), (joint,))
    poses = forward(tree, ORIGIN, {"lift": ca.DM(0.4)})
    assert float(poses["cabin"].position[2]) == pytest.approx(0.4)
    assert float(cut(tree, poses, []).torques["lift"]) == pytest.approx(10.0 * GRAVITY)


@given(angles, st.tuples(angles, angles, angles))
def test_rotation_keeps_its_axis_and_turns_by_its_angle(angle: float, axis: tuple[float, ...]) -> None:
    length = math.sqrt(sum(x * x for x in axis)) or 1.0
    unit = tuple(x / length for x in axis) if length > 1e-6 else (1.0, 0.0, 0.0)
    if abs(math.sqrt(sum(x * x for x in unit)) - 1.0) > 1e-9:
        unit = (1.0, 0.0, 0.0)
    rotation = axis_rotation(unit, ca.DM(angle))
    assert float(ca.norm_2(rotation @ ca.DM(unit) - ca.DM(unit))) == pytest.approx(0.0, abs=1e-9)
    assert float(ca.trace(rotation)) == pytest.approx(1.0 + 2.0 * math.cos(angle), abs=1e-9)
    assert float(ca.norm_inf(rotation @ rotation.T - ca.DM.eye(3))) == pytest.approx(0.0, abs=1e-9)


def test_standing_height_counts_from_the_lowest_sole() -> None:
    body = Link("body", own_inertia=Inertia(4.0, (0.0, 0.0, 0.1)))
    soles = [
        Joint(name, JointKind.FIXED, "body", name, Placement(translation=(0.0, y, -0.9)))
        for name, y in (("left", 0.1), ("right", -0.1))
    ]
    tree = Tree("stand", (body, Link("left"), Link("right")), tuple(soles))
    assert float(standing_height_of_mass(tree, ("left", "right"))) == pytest.approx(1.0)
