"""The load: level, still, and held by all hands.

    sum_i f_i + (0, 0, -m g) = 0        sum_i (r_i x f_i + n_i) + c x (0, 0, -m g) = 0

with f_i and n_i the force and moment of hand i on the load (no moment with `point` grasps, as in the paper),
r_i its grasp point and c the centre of mass, both from the box's centre. The agents push against each other
with the internal force

    X = (X_1 + X_2) / 2        X_a agent a's force on the load along its own x, in which it looks at the load

of two who face each other, which is the push of either where nothing else pushes the load. Whoever holds the
load from a side on which nobody is opposite pushes with X = X_a. Where the robots' share s is given, their
hands carry s m g. Where rigid grasps leave it free, it lies between 0 and 1: without that bound the best
posture lifts the partner by the load with hundreds of newtons.

A load that is lifted is as much heavier as its acceleration asks for: m (g + a).

Source: Sartore et al. 2022, Eq. 8, third row at rest.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

import casadi as ca
import numpy as np
import pinocchio as pin

from evodesign.mechanics.agent import Agent, Role
from evodesign.mechanics.balance import GRAVITY
from evodesign.mechanics.disturbance import Disturbance, PushedAt
from evodesign.mechanics.payload import Grasp
from evodesign.mechanics.scene import Scene
from evodesign.posture.limit_groups import LimitGroup
from evodesign.posture.terms.base import (
    UNDISTURBED,
    Bound,
    Coupled,
    MeasuredSystem,
    Residual,
    Row,
    SystemTerm,
    both_ways,
)
from evodesign.tree.kinematics import Expression, vector

PUSH = "load.push"
"""Name of the row that bounds the internal force."""

INTERNAL_FORCE = "internal force"
"""What its bound is called."""

LOAD_UNIT = 10.0  # [N] and [N m] per unit of the load's balance rows


def any_load(scene: Scene) -> tuple[Scene, Expression]:
    """A scene whose load has any mass, and that mass [kg] as a symbol: a parameter of its programs."""
    mass = ca.SX.sym("mass")
    return replace(scene, payload=replace(scene.payload, mass=mass)), mass


def turned_to_world(agent: Agent, in_agent: Expression) -> Expression:
    """A vector in world axes from one in the agent's frame, which is turned about z by quarter turns."""
    return ca.sparsify(ca.DM(agent.turn)) @ in_agent


def turned_to_agent(agent: Agent, in_world: Expression) -> Expression:
    """A vector in the agent's frame from one in world axes."""
    return ca.sparsify(ca.DM(agent.turn.T)) @ in_world


def push_on_load(hands: Mapping[str, Expression]) -> Expression:
    """Force of an agent on the load along the agent's own x, in which it looks at the load [N].

    Args:
        hands: wrenches on its hands, in its frame, by name.
    """
    return sum(-wrench[0] for wrench in hands.values())


def pushing(scene: Scene) -> list[tuple[Agent, ...]]:
    """Who push against each other through the load: two who face each other, or one at the side of others.

    An agent alone pushes against nobody.
    """
    if len(scene.agents) == 1:
        return []
    axes = [[agent for agent in scene.agents if agent.quarters % 2 == axis] for axis in range(2)]
    return [tuple(agents) for agents in axes if agents]


def rows(coupled: Coupled) -> Iterator[Row]:
    """Balance of the load, the bound on the internal force, and the robot's share where it is bounded."""
    scene, disturbance = coupled.scene, coupled.disturbance
    scene = scene if disturbance is UNDISTURBED else _disturbed(scene, disturbance)
    weight = ca.vertcat(0.0, 0.0, -(GRAVITY + coupled.load_acceleration) * scene.payload.mass)
    force = weight
    if disturbance is not UNDISTURBED:
        force = weight + vector(disturbance.push_on(PushedAt.LOAD))
    unbalanced = _unbalanced(coupled, scene, force, weight)
    internal = _internal_forces(coupled)
    carried = -sum(wrench[2] for agent in scene.robots for wrench in coupled.hands[agent.name].values())
    limit = scene.stance.push / LOAD_UNIT
    balance = ("load.force_balance", "load.moment_balance")
    yield Row("load.balance", unbalanced / LOAD_UNIT, 0.0, 0.0, balance, LOAD_UNIT)
    most = Bound(INTERNAL_FORCE, scene.stance.push, "N", True, 1.0 / LOAD_UNIT, "limits.push_n")
    apart, together = both_ways(most)
    row = Row(PUSH, internal / LOAD_UNIT, -limit, limit, (PUSH,), LOAD_UNIT, LimitGroup.STANCE)
    if internal.numel():
        yield replace(row, least=(apart,), most=(together,))
    whole = -force[2]
    if scene.robot_share is not None:
        missing = (carried - scene.robot_share * whole) / LOAD_UNIT
        yield Row("load.share", missing, 0.0, 0.0, ("load.share",), LOAD_UNIT)
    elif scene.payload.grasp is Grasp.RIGID and scene.robots and scene.people:
        parts, share = ca.vertcat(carried, whole - carried) / LOAD_UNIT, "robot's share of the load"
        per_share = whole / LOAD_UNIT
        ends = Bound(share, 0.0, "1", False, per_share), Bound(share, 1.0, "1", True, -per_share)
        yield Row("load.share", parts, 0.0, np.inf, ("load.share",), LOAD_UNIT, least=ends)


