"""What an agent's joints can do: ranges, speeds and torques, in the order of its joints.

A torque's limit is the actuator's peak, torque for seconds, for a push is over within one or two; without an
actuator it is that of the problem or the file, and without any it is infinite, as people's are.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from evodesign.control.gains import Feedback
from evodesign.mechanics.agent import Agent
from evodesign.tree.equip import actuators_of
from evodesign.tree.model import Tree

Array = NDArray[np.float64]


WATCHED_SECONDS = 3.0
"""For which a push is simulated at most [s]: who stands then has survived it."""


@dataclass(frozen=True, slots=True, eq=False)
class JointLimits:
    """Of an agent's j joints; infinite where there is none.

    Args:
        lower: ends of ranges [rad], shape (j,).
        upper: likewise.
        speed: [rad/s].
        torque: [N m].
    """

    lower: Array
    upper: Array
    speed: Array
    torque: Array

    @classmethod
    def of(cls, agent: Agent, tree: Tree) -> JointLimits:
        """Those of an agent with the tree of a design."""
        joints = [tree.joint_by_name[name] for name in agent.joints]
        return cls(
            lower=np.array([joint.lower for joint in joints], float),
            upper=np.array([joint.upper for joint in joints], float),
            speed=np.array([joint.velocity for joint in joints], float),
            torque=np.array([torque_limit(agent, tree, name) for name in agent.joints]),
        )

    def accelerations(self, positions: Array, speeds: Array, feedback: Feedback) -> tuple[Array, Array]:
        """Least and largest accelerations with which joints stay within ranges and speeds [rad/s^2]."""
        stiffness, rate = feedback.frequency**2, feedback.rate
        least = stiffness * (self.lower - positions) - rate * speeds
        most = stiffness * (self.upper - positions) - rate * speeds
        least = np.maximum(least, rate * (-self.speed - speeds))
        most = np.minimum(most, rate * (self.speed - speeds))
        return np.minimum(least, most), most


def torque_limit(agent: Agent, tree: Tree, joint: str) -> float:
    """The peak torque of a joint's actuator, else its limit in the problem or the file [N m]."""
    driven = actuators_of(tree)
    if joint in driven:
        return float(driven[joint].peak)
    return float(agent.torque_limits.get(joint, math.inf))
