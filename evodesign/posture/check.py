"""The independent check of a posture: other code, other library, plain numbers.

Nothing of the solver's graph is used. The agents' trees go through the URDF writer into pinocchio, which
gives kinematics, gravity torques and Jacobians; from them every constraint's residual is computed anew:

    tau = g(q) - J(q)^T f   (joint rows: torque error; base rows: unbalanced force and moment)

Source: Sartore et al. 2022, Eq. 5 at rest; pinocchio `nonLinearEffects` at rest.
"""

from __future__ import annotations

from collections.abc import Mapping
from copy import copy
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np
import pinocchio as pin

from evodesign.mechanics.balance import GRAVITY
from evodesign.mechanics.contact import foot_margins
from evodesign.mechanics.disturbance import Disturbance, PushedAt
from evodesign.mechanics.floating_base import ROOT, BodyState, Configuration, FloatingBody
from evodesign.mechanics.scene import SIDES, Agent, Grasp, Scene
from evodesign.posture.results import AgentPosture, Array
from evodesign.tree.model import Tree

__all__ = ["TOLERANCE", "AgentModel", "Checker"]

TOLERANCE = 1e-5
"""Largest residual of a posture that counts as solved, in SI units."""

QUIET = Disturbance("none")
"""Nothing happens."""

STILL = np.zeros(3)
"""No force from outside [N]."""

NOTHING: Mapping[str, Mapping[str, AgentPosture]] = MappingProxyType({})
"""What is borne under disturbances where there are none."""


@dataclass(frozen=True, slots=True)
class AgentModel:
    """An agent as pinocchio sees it, in its own frame."""

    agent: Agent
    body: FloatingBody

    @classmethod
    def of(cls, agent: Agent, tree: Tree) -> AgentModel:
        """The agent with a tree of numbers (a design's)."""
        return cls(agent, FloatingBody.of_tree(tree, agent.joints, np.eye(3)))

    def at(self, posture: AgentPosture) -> BodyState:
        """Kinematics, Jacobians and gravity torques of a posture."""
        configuration = Configuration(posture.base_position, posture.base_angles, posture.joints)
        return self.body.at(configuration, np.zeros(self.body.size))


class Checker:
    """Residuals of postures of one design in a scene."""

    def __init__(self, scene: Scene, robot_tree: Tree, human: AgentModel) -> None:
        self._scene = scene
        self._models = (AgentModel.of(scene.robot, robot_tree), human)

    def elsewhere(self, scene: Scene, human: AgentModel) -> Checker:
        """The check of the same robot in another scene."""
        other = copy(self)
        other._scene, other._models = scene, (self._models[0], human)
        return other

    def residuals(
        self,
        postures: Mapping[str, AgentPosture],
        height: float,
        disturbed: Mapping[str, Mapping[str, AgentPosture]] = NOTHING,
    ) -> dict[str, float]:
        """Largest violation of each kind, SI units; zero or rounding for a posture that holds.

        Args:
            postures: by agent name.
            height: of the load's centre [m].
            disturbed: what is borne under each of the scene's disturbances, by its name and the agent's.
        """
        found = self._undisturbed(postures, height)
        for disturbance in self._scene.disturbances.cases:
            own = self._disturbed(disturbance, postures, disturbed[disturbance.name])
            found.update({f"{disturbance.name}: {name}": value for name, value in own.items()})
        return found

    def _undisturbed(self, postures: Mapping[str, AgentPosture], height: float) -> dict[str, float]:
        found: dict[str, float] = {}
        for model in self._models:
            posture = postures[model.agent.name]
            agent, instant = model.agent, model.at(posture)
            own = {
                **_statics(agent, instant, posture),
                **_contacts(agent, instant, posture, self._scene, height),
                **_limits(agent, instant, posture, self._scene),
            }
            found.update({f"{agent.name}.{name}": value for name, value in own.items()})
        found.update(_load(self._scene, postures))
        return found

    def _disturbed(
        self,
        disturbance: Disturbance,
        undisturbed: Mapping[str, AgentPosture],
        postures: Mapping[str, AgentPosture],
    ) -> dict[str, float]:
        """What may differ under a disturbance: statics, feet, load, and a posture that moved."""
        found: dict[str, float] = {}
        for model in self._models:
            agent, posture = model.agent, postures[model.agent.name]
            instant = model.at(posture)
            own = {
                **_statics(agent, instant, posture, disturbance),
                "foot_contact": _foot_contact(agent, posture, self._scene),
                "moved": _distance(undisturbed[agent.name], posture),
                **_torque_limits(agent, posture),
            }
            found.update({f"{agent.name}.{name}": value for name, value in own.items()})
        scene = replace(self._scene, payload=self._scene.payload.disturbed(disturbance))
        found.update(_load(scene, postures, np.array(disturbance.push_on(PushedAt.LOAD))))
        return found


def _distance(posture: AgentPosture, other: AgentPosture) -> float:
    """Largest difference of base [m, rad] and joints [rad] of two postures."""
    base = np.abs(posture.base_position - other.base_position).max()
    turned = np.abs(posture.base_angles - other.base_angles).max()
    return float(max(base, turned, *(abs(posture.joints[name] - x) for name, x in other.joints.items())))


