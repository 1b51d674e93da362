"""Robot, person and load as one mechanical system: the composite matrices of the paper.

    M dnu/dt + h = B tau + Q^T f        (Eq. 9, first row)
    dQ/dt nu + Q dnu/dt = 0             (Eq. 9, second row)

nu stacks the velocities of robot, person and load (`floating` says which); M and h (Coriolis, centrifugal and
gravity terms) are stacked alike; B = (0; 1) of each agent selects its joints. The rows of Q, and of the
wrenches f, are the contacts:

    foot   J_sole nu_agent = 0, in the sole frame: force [N] and moment [N m] on the foot
    hand   J_hand nu_agent - J_grasp nu_load = 0, in the agent's frame: force [N] on the hand; with rigid
           grasps also the moment about the grasp point [N m]. The load feels the negative.

Source: Sartore et al. 2022, Eq. 8 and 9.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
import scipy

from evodesign.mechanics.agent import Agent, Contact, Touched
from evodesign.mechanics.floating_base import ROOT, Array, BodyState, Configuration, FloatingBody
from evodesign.mechanics.payload import Grasp
from evodesign.mechanics.scene import Scene
from evodesign.tree.model import Tree

PAYLOAD = "payload"
"""Name of the load among the parts of the system, beside the agents' names."""

AT_REST: Mapping[str, Array] = MappingProxyType({})
"""Velocities of a system that stands still."""


def level_load(height: float) -> Configuration:
    """The load, level, with its centre at a height [m] above the world's origin."""
    return Configuration(np.array([0.0, 0.0, height]), np.zeros(3))


@dataclass(frozen=True, slots=True)
class ContactRows:
    """A contact of an agent and its rows in Q and f."""

    agent: str
    contact: Contact
    rows: slice


@dataclass(frozen=True, slots=True, eq=False)
class CoupledSystem:
    """The coupled system at one configuration and velocity: v velocities, j joints, c contact rows.

    Args:
        mass: M, shape (v, v).
        bias: h, shape (v,); at rest it is the paper's g.
        selector: B, shape (v, j).
        coupling: Q, shape (c, v).
        drift: dQ/dt nu, shape (c,) [m/s^2, rad/s^2]; zero at rest.
        joints: agent and joint name of each column of B: the robot's, then the person's, in agent order.
        contacts: in the order of the rows of Q.
    """

    mass: Array
    bias: Array
    selector: Array
    coupling: Array
    drift: Array
    joints: tuple[tuple[str, str], ...]
    contacts: tuple[ContactRows, ...]

    def wrenches_of(self, agent: str, wrenches: Array) -> dict[str, Array]:
        """An agent's part of f [N, N m], by the names of its contacts."""
        return {each.contact.name: wrenches[each.rows] for each in self.contacts if each.agent == agent}


class CoupledModel:
    """A design's robot, the person and the load, ready to be put into any configuration."""

    def __init__(self, scene: Scene, robot_tree: Tree) -> None:
        """Build the bodies.

        Args:
            scene: agents and load.
            robot_tree: the design's robot, numbers only.
        """
        self._hand_rows = 6 if scene.payload.grasp is Grasp.RIGID else 3
        self._agents = scene.agents
        trees = [(agent, robot_tree if agent.designed else agent.tree) for agent in self._agents]
        grasps = {
            _grasp(agent, hand): agent.turn @ np.array(scene.payload.grasp_point(agent, hand))
            for agent in self._agents
            for hand in agent.hands
        }
        self._bodies = {
            **{agent.name: FloatingBody.of_tree(tree, agent.joints, agent.turn) for agent, tree in trees},
            PAYLOAD: FloatingBody.of_solid(scene.payload.inertia, grasps),
        }

    def at(
        self, configurations: Mapping[str, Configuration], velocities: Mapping[str, Array] = AT_REST
    ) -> CoupledSystem:
        """The composite matrices at a configuration and velocity.

        Args:
            configurations: by name: robot and person in their own frames, the load (`PAYLOAD`) in the world.
            velocities: parts of nu by name, shape (6 + joints,); what is left out stands still.
        """
        states = {
            name: body.at(configurations[name], velocities.get(name, np.zeros(body.size)))
            for name, body in self._bodies.items()
        }
        rows = [self._rows(states, agent, contact) for agent, contact in self._places()]
        ends = np.cumsum([len(drift) for _, drift in rows])
        contacts = tuple(
            ContactRows(agent.name, contact, slice(end - len(drift), end))
            for (agent, contact), (_, drift), end in zip(self._places(), rows, ends.tolist(), strict=True)
        )
        return CoupledSystem(
            mass=scipy.linalg.block_diag(*[state.mass for state in states.values()]),
            bias=np.concatenate([state.bias for state in states.values()]),
            selector=scipy.linalg.block_diag(*[_selector(body) for body in self._bodies.values()]),
            coupling=np.vstack([jacobian for jacobian, _ in rows]),
            drift=np.concatenate([drift for _, drift in rows]),
            joints=tuple((agent.name, joint) for agent in self._agents for joint in agent.joints),
            contacts=contacts,
        )

    def _places(self) -> list[tuple[Agent, Contact]]:
        """Every contact in the order of its rows."""
        return [(agent, contact) for agent in self._agents for contact in agent.contacts]

    def _rows(self, states: Mapping[str, BodyState], agent: Agent, contact: Contact) -> tuple[Array, Array]:
        """A contact's rows of Q and of dQ/dt nu."""
        blocks = {name: np.zeros((ROOT, body.size)) for name, body in self._bodies.items()}
        if contact.touched is Touched.GROUND:
            blocks[agent.name], drift = states[agent.name].twist_in_frame(contact.frame)
            return np.hstack(list(blocks.values())), drift
        agent_from_world = np.kron(np.eye(2), agent.turn.T)[: self._hand_rows]
        hand, hand_drift = states[agent.name].twist_in_world(contact.frame)
        grasp, grasp_drift = states[PAYLOAD].twist_in_world(_grasp(agent, contact))
        blocks[agent.name], blocks[PAYLOAD] = hand, -grasp
        jacobian = agent_from_world @ np.hstack(list(blocks.values()))
        return np.asarray(jacobian), np.asarray(agent_from_world @ (hand_drift - grasp_drift))


def _grasp(agent: Agent, hand: Contact) -> str:
    """Name of the load's frame at a hand."""
    return f"{agent.name}_{hand.name}_grasp"


def _selector(body: FloatingBody) -> Array:
    """A body's part of B: nothing on the root, one torque on each joint."""
    count = len(body.joints)
    return np.vstack([np.zeros((ROOT, count)), np.eye(count)])
