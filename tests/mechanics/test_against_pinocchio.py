"""Kinematics and statics of resized robots and generated persons against pinocchio.

The oracle reads the URDF that our writer writes for the tree in question, so placements, inertia, writer and
statics are all under test at once.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest

from evodesign.human.anthropometry import Person
from evodesign.human.anthropometry_tables import Sex
from evodesign.human.body import human_tree
from evodesign.mechanics.agent import SIDES, Agent
from evodesign.mechanics.balance import GRAVITY, AppliedWrench, center_of_mass, cut
from evodesign.problem.build import DesignProblem
from evodesign.tree.kinematics import Pose, euler_rotation, forward
from evodesign.tree.model import Tree
from evodesign.tree.urdf_write import urdf_text
from tests.oracles.published import published_robots
from tests.tree.crane import crane

pytestmark = pytest.mark.slow

CASES = 120
RELATIVE = 1e-10


@dataclass(frozen=True)
class Case:
    """A tree of numbers in a random posture under random contact wrenches."""

    tree: Tree
    agent: Agent
    position: np.ndarray
    angles: np.ndarray
    joints: dict[str, float]
    wrenches: dict[str, np.ndarray]


def posture(tree: Tree, agent: Agent, rng: np.random.Generator) -> Case:
    joints = {
        name: rng.uniform(max(tree.joint_by_name[name].lower, -3), min(tree.joint_by_name[name].upper, 3))
        for name in tree.actuated
    }
    frames = [agent.frame(f"{side}_hand") for side in SIDES] + [agent.frame(f"{side}_foot") for side in SIDES]
    wrenches = {frame: rng.normal(size=6) * 100.0 for frame in frames}
    return Case(tree, agent, rng.normal(size=3), rng.uniform(-1.2, 1.2, 3), joints, wrenches)


def robots(problem: DesignProblem) -> Iterator[Case]:
    rng = np.random.default_rng(1)
    for _ in range(CASES):
        values = problem.space.values(tuple(rng.uniform(size=len(problem.space.parameters))))
        yield posture(problem.space.resized(problem.scene.robot.tree, values), problem.scene.robot, rng)


def persons(problem: DesignProblem) -> Iterator[Case]:
    rng = np.random.default_rng(2)
    for number in range(CASES):
        sex = list(Sex)[number % 2]
        tree = human_tree(Person(rng.uniform(1.45, 2.05), rng.uniform(40.0, 140.0), sex))
        yield posture(tree, problem.scene.human, rng)


def published(problem: DesignProblem) -> Iterator[Case]:
    rng = np.random.default_rng(3)
    for tree in published_robots(problem, rng, CASES // 4):
        yield posture(tree, problem.scene.robot, rng)


def cranes(problem: DesignProblem) -> Iterator[Case]:
    rng = np.random.default_rng(4)
    for _ in range(CASES // 4):
        tree = crane()
        robot, end = problem.scene.robot, tree.links[-1].name
        contacts = tuple(replace(contact, frame=end) for contact in robot.contacts)
        yield posture(tree, replace(robot, tree=tree, contacts=contacts), rng)


def ours(case: Case) -> tuple[dict[str, Pose], np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Poses, joint torques, unbalanced force and moment, centre of mass."""
    base = Pose(euler_rotation(ca.DM(case.angles)), ca.DM(case.position))
    poses = forward(case.tree, base, {name: ca.DM(value) for name, value in case.joints.items()})
    applied = [
        AppliedWrench(frame, poses[frame].position, ca.DM(wrench[:3]), ca.DM(wrench[3:]))
        for frame, wrench in case.wrenches.items()
    ]
    balance = cut(case.tree, poses, applied)
    torques = np.array([float(balance.torques[name]) for name in case.tree.actuated])
    _, center = center_of_mass(case.tree, poses)
    return poses, torques, *(np.array(x).ravel() for x in (balance.force, balance.moment, center))


def oracle(case: Case) -> tuple[pin.Model, pin.Data, np.ndarray]:
    """The pinocchio model after kinematics, and g - J^T f by generalised coordinate."""
    model = pin.buildModelFromXML(urdf_text(case.tree), pin.JointModelFreeFlyer())
    model.gravity.linear = np.array([0.0, 0.0, -GRAVITY])
    data = model.createData()
    q = pin.neutral(model)
    q[:3] = case.position
    q[3:7] = pin.Quaternion(pin.rpy.rpyToMatrix(*case.angles)).coeffs()
    for name, value in case.joints.items():
        joint = model.joints[model.getJointId(name)]
        if joint.nq == 2:
            q[joint.idx_q : joint.idx_q + 2] = np.cos(value), np.sin(value)
        else:
            q[joint.idx_q] = value
    rows = pin.computeGeneralizedGravity(model, data, q).copy()
    pin.computeJointJacobians(model, data, q)
    pin.updateFramePlacements(model, data)
    pin.centerOfMass(model, data, q)
    for frame, wrench in case.wrenches.items():
        jacobian = pin.getFrameJacobian(model, data, model.getFrameId(frame), pin.LOCAL_WORLD_ALIGNED)
        rows -= jacobian.T @ wrench
    return model, data, rows


@pytest.fixture(scope="module", params=[robots, persons, published, cranes])
def both(request: pytest.FixtureRequest, problem: DesignProblem) -> list[tuple[Case, Any, Any]]:
    """Each case with what we and the oracle find."""
    return [(case, ours(case), oracle(case)) for case in request.param(problem)]


def test_frames_stand_where_pinocchio_puts_them(both) -> None:
    for case, (poses, *_), (model, data, _) in both:
        for frame in case.tree.link_by_name:
            placed = data.oMf[model.getFrameId(frame)]
            assert np.allclose(np.array(poses[frame].position).ravel(), placed.translation, atol=RELATIVE)
            assert np.allclose(np.array(poses[frame].rotation), placed.rotation, atol=RELATIVE)


def test_torques_by_cutting_are_gravity_minus_transposed_jacobian_times_wrenches(both) -> None:
    for case, (_, torques, force, moment, _), (model, _, rows) in both:
        columns = [model.joints[model.getJointId(name)].idx_v for name in case.tree.actuated]
        scale = np.abs(rows).max()
        assert np.allclose(torques, rows[columns], atol=RELATIVE * scale)
        base_in_world = pin.rpy.rpyToMatrix(*case.angles)
        assert np.allclose(base_in_world.T @ force, -rows[:3], atol=RELATIVE * scale)
        assert np.allclose(base_in_world.T @ moment, -rows[3:6], atol=RELATIVE * scale)


def test_mass_and_centre_of_mass_agree(both) -> None:
    for case, (*_, center), (model, data, _) in both:
        mass = sum(link.inertia.mass for link in case.tree.links)
        assert mass == pytest.approx(pin.computeTotalMass(model), rel=RELATIVE)
        assert np.allclose(center, data.com[0], atol=RELATIVE)