def _statics(
    agent: Agent, instant: BodyState, posture: AgentPosture, disturbance: Disturbance = QUIET
) -> dict[str, float]:
    """Rows of h - J^T f: six of the base, then the joints."""
    rows = np.array(instant.bias)
    push = np.array(disturbance.push_on(PushedAt(agent.name)))
    if push.any():
        in_agent = pin.rpy.rpyToMatrix(0.0, 0.0, -agent.facing) @ push
        rows -= instant.twist_in_world(agent.pushed_frame)[0][:3].T @ in_agent
    for side in SIDES:
        rows -= instant.twist_in_world(agent.hands[side])[0].T @ posture.hand_wrenches[side]
        rows -= instant.twist_in_frame(agent.soles[side])[0].T @ posture.foot_wrenches[side]
    base, joints = np.abs(rows[:ROOT]), rows[ROOT:]
    return {
        "torque": float(np.abs(joints - [posture.torques[name] for name in agent.joints]).max()),
        "force_balance": float(base[:3].max()),
        "moment_balance": float(base[3:].max()),
    }


def _contacts(
    agent: Agent, instant: BodyState, posture: AgentPosture, scene: Scene, height: float
) -> dict[str, float]:
    hands, heights, slants = [], [], []
    for side in SIDES:
        grasp = np.array(scene.payload.grasp_point(agent, side)) + np.array([0.0, 0.0, height])
        hands.append(float(np.abs(instant.pose(agent.hands[side])[1] - grasp).max()))
        rotation, origin = instant.pose(agent.soles[side])
        heights.append(abs(float(origin[2])))
        slants.append(float(np.abs(rotation[:, 2] - [0.0, 0.0, 1.0]).max()))
    return {
        "hands_on_load": max(hands),
        "feet_on_ground": max(heights),
        "feet_flat": max(slants),
        "foot_contact": _foot_contact(agent, posture, scene),
    }


def _foot_contact(agent: Agent, posture: AgentPosture, scene: Scene) -> float:
    """By how much feet pass to the ground what it cannot bear [N, N m]."""
    wrenches = [posture.foot_wrenches[side] for side in SIDES]
    margins = [m for wrench in wrenches for m in foot_margins(wrench, agent.sole_size, scene.ground)]
    return max(0.0, -float(min(margins)))


def _limits(agent: Agent, instant: BodyState, posture: AgentPosture, scene: Scene) -> dict[str, float]:
    stance = scene.stance
    joints = [(agent.tree.joint_by_name[name], position) for name, position in posture.joints.items()]
    beyond = [max(joint.lower - position, position - joint.upper) for joint, position in joints]
    (left, at_left), (right, at_right) = (instant.pose(agent.soles[side]) for side in SIDES)
    apart, ahead = float(at_left[1] - at_right[1]), float(at_left[0] - at_right[0])
    least, most = stance.feet_apart
    yaws = [abs(float(np.arctan2(rotation[1, 0], rotation[0, 0]))) for rotation in (left, right)]
    near = -scene.payload.size[0] / 2.0 - stance.trunk_clearance
    trunk = [float(instant.pose(name)[1][0]) - near for name in agent.trunk]
    return {
        "joint_limits": max(0.0, *beyond),
        "feet_apart": max(0.0, least - apart, apart - most),
        "feet_stagger": max(0.0, abs(ahead) - stance.feet_stagger),
        "feet_yaw": max(0.0, max(yaws) - stance.foot_yaw),
        "trunk_clear": max(0.0, *trunk),
        "base_tilt": max(0.0, float(np.abs(posture.base_angles).max()) - stance.base_tilt),
        **_torque_limits(agent, posture),
    }


def _torque_limits(agent: Agent, posture: AgentPosture) -> dict[str, float]:
    """How far torques lie beyond their limits, where limits hold."""
    if not agent.limits_torques:
        return {}
    beyond = [abs(posture.torques[name]) - limit for name, limit in agent.torque_limits.items()]
    return {"torque_limits": max(0.0, *beyond)}


def _load(scene: Scene, postures: Mapping[str, AgentPosture], outside: Array = STILL) -> dict[str, float]:
    """Balance of the load, of which a force from outside [N] meets the box's centre, and bounds on hands."""
    weight = np.array([0.0, 0.0, -GRAVITY * scene.payload.mass])
    force, moment = weight + outside, pin.skew(np.array(scene.payload.center_of_mass)) @ weight
    squeeze, passed, carried = float(outside[0]) / 2.0, 0.0, 0.0
    for agent in (scene.robot, scene.human):
        world_from_agent = pin.rpy.rpyToMatrix(0.0, 0.0, agent.facing)
        for side in SIDES:
            wrench = postures[agent.name].hand_wrenches[side]
            on_load = -world_from_agent @ wrench[:3]
            point = world_from_agent @ np.array(scene.payload.grasp_point(agent, side))
            force = force + on_load
            moment = moment + pin.skew(point) @ on_load - world_from_agent @ wrench[3:]
            if agent is scene.robot:
                squeeze += float(on_load[0])
                carried += float(on_load[2])
            passed = max(passed, float(np.abs(wrench[3:]).max()))
    found = {
        "load.force_balance": float(np.abs(force).max()),
        "load.moment_balance": float(np.abs(moment).max()),
        "load.push": max(0.0, abs(squeeze) - scene.stance.push),
        "load.grasp": passed if scene.payload.grasp is Grasp.POINT else 0.0,
    }
    if scene.payload.hand_moment < np.inf:
        found["load.hand_moment"] = max(0.0, passed - scene.payload.hand_moment)
    whole = -float(weight[2] + outside[2])
    if scene.robot_share is not None:
        found["load.share"] = abs(carried - scene.robot_share * whole)
    elif scene.payload.grasp is Grasp.RIGID:
        found["load.share"] = max(0.0, -carried, carried - whole)
    return found
