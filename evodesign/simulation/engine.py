"""What a controlled simulation asks of an engine, which moves robot, people and load by Newton's laws.

An engine makes its model of the agents' trees: masses, inertias, joints with their ranges, rotors and torque
limits, soles on a floor with friction, hands on the load. Its motors follow

    tau = tau* + d (v* - v),        d = 2 z w I

with I of each joint as in `feedback`, the input tau* + d v* within the motor's limits with the speed v of the
beginning of a step, and d taken at its end.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Protocol

from evodesign.body.placement import Placement
from evodesign.control.gains import Feedback
from evodesign.mechanics.agent import Agent
from evodesign.mechanics.scene import Scene
from evodesign.posture.results import AgentPosture, Array
from evodesign.simulation.installed import EngineName
from evodesign.tree.frames import link_frames
from evodesign.tree.model import Tree


@dataclass(frozen=True, slots=True, eq=False)
class EngineState:
    """Where an agent is and how it moves; j joints in the agent's order.

    Args:
        root: place [m] and quaternion wxyz of the root link in the world, shape (7,).
        twist: linear and angular velocity of the root link in its own axes [m/s, rad/s], shape (6,).
        positions: of the joints [rad], shape (j,).
        rates: of the joints [rad/s], shape (j,).
    """

    root: Array
    twist: Array
    positions: Array
    rates: Array


class Engine(Protocol):
    """A scene at a moment."""

    @property
    def damping(self) -> Mapping[str, Array]:
        """Damping d of each joint [N m s/rad], by agent name."""
        ...

    @property
    def coordinates(self) -> Array:
        """Of everything."""
        ...

    @property
    def velocities(self) -> Array:
        """Of everything [m/s, rad/s]."""
        ...

    @property
    def load(self) -> Array:
        """Place of the load's centre in the world [m], shape (3,)."""
        ...

    @property
    def tilt(self) -> float:
        """Angle of the load from level [rad]."""
        ...

    def state(self, name: str) -> EngineState:
        """Of an agent."""
        ...

    def drive(self, name: str, inputs: Array, rise: Array) -> None:
        """Inputs tau* + d v* of an agent's motors [N m], before they first rise, until others are said.

        Args:
            name: of the agent.
            inputs: shape (j,).
            rise: of the inputs at the beginning of each step, shape (j,).
        """
        ...

    def hold(self, name: str) -> None:
        """An agent's inputs stay what they are."""
        ...

    def push(self, name: str, frame: str, force: Array) -> None:
        """A force on the centre of mass of an agent's link, in the world [N], until another is said."""
        ...

    def advance(self, steps: int) -> None:
        """On by some steps."""
        ...

    def moment(self) -> object:
        """A copy of this moment."""
        ...

    def restore(self, moment: object) -> None:
        """Return to a moment; it stays as it is."""
        ...


EngineMaker = Callable[
    [Scene, Mapping[str, Tree], Mapping[str, AgentPosture], float, float, Feedback], Engine
]
"""From scene, trees by agent name, postures by agent name, height of the load's centre [m], step [s] and
the feedback that sets the damping to the scene at rest in these postures."""


def engine_named(name: EngineName) -> EngineMaker:
    """The engine of a name, which has to be installed."""
    if name is EngineName.DRAKE:
        from evodesign.simulation.drake_engine import DrakeEngine

        return DrakeEngine
    from evodesign.simulation.mujoco_engine import MujocoEngine

    return MujocoEngine


def tilt_of(turn: Array) -> float:
    """Angle of a frame's z from the world's [rad], of its turn, shape (3, 3)."""
    return math.acos(min(1.0, max(-1.0, float(turn[2, 2]))))


def placed_links(agent: Agent, tree: Tree, posture: AgentPosture) -> Mapping[str, Placement]:
    """world_from_link of an agent's links, by name."""
    world_from_agent = Placement.from_xyz_rpy((0.0, 0.0, 0.0), (0.0, 0.0, agent.facing))
    base = Placement.from_xyz_rpy(posture.base_position.tolist(), posture.base_angles.tolist())
    return link_frames(tree, world_from_agent @ base, posture.joints)
