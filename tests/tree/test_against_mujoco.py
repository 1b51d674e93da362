"""Kinematics, mass matrix and bias of our robot, the published one and a crane against MuJoCo.

MuJoCo reads the URDF that our writer writes. Its free joint counts the root's linear velocity in world axes
and the angular one in the root's: u = (R v, omega, rates), so that

    M = T^T M_u T      h = T^T (h_u + M_u dT/dt nu)      T = diag(R, 1)      dT/dt nu = (R (omega x v), 0)

A person cannot be loaded: MuJoCo refuses moving links without mass.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import casadi as ca
import mujoco
import numpy as np
import pytest

from evodesign.mechanics.balance import GRAVITY, center_of_mass, cut
from evodesign.mechanics.dynamics import ROOT_ROWS, bias, mass_matrix
from evodesign.problem.build import DesignProblem
from evodesign.tree.kinematics import Pose, euler_rotation, forward
from evodesign.tree.model import Tree
from evodesign.tree.urdf_write import urdf_text
from tests.oracles.published import published_robots
from tests.tree.crane import crane

RELATIVE = 1e-6
CASES = 10


@dataclass(frozen=True)
class Case:
    """A tree of numbers in random motion, ours and MuJoCo's."""

    tree: Tree
    position: np.ndarray
    rotation: np.ndarray
    joints: dict[str, float]
    velocity: np.ndarray
    model: mujoco.MjModel
    data: mujoco.MjData

    @classmethod
    def of(cls, tree: Tree, rng: np.random.Generator) -> Case:
        joints = dict(zip(tree.actuated, rng.uniform(-1.5, 1.5, len(tree.actuated)).tolist(), strict=True))
        rotation = np.array(euler_rotation(ca.DM(rng.uniform(-1.4, 1.4, 3))))
        position, velocity = rng.normal(size=3), rng.normal(size=ROOT_ROWS + len(joints))
        model = floating(tree)
        data = mujoco.MjData(model)
        data.qpos[:3] = position
        mujoco.mju_mat2Quat(data.qpos[3:7], rotation.ravel())
        data.qvel[:ROOT_ROWS] = [*(rotation @ velocity[:3]), *velocity[3:6]]
        for number, (name, place) in enumerate(joints.items()):
            data.qpos[model.joint(name).qposadr] = place
            data.qvel[model.joint(name).dofadr] = velocity[ROOT_ROWS + number]
        mujoco.mj_forward(model, data)
        return cls(tree, position, rotation, joints, velocity, model, data)

    @property
    def order(self) -> list[int]:
        """MuJoCo's velocity index of each of our rows."""
        return [*range(ROOT_ROWS), *(int(self.model.joint(name).dofadr[0]) for name in self.joints)]

    def oracle(self) -> tuple[np.ndarray, np.ndarray]:
        """Mass matrix and bias from MuJoCo, in our velocities."""
        columns = np.eye(self.model.nv)
        for column in columns:  # the layout of MuJoCo's own matrix differs between its versions
            mujoco.mj_mulM(self.model, self.data, column, column.copy())
        mass = columns[np.ix_(self.order, self.order)]
        to_theirs = np.eye(len(self.order))
        to_theirs[:3, :3] = self.rotation
        turning = np.zeros(len(self.order))
        turning[:3] = self.rotation @ np.cross(self.velocity[3:6], self.velocity[:3])
        forces = to_theirs.T @ (self.data.qfrc_bias[self.order] + mass @ turning)
        return to_theirs.T @ mass @ to_theirs, forces


def floating(tree: Tree) -> mujoco.MjModel:
    spec = mujoco.MjSpec.from_string(urdf_text(tree))
    spec.compiler.fusestatic = False
    spec.body(tree.root).add_freejoint()
    spec.option.gravity = [0.0, 0.0, -GRAVITY]
    return spec.compile()


def robots(problem: DesignProblem) -> Iterator[Case]:
    rng = np.random.default_rng(21)
    for _ in range(CASES):
        values = problem.space.values(tuple(rng.uniform(size=len(problem.space.parameters))))
        yield Case.of(problem.space.resized(problem.scene.robot.tree, values), rng)


def cranes(_: DesignProblem) -> Iterator[Case]:
    rng = np.random.default_rng(22)
    for _ in range(CASES):
        yield Case.of(crane(), rng)


def published(problem: DesignProblem) -> Iterator[Case]:
    rng = np.random.default_rng(23)
    for tree in published_robots(problem, rng, CASES):
        yield Case.of(tree, rng)


ALL = pytest.mark.parametrize("cases", [robots, cranes, published])


@ALL
def test_links_stand_where_mujoco_puts_them(cases, problem: DesignProblem) -> None:
    for case in cases(problem):
        poses = forward(case.tree, Pose(ca.DM(case.rotation), ca.DM(case.position)), case.joints)
        for name, pose in poses.items():
            body = case.data.body(name)
            assert np.allclose(np.array(pose.position).ravel(), body.xpos, rtol=0.0, atol=RELATIVE)
            assert np.allclose(np.array(pose.rotation), body.xmat.reshape(3, 3), rtol=0.0, atol=RELATIVE)


@ALL
def test_centre_of_mass_and_gravity_torques_are_mujocos(cases, problem: DesignProblem) -> None:
    for case in cases(problem):
        poses = forward(case.tree, Pose(ca.DM(case.rotation), ca.DM(case.position)), case.joints)
        mass, center = center_of_mass(case.tree, poses)
        assert float(mass) == pytest.approx(float(case.model.body_mass.sum()), rel=RELATIVE)
        root = case.data.body(case.tree.root)
        assert np.allclose(np.array(center).ravel(), root.subtree_com, rtol=0.0, atol=RELATIVE)
        case.data.qvel[:] = 0.0
        mujoco.mj_forward(case.model, case.data)
        gravity = case.data.qfrc_bias[case.order][ROOT_ROWS:]
        held = cut(case.tree, poses, []).torques
        found = [float(held[name]) for name in case.joints]
        assert np.allclose(found, gravity, rtol=0.0, atol=RELATIVE * np.abs(gravity).max())


@ALL
def test_mass_matrix_and_bias_are_mujocos(cases, problem: DesignProblem) -> None:
    for case in cases(problem):
        names = tuple(case.joints)
        mass, forces = case.oracle()
        unit = np.sqrt(np.outer(np.diag(mass), np.diag(mass)))
        ours = np.array(mass_matrix(case.tree, names, case.joints))
        assert np.all(np.abs(ours - mass) <= RELATIVE * unit)
        gravity = ca.DM(case.rotation.T @ [0.0, 0.0, -GRAVITY])
        found = np.array(bias(case.tree, names, case.joints, ca.DM(case.velocity), gravity)).ravel()
        assert np.allclose(found, forces, rtol=0.0, atol=RELATIVE * np.abs(forces).max())
