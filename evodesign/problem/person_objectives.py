"""Quantities of what a task asks of the person, beyond the torques of the posture.

human_load_torque   |torques less those of the same person in the same posture with empty hands| [N m]
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from evodesign.mechanics.load_torques import LoadTorques, load_torques
from evodesign.mechanics.scene import HUMAN, SIDES, Agent, Scene
from evodesign.posture.results import AgentPosture
from evodesign.problem.design_result import PostureSlopes

__all__ = ["added_by_load", "human_load_torque", "load_torque_by_posture"]


def added_by_load(person: Agent, posture: AgentPosture) -> LoadTorques:
    """What the load adds to a person's torques (`mechanics.load_torques`)."""
    joints = np.array([posture.joints[name] for name in person.joints])
    hands = np.concatenate([posture.hand_wrenches[side] for side in SIDES])
    return load_torques(person, posture.base_angles, joints, hands)


def human_load_torque(scene: Scene, postures: Mapping[str, AgentPosture]) -> float:
    """The norm of the torques that the load asks of the person beyond those with empty hands [N m]."""
    return added_by_load(scene.human, postures[HUMAN]).norm


def load_torque_by_posture(scene: Scene, postures: Mapping[str, AgentPosture]) -> dict[str, PostureSlopes]:
    """Its derivatives by the person's posture and hands' wrenches."""
    slopes = added_by_load(scene.human, postures[HUMAN]).slopes()
    joints = dict(zip(scene.human.joints, slopes.joints.tolist(), strict=True))
    hands = dict(zip(SIDES, np.split(slopes.hands, 2), strict=True))
    return {HUMAN: PostureSlopes(slopes.angles, joints, hands)}
