"""The mirror image of any posture under mirrored wrenches has mirrored torques."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

from evodesign.mechanics.agent import SIDES, Agent
from evodesign.mechanics.balance import AppliedWrench, cut
from evodesign.problem.build import DesignProblem
from evodesign.tree.kinematics import Pose, euler_rotation, forward
from evodesign.tree.symmetry import mirror_of

POLAR = np.array([1.0, -1.0, 1.0])
OTHER = {"left": "right", "right": "left"}


def torques(
    agent: Agent, base: np.ndarray, joints: dict[str, float], feet: dict[str, np.ndarray]
) -> dict[str, float]:
    pose = Pose(euler_rotation(ca.DM(base[3:])), ca.DM(base[:3]))
    poses = forward(agent.tree, pose, joints)
    applied = [
        AppliedWrench(
            agent.frame(f"{side}_foot"),
            poses[agent.frame(f"{side}_foot")].position,
            ca.DM(f[:3]),
            ca.DM(f[3:]),
        )
        for side, f in feet.items()
    ]
    return {name: float(value) for name, value in cut(agent.tree, poses, applied).torques.items()}


@pytest.mark.parametrize("who", ["robot", "human"])
def test_mirrored_posture_has_mirrored_torques(who: str, problem: DesignProblem) -> None:
    agent: Agent = getattr(problem.scene, who)
    mirror, rng = mirror_of(agent.tree), np.random.default_rng(8)
    for _ in range(20):
        base = np.concatenate([rng.normal(size=3), rng.uniform(-1.0, 1.0, 3)])
        joints = {name: rng.uniform(-1.0, 1.0) for name in agent.tree.actuated}
        feet = {side: rng.normal(size=6) * 100.0 for side in SIDES}
        image = torques(
            agent,
            base * np.concatenate([POLAR, -POLAR]),
            {mirror.joints[name]: mirror.signs[name] * value for name, value in joints.items()},
            {OTHER[side]: wrench * np.concatenate([POLAR, -POLAR]) for side, wrench in feet.items()},
        )
        for name, torque in torques(agent, base, joints, feet).items():
            assert image[mirror.joints[name]] == pytest.approx(mirror.signs[name] * torque, abs=1e-8)
