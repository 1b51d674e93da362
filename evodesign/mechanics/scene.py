"""The scene: robots and people who hold a level load, each from a side of its own.

World frame: origin on the ground under the load, z up; where one robot and one person face each other, x from
the robot towards the person. Each agent has a frame of its own, the world turned about z by quarter turns so
that the agent looks along +x at the load; in it, all agents obey the same constraints.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace

from evodesign.mechanics.agent import Agent, Role, StanceLimits
from evodesign.mechanics.contact import Ground
from evodesign.mechanics.disturbance import Disturbances
from evodesign.mechanics.payload import Payload
from evodesign.records import Case, Task
from evodesign.tree.model import Link, Tree

NO_ROBOT = Tree("no robot", (Link("no_robot"),), ())
"""What designs change where people hold the load without robots."""


@dataclass(frozen=True, slots=True)
class Scene:
    """Robot, person and load, and the limits under which they stand.

    Args:
        agents: in the order of programs, records and pages.
        payload: the load.
        ground: under all feet.
        stance: limits of postures of agents that have none of their own.
        disturbances: further load cases.
        robot_share: part of what the hands carry that the robot carries, disturbed or not; None where statics
            or the posture problem decides.
    """

    agents: tuple[Agent, ...]
    payload: Payload
    ground: Ground = field(default_factory=Ground)
    stance: StanceLimits = field(default_factory=StanceLimits)
    disturbances: Disturbances = field(default_factory=Disturbances)
    robot_share: float | None = None

    @property
    def robots(self) -> tuple[Agent, ...]:
        """The agents that are robots."""
        return tuple(agent for agent in self.agents if agent.role is Role.ROBOT)

    @property
    def people(self) -> tuple[Agent, ...]:
        """The agents that are people."""
        return tuple(agent for agent in self.agents if agent.role is Role.PERSON)

    @property
    def robot(self) -> Agent:
        """The first robot, whose hardware a design changes."""
        return self.robots[0]

    @property
    def designed(self) -> tuple[Agent, ...]:
        """The robots that designs change, who are all alike."""
        return tuple(agent for agent in self.agents if agent.designed)

    @property
    def designed_tree(self) -> Tree:
        """The tree of these robots; without any a single link that weighs nothing."""
        return self.designed[0].tree if self.designed else NO_ROBOT

    @property
    def human(self) -> Agent:
        """The first person."""
        return self.people[0]

    def agent(self, name: str) -> Agent:
        """The agent of a name."""
        return next(agent for agent in self.agents if agent.name == name)

    def with_agents(self, *changed: Agent) -> Scene:
        """The same with other agents in place of those of their names."""
        by_name = {agent.name: agent for agent in changed}
        return replace(self, agents=tuple(by_name.get(agent.name, agent) for agent in self.agents))

    def only(self, *agents: Agent) -> Scene:
        """The same with these agents alone."""
        return replace(self, agents=agents)

    @property
    def pair(self) -> tuple[str, str]:
        """Names of people and load, each empty where there is one."""
        return " and ".join(each.label for each in self.people if each.label), self.payload.label

    @property
    def label(self) -> str:
        """Who holds what, where there are several people or loads."""
        return ", ".join(name for name in self.pair if name)

    @property
    def undisturbed(self) -> Scene:
        """The same without disturbances."""
        return replace(self, disturbances=Disturbances())

    def stance_of(self, agent: Agent) -> StanceLimits:
        """The limits under which an agent stands."""
        return self.stance if agent.stance is None else agent.stance

    def case(self, task: Task) -> Case:
        """Its person with its load at a task, undisturbed."""
        person, payload = self.pair
        return Case(person=person, payload=payload, task=task)


def scene_of(scenes: Iterable[Scene], pair: tuple[str, str]) -> Scene:
    """The scene of a person and a load, by their names."""
    return next(scene for scene in scenes if scene.pair == pair)
