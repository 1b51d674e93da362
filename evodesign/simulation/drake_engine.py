"""Drake as the engine of a controlled simulation: a second opinion, whose model owes nothing to MuJoCo's.

Steps are Drake's discrete ones: contacts, grasps and the ends of ranges together are one convex program of
the velocities at the end of a step. The damping of joints is Drake's own, which it takes there too.

Source: Castro, Permenter and Han 2022, An unconstrained convex formulation of compliant contact.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from pydrake.math import RigidTransform
from pydrake.multibody.math import SpatialForce
from pydrake.multibody.plant import ExternallyAppliedSpatialForce
from pydrake.multibody.tree import JacobianWrtVariable

from evodesign.body.placement import matrix_from_wxyz
from evodesign.control.gains import Feedback
from evodesign.control.limits import torque_limit
from evodesign.mechanics.agent import Agent
from evodesign.mechanics.floating_base import ROOT
from evodesign.mechanics.scene import Scene
from evodesign.posture.results import AgentPosture, Array
from evodesign.simulation.drake_model import drake_scene, transform_of
from evodesign.simulation.engine import EngineState, placed_links, tilt_of
from evodesign.tree.model import Tree

Moment = tuple[Array, Array]
"""Positions and velocities, and inputs of the motors."""


@dataclass(frozen=True, slots=True, eq=False)
class _Parts:
    """Where Drake keeps an agent's numbers; j joints in the agent's order.

    Args:
        root: the root link.
        links: by name.
        joints: those that move.
        places: of the joints among the positions, shape (j,).
        rates: of the joints among the velocities, shape (j,).
        free: of the root link among the velocities, shape (6,).
        limits: largest torque of each joint [N m], shape (j,).
    """

    root: Any
    links: Mapping[str, Any]
    joints: tuple[Any, ...]
    places: Array
    rates: Array
    free: Array
    limits: Array

    @classmethod
    def of(cls, plant: Any, agent: Agent, tree: Tree, links: Mapping[str, Any]) -> _Parts:
        """Those of an agent in a finished plant."""
        root, own = links[tree.root], plant.GetModelInstanceByName(agent.name)
        joints = tuple(plant.GetJointByName(joint, own) for joint in agent.joints)
        first = root.floating_velocities_start_in_v()
        return cls(
            root=root,
            links=links,
            joints=joints,
            places=np.array([joint.position_start() for joint in joints]),
            rates=np.array([joint.velocity_start() for joint in joints]),
            free=np.arange(first, first + ROOT),
            limits=np.array([torque_limit(agent, tree, joint) for joint in agent.joints]),
        )


class DrakeEngine:
    """A scene in Drake; arguments as `EngineMaker`.

    Attributes:
        damping: as `Engine`.
    Raises:
        ModelError: as `drake_scene`.
    """

    def __init__(
        self,
        scene: Scene,
        trees: Mapping[str, Tree],
        postures: Mapping[str, AgentPosture],
        height: float,
        step: float,
        feedback: Feedback,
    ) -> None:
        placed = {a.name: placed_links(a, trees[a.name], postures[a.name]) for a in scene.agents}
        made = drake_scene(scene, trees, placed, step)
        plant = self._plant = made.plant
        self._diagram, self._load = made.diagram, made.load
        self._whole = made.diagram.CreateDefaultContext()
        self._context = plant.GetMyMutableContextFromRoot(self._whole)
        self._agents = {a.name: _Parts.of(plant, a, trees[a.name], made.links[a.name]) for a in scene.agents}
        positions = plant.GetPositions(self._context)
        for agent in scene.agents:
            own = postures[agent.name].joints
            positions[self._agents[agent.name].places] = [own[joint] for joint in agent.joints]
        plant.SetPositions(self._context, positions)
        plant.SetFreeBodyPose(self._context, self._load, RigidTransform([0.0, 0.0, height]))
        for name, parts in self._agents.items():
            plant.SetFreeBodyPose(self._context, parts.root, transform_of(placed[name][trees[name].root]))
        self._now = plant.GetPositionsAndVelocities(self._context)
        self._inputs, self._rise = np.zeros(plant.num_velocities()), np.zeros(plant.num_velocities())
        self._drag, self._limits = self._inputs.copy(), np.full(plant.num_velocities(), math.inf)
        self.damping: dict[str, Array] = {}
        at_hand = scene.payload.mass / max(sum(len(agent.hands) for agent in scene.agents), 1)
        for agent in scene.agents:
            parts = self._agents[agent.name]
            damping = self.damping[agent.name] = feedback.rate * self._inertias(agent, parts, at_hand)
            for joint, each in zip(parts.joints, damping, strict=True):
                joint.SetDamping(self._context, each)
            self._drag[parts.rates], self._limits[parts.rates] = damping, parts.limits

    def _inertias(self, agent: Agent, parts: _Parts, at_hand: float) -> Array:
        """As `feedback`: about a joint of a leg all that is above turns, while its sole stays in place."""
        mass = self._plant.CalcMassMatrix(self._context)
        for hand in agent.hands:
            jacobian = self._jacobian(parts.links[hand.frame])[3:]
            mass = mass + at_hand * jacobian.T @ jacobian
        inertias = mass[parts.rates, parts.rates]
        for foot in agent.feet:
            jacobian = self._jacobian(parts.links[foot.frame])
            for place in np.flatnonzero(jacobian[:, parts.rates].any(axis=0)):
                still = np.zeros(len(mass))
                still[parts.rates[place]] = -1.0
                still[parts.free] = np.linalg.solve(jacobian[:, parts.free], jacobian[:, parts.rates[place]])
                inertias[place] = still @ mass @ still / 2.0
        return np.asarray(inertias)

    def _jacobian(self, link: Any) -> Array:
        """Of a link's angular and linear velocity in the world, shape (6, v)."""
        world, velocities = self._plant.world_frame(), JacobianWrtVariable.kV
        return np.asarray(
            self._plant.CalcJacobianSpatialVelocity(
                self._context, velocities, link.body_frame(), np.zeros(3), world, world
            )
        )

    @property
    def coordinates(self) -> Array:
        """Drake's positions."""
        return np.asarray(self._now[: self._plant.num_positions()])

    @property
    def velocities(self) -> Array:
        """Drake's velocities."""
        return np.asarray(self._now[self._plant.num_positions() :])

    @property
    def load(self) -> Array:
        """As `Engine`."""
        return self._pose(self._load)[:3]

    @property
    def tilt(self) -> float:
        """As `Engine`."""
        return tilt_of(np.array(matrix_from_wxyz(self._pose(self._load)[3:].tolist())))

    def state(self, name: str) -> EngineState:
        """As `Engine`."""
        parts, velocities = self._agents[name], self.velocities
        root = self._pose(parts.root)
        root_from_world: Array = np.array(matrix_from_wxyz(root[3:].tolist())).T
        angular, linear = np.split(velocities[parts.free], 2)
        return EngineState(
            root=root,
            twist=np.concatenate([root_from_world @ linear, root_from_world @ angular]),
            positions=self.coordinates[parts.places],
            rates=velocities[parts.rates],
        )

    def _pose(self, free: Any) -> Array:
        """Place and quaternion wxyz of a body that no joint holds, shape (7,)."""
        return np.roll(self.coordinates[free.floating_positions_start() :][:7], 3)

    def drive(self, name: str, inputs: Array, rise: Array) -> None:
        """As `Engine`."""
        rates = self._agents[name].rates
        self._inputs[rates], self._rise[rates] = inputs, rise

    def hold(self, name: str) -> None:
        """As `Engine`."""
        self._rise[self._agents[name].rates] = 0.0

    def push(self, name: str, frame: str, force: Array) -> None:
        """As `Engine`."""
        link, pushed = self._agents[name].links[frame], ExternallyAppliedSpatialForce()
        pushed.body_index = link.index()
        pushed.p_BoBq_B = link.default_spatial_inertia().get_com()
        pushed.F_Bq_W = SpatialForce(np.zeros(3), force)
        self._plant.get_applied_spatial_force_input_port().FixValue(self._context, [pushed])

    def advance(self, steps: int) -> None:
        """As `Engine`; where Drake finds no step, everything is nowhere from then on."""
        port = self._plant.get_applied_generalized_force_input_port()
        for _ in range(steps):
            self._inputs += self._rise
            damped = self._drag * self.velocities
            forces = np.clip(self._inputs - damped, -self._limits, self._limits) + damped
            port.FixValue(self._context, forces)
            try:
                after = self._diagram.EvalUniquePeriodicDiscreteUpdate(self._whole)
            except RuntimeError:
                self._now = np.full_like(self._now, np.nan)
            if not np.isfinite(self._now).all():
                break
            self._whole.SetDiscreteState(after)
            self._now = self._plant.GetPositionsAndVelocities(self._context)

    def moment(self) -> Moment:
        """As `Engine`."""
        return self._now.copy(), self._inputs.copy()

    def restore(self, moment: Any) -> None:
        """As `Engine`."""
        self._now, self._inputs = (each.copy() for each in moment)
        if np.isfinite(self._now).all():  # Drake ends the process else
            self._plant.SetPositionsAndVelocities(self._context, self._now)
