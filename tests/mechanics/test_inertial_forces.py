"""Inertial forces among the external ones, against pinocchio's inverse dynamics on whole trees."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

from evodesign.mechanics.agent import Agent
from evodesign.mechanics.balance import cut
from evodesign.mechanics.inertial_forces import euler_motion, inertial_wrenches
from evodesign.posture.check import AgentModel, AgentMotion
from evodesign.posture.results import AgentPosture
from evodesign.problem.build import DesignProblem
from evodesign.tree.kinematics import Pose, euler_rotation, forward


@pytest.mark.parametrize("who", ["robot", "human"])
def test_a_moving_tree_takes_what_inverse_dynamics_says(problem: DesignProblem, who: str) -> None:
    agent: Agent = getattr(problem.scene, who)
    drawn = np.random.default_rng(3)
    count = len(agent.joints)
    position, angles, joints = drawn.normal(size=3), drawn.uniform(-0.5, 0.5, 3), drawn.uniform(-1, 1, count)
    rates, changes = drawn.normal(size=6 + count), drawn.normal(size=6 + count)
    by_name = [dict(zip(agent.joints, each, strict=True)) for each in (joints, rates[6:], changes[6:])]

    base = Pose(euler_rotation(ca.DM(angles)), ca.DM(position))
    poses = forward(agent.tree, base, by_name[0])
    root = euler_motion(ca.DM(angles), ca.DM(rates[3:6]), ca.DM(changes[3:6]), ca.DM(changes[:3]))
    inertial = list(inertial_wrenches(agent.tree, poses, root, by_name[1], by_name[2]))
    found = cut(agent.tree, poses, inertial)

    posture = AgentPosture(position, angles, by_name[0], by_name[0], {})
    state = AgentModel.of(agent, agent.tree).at(posture, AgentMotion(rates, changes))
    base_in_world = np.array(base.rotation)
    torques = [float(found.torques[name]) for name in agent.joints]
    assert torques == pytest.approx(state.bias[6:], abs=1e-9)
    assert base_in_world.T @ np.array(found.force).ravel() == pytest.approx(-state.bias[:3], abs=1e-8)
    assert base_in_world.T @ np.array(found.moment).ravel() == pytest.approx(-state.bias[3:6], abs=1e-8)
