"""The independent check of a posture: other code, other library, plain numbers.

Nothing of the solver's graph is used. The agents' trees go into pinocchio, which gives kinematics, gravity
torques and Jacobians; from them every term (`posture.terms`) computes its residuals anew.

Beyond 300 lines: what checks a posture is read as a whole by whoever doubts the solver.

Source: Sartore et al. 2022, Eq. 5 at rest; pinocchio `nonLinearEffects` at rest.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, field, replace

import numpy as np
import pinocchio as pin

from evodesign.body.placement import Vector
from evodesign.collision.clearance import BodyDistance
from evodesign.collision.rules import FLOOR, LOAD, PARTNER, BodyPair
from evodesign.collision.scene_bodies import CheckedBodies, SceneBodies
from evodesign.mechanics.agent import Agent, Role
from evodesign.mechanics.disturbance import Disturbance
from evodesign.mechanics.floating_base import ROOT, BodyState, Configuration, FloatingBody
from evodesign.mechanics.scene import Scene
from evodesign.posture.results import AgentPosture, Array, Instant
from evodesign.posture.terms.base import UNDISTURBED, BodyTerm, MeasuredBody, MeasuredSystem, Residual
from evodesign.posture.terms.registry import TERMS
from evodesign.tree.equip import actuators_of, rated_torques
from evodesign.tree.model import Tree

TOLERANCE = 1e-5
"""Largest residual of a posture that counts as solved, in SI units."""

Postures = Mapping[str, AgentPosture]


@dataclass(frozen=True, slots=True)
class AgentModel:
    """An agent as pinocchio sees it, in its own frame.

    Args:
        agent: with the limits of a design's actuators.
        body: its links.
        solid: its bodies; None where they may pass through anything.
        tree: of numbers, a design's.
        rotors: inertia of its actuators [kg m^2], by joint.
    """

    agent: Agent
    body: FloatingBody
    solid: CheckedBodies | None
    tree: Tree
    rotors: Mapping[str, float] = field(default_factory=dict)

    @classmethod
    def of(cls, agent: Agent, tree: Tree) -> AgentModel:
        """The agent with a tree of numbers (a design's)."""
        rules = agent.collisions
        solid = None if rules is None else CheckedBodies.of(tree, rules.checked)
        return cls(agent, FloatingBody.of_tree(tree, agent.joints, np.eye(3)), solid, tree)

    def resized(self, tree: Tree) -> AgentModel:
        """The same agent with the tree of another design, and the limits of its actuators."""
        agent, solid = self.agent, None if self.solid is None else self.solid.resized(tree)
        return replace(
            self,
            agent=_limited(agent, tree),
            body=self.body.resized(tree),
            solid=solid,
            tree=tree,
            rotors=_rotors(tree),
        )

    def driven(self, tree: Tree) -> AgentModel:
        """The same agent with actuators.

        Args:
            tree: of the agent as it is, with actuators beside.
        """
        mounted = [(link.name, solid) for link in tree.links for solid in link.mounted]
        body = self.body.carrying(mounted)
        return replace(self, agent=_limited(self.agent, tree), body=body, tree=tree, rotors=_rotors(tree))

    def at(self, posture: AgentPosture, motion: AgentMotion | None = None) -> BodyState:
        """Kinematics, Jacobians and gravity torques of a posture, and what its motion takes beside them."""
        configuration = Configuration(posture.base_position, posture.base_angles, posture.joints)
        if motion is None:
            return self.body.at(configuration, np.zeros(self.body.size))
        state = self.body.at(configuration, *motion.velocities(posture.base_angles))
        bias = state.bias.copy()
        for place, name in enumerate(self.agent.joints, ROOT):
            bias[place] += self.rotors.get(name, 0.0) * motion.changes[place]
        return replace(state, bias=bias)


@dataclass(frozen=True, slots=True, eq=False)
class AgentMotion:
    """How an agent moves: time derivatives of its base's position and angles, and of its joints.

    Args:
        rates: [m/s, rad/s], shape (6 + joints,), joints in the agent's order.
        changes: of the rates, likewise.
    """

    rates: Array
    changes: Array

    def velocities(self, angles: Array) -> tuple[Array, Array]:
        """Velocity and acceleration as pinocchio has them: the base's in the base link's own axes.

        Args:
            angles: roll, pitch, yaw of the base [rad].
        """
        turn = pin.rpy.rpyToMatrix(*angles).T
        by_rate = pin.rpy.computeRpyJacobian(angles, pin.LOCAL)
        drift = pin.rpy.computeRpyJacobianTimeDerivative(angles, self.rates[3:6], pin.LOCAL)
        linear, angular = turn @ self.rates[:3], by_rate @ self.rates[3:6]
        speeding = turn @ self.changes[:3] - np.cross(angular, linear)
        turning = by_rate @ self.changes[3:6] + drift @ self.rates[3:6]
        velocity = np.concatenate([linear, angular, self.rates[ROOT:]])
        return velocity, np.concatenate([speeding, turning, self.changes[ROOT:]])


@dataclass(frozen=True, slots=True, eq=False)
class SceneMotion:
    """How everything moves at an instant.

    Args:
        agents: by name.
        load_acceleration: of the load, upwards [m/s^2].
    """

    agents: Mapping[str, AgentMotion] = field(default_factory=dict)
    load_acceleration: float = 0.0


AT_REST = SceneMotion()
"""Nothing moves."""


def _rotors(tree: Tree) -> dict[str, float]:
    """Inertia that each actuator's rotor has at its joint [kg m^2]."""
    return {name: float(each.inertia) for name, each in actuators_of(tree).items()}


def _limited(agent: Agent, tree: Tree) -> Agent:
    """The agent with the limits of a tree's actuators, and of joints whose limits a design chooses."""
    joints = tree.joint_by_name
    if agent.chosen_ranges:
        chosen = {
            name: (float(joints[name].lower), float(joints[name].upper)) for name in agent.chosen_ranges
        }
        agent = replace(agent, bent_ranges={**agent.bent_ranges, **chosen})
    rated = {joint: limit for joint, limit in rated_torques(tree).items() if joint in agent.joints}
    if not rated:
        return agent
    limits = agent.torque_limits if agent.limits_torques else {}
    return replace(agent, torque_limits={**limits, **rated}, limits_torques=True)


def near_bodies(
    models: Iterable[AgentModel],
    postures: Mapping[str, AgentPosture],
    load: Vector,
    load_height: float,
    within: float = 0.0,
) -> list[BodyDistance]:
    """Bodies that must not overlap and are nearer to each other than a distance, of those who have postures.

    Args:
        models: of agents; who has no bodies is left out.
        postures: by agent name, of one agent or several.
        load: sides of its box [m].
        load_height: of the load's centre [m].
        within: the distance [m].
    """
    present = [(model, postures[model.agent.name]) for model in models if model.agent.name in postures]
    solids = {model.agent.name: model.solid for model, _ in present if model.solid is not None}
    if not solids:
        return []
    poses = {
        model.agent.name: (model.agent.turn, model.at(posture).poses)
        for model, posture in present
        if model.agent.name in solids
    }
    return SceneBodies(solids, load).near(poses, load_height, within)


def own_pairs(gap: BodyDistance) -> Iterator[tuple[str, BodyPair]]:
    """The pair as those see it whom it is of, by agent: who is near the other one keeps to its own side."""
    agent, _, link = gap.first.partition(" ")
    if gap.second in (LOAD, FLOOR):
        yield agent, (link, gap.second)
        return
    other, _, second = gap.second.partition(" ")
    if other == agent:
        yield agent, (link, second)
    else:
        yield agent, (link, PARTNER)
        yield other, (second, PARTNER)


def own_overlaps(gaps: Iterable[BodyDistance]) -> dict[tuple[str, BodyPair], float]:
    """How deep bodies are in each other [m], as those see it whom they are of: by agent and pair."""
    return {own: -gap.distance for gap in gaps for own in own_pairs(gap)}


class Checker:
    """Residuals of postures of one design in a scene."""

    def __init__(self, scene: Scene, *models: AgentModel) -> None:
        self._scene, self._models = scene, models
        self._solids: dict[tuple[tuple[int, ...], Vector], SceneBodies | None] = {}

    @property
    def robot(self) -> AgentModel:
        """The first one, of the design."""
        return next(model for model in self._models if model.agent.designed)

    def elsewhere(self, scene: Scene, *people: AgentModel) -> Checker:
        """The check of the same robots in another scene."""
        other, robots = copy(self), [each for each in self._models if each.agent.role is Role.ROBOT]
        other._scene, other._models = scene, (*robots, *people)
        return other

    def _bodies(self) -> SceneBodies | None:
        """Of all agents and the load; worked out once for all scenes that have these people and this load."""
        people = tuple(id(model) for model in self._models if model.agent.role is Role.PERSON)
        key = people, self._scene.payload.size
        if key not in self._solids:
            solids = {model.agent.name: model.solid for model in self._models if model.solid is not None}
            self._solids[key] = SceneBodies(solids, self._scene.payload.size) if solids else None
        return self._solids[key]

    def overlaps(
        self, instants: Sequence[Instant], load_heights: Sequence[float]
    ) -> list[list[BodyDistance]]:
        """Bodies that must not do so and overlap in each posture, with the load's centre at heights [m]."""
        solids = self._bodies()
        if solids is None:
            return [[] for _ in instants]

        def found(instant: Instant, height: float) -> list[BodyDistance]:
            poses = {
                model.agent.name: (model.agent.turn, model.at(instant.postures[model.agent.name]).poses)
                for model in self._models
            }
            return [gap for gap in solids.near(poses, height) if gap.distance < -TOLERANCE]

        return [found(*each) for each in zip(instants, load_heights, strict=True)]

    def residuals(
        self, instant: Instant, load_height: float, motion: SceneMotion = AT_REST
    ) -> tuple[Residual, ...]:
        """What each term finds violated, SI units; zero or rounding for a posture that holds.

        Args:
            instant: postures, and what is carried in them under each of the scene's disturbances.
            load_height: of the load's centre [m].
            motion: of agents and load.
        """
        found = [*self._load_case(UNDISTURBED, instant.postures, instant.postures, load_height, motion)]
        for disturbance in self._scene.disturbances.cases:
            own = instant.disturbed[disturbance.name]
            found += [
                residual.named(f"{disturbance.name}: {residual.name}")
                for residual in self._load_case(disturbance, instant.postures, own, load_height, motion)
                if not residual.posture_only
            ]
        return tuple(found)

    def task_residuals(
        self, instants: Sequence[Instant], load_heights: Sequence[float]
    ) -> tuple[Residual, ...]:
        """Those of all instants of a task; where there are several, names begin with the instant's number."""
        found: list[Residual] = []
        for number, (instant, height) in enumerate(zip(instants, load_heights, strict=True)):
            place = f"instant {number}, " if len(instants) > 1 else ""
            here = self.residuals(instant, height)
            found += [each.named(place + each.name) for each in here] if place else here
        return tuple(found)

    def _load_case(
        self,
        disturbance: Disturbance,
        undisturbed: Postures,
        postures: Postures,
        load_height: float,
        motion: SceneMotion,
    ) -> Iterator[Residual]:
        bodies = {
            model.agent.name: MeasuredBody(
                agent=model.agent,
                posture=postures[model.agent.name],
                undisturbed=undisturbed[model.agent.name],
                state=model.at(postures[model.agent.name], motion.agents.get(model.agent.name)),
                scene=self._scene,
                load_height=load_height,
                disturbance=disturbance,
            )
            for model in self._models
        }
        payload = self._scene.payload
        if disturbance is not UNDISTURBED:
            payload = payload.disturbed(disturbance)
        accelerated = motion.load_acceleration
        system = MeasuredSystem(self._scene, payload, bodies, disturbance, self._bodies(), accelerated)
        for term in TERMS.values():
            if isinstance(term, BodyTerm):
                for name, body in bodies.items():
                    for residual in term.residuals(body):
                        yield residual.named(f"{name}.{residual.name}")
            else:
                yield from term.residuals(system)


class Unchecked(Checker):
    """Takes every posture as it is, where another one is checked in its place."""

    def __init__(self) -> None:
        """Of no scene."""

    def elsewhere(self, scene: Scene, *people: AgentModel) -> Checker:
        """Itself."""
        return self

    def overlaps(
        self, instants: Sequence[Instant], load_heights: Sequence[float]
    ) -> list[list[BodyDistance]]:
        """None."""
        return [[] for _ in instants]

    def task_residuals(
        self, instants: Sequence[Instant], load_heights: Sequence[float]
    ) -> tuple[Residual, ...]:
        """None."""
        return ()


def sizes(residuals: Sequence[Residual]) -> dict[str, float]:
    """Sizes in SI units by name, as they are shown and logged."""
    return {residual.name: residual.size for residual in residuals}
