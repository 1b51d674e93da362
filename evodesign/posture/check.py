"""The independent check of a posture: other code, other library, plain numbers.

Nothing of the solver's graph is used. The agents' trees go through the URDF writer into pinocchio, which
gives kinematics, gravity torques and Jacobians; from them every constraint's residual is computed anew:

    tau = g(q) - J(q)^T f   (joint rows: torque error; base rows: unbalanced force and moment)

Source: Sartore et al. 2022, Eq. 5 at rest; pinocchio `computeGeneralizedGravity`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin

from evodesign.posture.solution import AgentPosture, Array
from evodesign.statics.balance import GRAVITY
from evodesign.statics.contact import foot_margins
from evodesign.statics.scene import SIDES, Agent, Grasp, Scene
from evodesign.tree.model import Tree
from evodesign.tree.urdf_write import urdf_text

__all__ = ["TOLERANCE", "AgentModel", "Checker"]

TOLERANCE = 1e-5
"""Largest residual of a posture that counts as solved, in SI units."""


@dataclass(frozen=True, slots=True)
class AgentModel:
    """An agent as pinocchio sees it."""

    agent: Agent
    model: Any
    data: Any

    @classmethod
    def of(cls, agent: Agent, tree: Tree) -> AgentModel:
        """Build the pinocchio model of a tree of numbers, through its URDF."""
        model = pin.buildModelFromXML(urdf_text(tree), pin.JointModelFreeFlyer())
        model.gravity.linear = np.array([0.0, 0.0, -GRAVITY])
        return cls(agent, model, model.createData())

    def configuration(self, posture: AgentPosture) -> Array:
        """Pinocchio's configuration vector of a posture, in the agent's frame."""
        q = pin.neutral(self.model)
        q[:3] = posture.base_position
        q[3:7] = pin.Quaternion(pin.rpy.rpyToMatrix(*posture.base_angles)).coeffs()
        for name, position in posture.joints.items():
            joint = self.model.joints[self.model.getJointId(name)]
            if joint.nq == 2:  # pinocchio's continuous joints hold cosine and sine
                q[joint.idx_q : joint.idx_q + 2] = np.cos(position), np.sin(position)
            else:
                q[joint.idx_q] = position
        return np.asarray(q)

    def frame(self, name: str) -> Any:
        """Pose of a frame (pinocchio SE3) after `update`."""
        return self.data.oMf[self.model.getFrameId(name)]

    def update(self, posture: AgentPosture) -> None:
        """Compute kinematics, Jacobians and gravity torques of a posture."""
        q = self.configuration(posture)
        pin.computeJointJacobians(self.model, self.data, q)
        pin.updateFramePlacements(self.model, self.data)
        pin.computeGeneralizedGravity(self.model, self.data, q)

    def unbalanced(self, posture: AgentPosture) -> Array:
        """What forces leave unbalanced, g - J^T f, after `update`: six base rows, then the joints."""
        rows = np.array(self.data.g)
        for side in SIDES:
            hand, sole = self.agent.hands[side], self.agent.soles[side]
            rows -= self._jacobian(hand, pin.LOCAL_WORLD_ALIGNED).T @ posture.hand_wrenches[side]
            rows -= self._jacobian(sole, pin.LOCAL).T @ posture.foot_wrenches[side]
        return rows

    def _jacobian(self, frame: str, reference: Any) -> Array:
        identity = self.model.getFrameId(frame)
        return np.asarray(pin.getFrameJacobian(self.model, self.data, identity, reference))


class Checker:
    """Residuals of postures of one design in a scene."""

    def __init__(self, scene: Scene, robot_tree: Tree, human: AgentModel) -> None:
        self._scene = scene
        self._models = (AgentModel.of(scene.robot, robot_tree), human)

    def residuals(self, postures: Mapping[str, AgentPosture], height: float) -> dict[str, float]:
        """Largest violation of each kind, SI units; zero or rounding for a posture that holds.

        Args:
            postures: by agent name.
            height: of the load's centre [m].
        """
        found: dict[str, float] = {}
        for model in self._models:
            posture = postures[model.agent.name]
            model.update(posture)
            own = {
                **_statics(model, posture),
                **_contacts(model, posture, self._scene, height),
                **_limits(model, posture, self._scene),
            }
            found.update({f"{model.agent.name}.{name}": value for name, value in own.items()})
        found.update(_load(self._scene, postures))
        return found


def _statics(model: AgentModel, posture: AgentPosture) -> dict[str, float]:
    rows = model.unbalanced(posture)
    columns = [model.model.joints[model.model.getJointId(name)].idx_v for name in posture.torques]
    torque_error = np.abs(rows[columns] - np.array(list(posture.torques.values())))
    base = np.abs(rows[:6])
    return {
        "torque": float(torque_error.max()),
        "force_balance": float(base[:3].max()),
        "moment_balance": float(base[3:].max()),
    }


def _contacts(model: AgentModel, posture: AgentPosture, scene: Scene, height: float) -> dict[str, float]:
    agent = model.agent
    hands, heights, slants, margins = [], [], [], []
    for side in SIDES:
        grasp = np.array(scene.payload.grasp_point(agent, side)) + np.array([0.0, 0.0, height])
        hands.append(float(np.abs(model.frame(agent.hands[side]).translation - grasp).max()))
        sole = model.frame(agent.soles[side])
        heights.append(abs(float(sole.translation[2])))
        slants.append(float(np.abs(sole.rotation @ [0.0, 0.0, 1.0] - [0.0, 0.0, 1.0]).max()))
        margins += foot_margins(posture.foot_wrenches[side], agent.sole_size, scene.ground)
    return {
        "hands_on_load": max(hands),
        "feet_on_ground": max(heights),
        "feet_flat": max(slants),
        "foot_contact": max(0.0, -float(min(margins))),
    }


def _limits(model: AgentModel, posture: AgentPosture, scene: Scene) -> dict[str, float]:
    agent, stance = model.agent, scene.stance
    joints = [(agent.tree.joint_by_name[name], position) for name, position in posture.joints.items()]
    beyond = [max(joint.lower - position, position - joint.upper) for joint, position in joints]
    left, right = (model.frame(agent.soles[side]) for side in SIDES)
    apart = float(left.translation[1] - right.translation[1])
    least, most = stance.feet_apart
    yaws = [abs(float(np.arctan2(sole.rotation[1, 0], sole.rotation[0, 0]))) for sole in (left, right)]
    near = -scene.payload.size[0] / 2.0 - stance.trunk_clearance
    trunk = [float(model.frame(name).translation[0]) - near for name in agent.trunk]
    stagger = abs(float(left.translation[0] - right.translation[0])) - stance.feet_stagger
    return {
        "joint_limits": max(0.0, *beyond),
        "feet_apart": max(0.0, least - apart, apart - most),
        "feet_stagger": max(0.0, stagger),
        "feet_yaw": max(0.0, max(yaws) - stance.foot_yaw),
        "trunk_clear": max(0.0, *trunk),
        "base_tilt": max(0.0, float(np.abs(posture.base_angles).max()) - stance.base_tilt),
    }


def _load(scene: Scene, postures: Mapping[str, AgentPosture]) -> dict[str, float]:
    weight = np.array([0.0, 0.0, -GRAVITY * scene.payload.mass])
    force, moment = weight, np.cross(scene.payload.center_of_mass, weight)
    push, passed = 0.0, 0.0
    for agent in (scene.robot, scene.human):
        world_from_agent = pin.rpy.rpyToMatrix(0.0, 0.0, agent.facing)
        for side in SIDES:
            wrench = postures[agent.name].hand_wrenches[side]
            on_load = -world_from_agent @ wrench[:3]
            point = world_from_agent @ np.array(scene.payload.grasp_point(agent, side))
            force = force + on_load
            moment = moment + np.cross(point, on_load) - world_from_agent @ wrench[3:]
            push += float(on_load[0]) if agent is scene.robot else 0.0
            passed = max(passed, float(np.abs(wrench[3:]).max()))
    return {
        "load.force_balance": float(np.abs(force).max()),
        "load.moment_balance": float(np.abs(moment).max()),
        "load.push": max(0.0, abs(push) - scene.stance.push),
        "load.grasp": passed if scene.payload.grasp is Grasp.POINT else 0.0,
    }