def _disturbed(scene: Scene, disturbance: Disturbance) -> Scene:
    return replace(scene, payload=scene.payload.disturbed(disturbance))


def _internal_forces(coupled: Coupled) -> Expression:
    """X [N] of everyone who push against each other, a column."""
    found = []
    for agents in pushing(coupled.scene):
        one, *others = (push_on_load(coupled.hands[agent.name]) for agent in agents)
        disturbed = others and coupled.disturbance is not UNDISTURBED
        found.append((one + others[0]) / 2.0 if disturbed else one)
    return ca.vertcat(ca.SX(0, 1), *found)


def _unbalanced(coupled: Coupled, scene: Scene, force: Expression, weight: Expression) -> Expression:
    """Sum of forces [N] and moments about the box's centre [N m] on the load.

    Args:
        coupled: hands.
        scene: with the load of the load case.
        force: of everything but hands, [N].
        weight: the part of it that acts at the centre of mass; the rest acts at the box's centre.
    """
    moment: Expression = ca.cross(vector(scene.payload.center_of_mass), weight)
    for agent in scene.agents:
        for hand in agent.hands:
            wrench = coupled.hands[agent.name][hand.name]
            on_load = -turned_to_world(agent, wrench[:3])
            point = turned_to_world(agent, vector(scene.payload.grasp_point(agent, hand)))
            force = force + on_load
            moment = moment + ca.cross(point, on_load) - turned_to_world(agent, wrench[3:])
    both = ca.vertcat(force, moment)
    return both[[0, 2, 4]] if coupled.symmetric else both  # the others vanish by symmetry


def residuals(system: MeasuredSystem) -> Iterator[Residual]:
    """Balance of the load, of which a push meets the box's centre, and bounds on hands and their shares."""
    scene, payload = system.scene, system.payload
    outside = np.array(system.disturbance.push_on(PushedAt.LOAD))
    weight = np.array([0.0, 0.0, -(GRAVITY + system.load_acceleration) * payload.mass])
    force, moment = weight + outside, pin.skew(np.array(payload.center_of_mass)) @ weight
    passed, carried = 0.0, 0.0
    pushes = {agent.name: 0.0 for agent in scene.agents}
    for agent in scene.agents:
        world_from_agent = agent.turn
        for hand in agent.hands:
            wrench = system.bodies[agent.name].posture.wrenches[hand.name]
            on_load = -world_from_agent @ wrench[:3]
            point = world_from_agent @ np.array(payload.grasp_point(agent, hand))
            force = force + on_load
            moment = moment + pin.skew(point) @ on_load - world_from_agent @ wrench[3:]
            pushes[agent.name] -= float(wrench[0])
            if agent.role is Role.ROBOT:
                carried += float(on_load[2])
            passed = max(passed, float(np.abs(wrench[3:]).max()))
    yield Residual("load.force_balance", float(np.abs(force).max()), "N", "the load's balance of forces")
    yield Residual("load.moment_balance", float(np.abs(moment).max()), "N m", "the load's balance of moments")
    internal = [0.0]
    for first, *opposite in pushing(scene):
        mean = [pushes[first.name], *(pushes[agent.name] for agent in opposite)]
        internal.append(abs(float(np.mean(mean) if system.disturbance is not UNDISTURBED else mean[0])))
    beyond = max(0.0, max(internal) - scene.stance.push)
    yield Residual(PUSH, beyond, "N", "the internal force", LimitGroup.STANCE)
    grasp = passed if payload.grasp is Grasp.POINT else 0.0
    yield Residual("load.grasp", grasp, "N m", "the moment of a hand that passes none")
    if payload.hand_moment < np.inf:
        beyond = max(0.0, passed - payload.hand_moment)
        yield Residual("load.hand_moment", beyond, "N m", "the moment of a hand", LimitGroup.CONTACT)
    whole = -float(weight[2] + outside[2])
    if scene.robot_share is not None:
        yield Residual("load.share", abs(carried - scene.robot_share * whole), "N", "the robot's share")
    elif payload.grasp is Grasp.RIGID and scene.robots and scene.people:
        yield Residual("load.share", max(0.0, -carried, carried - whole), "N", "the robot's share")


LOAD = SystemTerm("load", rows=rows, residuals=residuals)
