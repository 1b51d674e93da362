"""The scene: robots and people who hold a level load, each from a side of its own.

World frame: origin on the ground under the load, z up; where one robot and one person face each other, x from
the robot towards the person. Each agent has a frame of its own, the world turned about z by quarter turns so
that the agent looks along +x at the load; in it, all agents obey the same constraints.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from evodesign.body.inertia import Inertia
from evodesign.body.placement import Vector
from evodesign.body.shape import Box
from evodesign.collision.rules import CollisionRules
from evodesign.human.coupled_joints import CoupledJoints, Rhythm
from evodesign.human.measured_posture import MeasuredPosture
from evodesign.human.strength import JointStrength
from evodesign.mechanics.contact import Ground, SoleSize
from evodesign.mechanics.disturbance import Disturbance, Disturbances
from evodesign.records import Case, Task
from evodesign.tree.model import Tree

ROBOT, HUMAN = "robot", "human"
"""Names of the robot and of the person where there is one of each."""

SIDES = ("left", "right")

TO_THE_LEFT = {"left": 1.0, "right": -1.0, "": 0.0}
"""The direction along y of a side."""

DIAGONAL = math.sqrt(0.5)

QUARTERS = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))
"""Cosine and sine of no, one, two and three quarter turns."""

WRIST_MOMENT = 7.0
"""Largest moment of a hand about each axis [N m] that a person's wrists bear, whoever is on the other side.

That of extension, the weakest direction: 7.1 N m, the mean of ten men.
Source: Delp, Grierson and Buchanan 1996.
"""


class Role(StrEnum):
    """What an agent is: for objectives, for what designs change, and for how it is drawn."""

    ROBOT = "robot"
    PERSON = "person"


class Touched(StrEnum):
    """What an agent touches."""

    GROUND = "ground"
    LOAD = "load"


@dataclass(frozen=True, slots=True)
class Contact:
    """Where an agent touches the ground or the load.

    Args:
        name: unique in its agent, such as `left_hand`.
        touched: what it touches.
        frame: of the agent; on the ground its z is the ground's normal.
        side: `left` or `right` of a pair of mirror images; empty on the middle line.
        patch: of the sole that stands on the ground; None: a hand.
    """

    name: str
    touched: Touched
    frame: str
    side: str = ""
    patch: SoleSize | None = None

    @property
    def sole(self) -> SoleSize:
        """The patch of a foot."""
        if self.patch is None:
            raise ValueError(f"{self.name} stands on nothing")
        return self.patch


def touching(contacts: Iterable[Contact], touched: Touched) -> tuple[Contact, ...]:
    """The contacts with the ground, or with the load."""
    return tuple(each for each in contacts if each.touched is touched)


def two_hands_two_feet(
    hands: Mapping[str, str], soles: Mapping[str, str], sole: SoleSize
) -> tuple[Contact, ...]:
    """The contacts of somebody who stands on both feet and holds the load with both hands.

    Args:
        hands: frame that meets the load, by side.
        soles: frame under the foot, by side.
        sole: size of each foot.
    """
    feet = [Contact(f"{side}_foot", Touched.GROUND, soles[side], side, sole) for side in SIDES]
    return (*feet, *(Contact(f"{side}_hand", Touched.LOAD, hands[side], side) for side in SIDES))


class Grasp(StrEnum):
    """What a hand can pass to the load: a force (as in the paper), or a force and a moment."""

    POINT = "point"
    RIGID = "rigid"


class GraspDirection(StrEnum):
    """From where an agent's forearms come to the load: from below and behind, from outside and behind."""

    FREE = "free"
    UNDER = "under"
    SIDE = "side"

    def axis(self, side: str) -> Vector | None:
        """Direction of a side's forearm from elbow to hand, in the agent's frame; None if it is free."""
        inward = -DIAGONAL if side == "left" else DIAGONAL
        return {
            GraspDirection.FREE: None,
            GraspDirection.UNDER: (DIAGONAL, 0.0, DIAGONAL),
            GraspDirection.SIDE: (DIAGONAL, inward, 0.0),
        }[self]


@dataclass(frozen=True, slots=True)
class Payload:
    """A box held level by four hands. Its frame has the world's axes and its origin at the box's centre.

    Args:
        size: depth along x (robot to person), width along y, height along z [m].
        mass: [kg].
        center_of_mass: from the box's centre, in its frame [m].
        grasp: what every hand can pass to the load.
        hand_moment: largest size of each component of the moment that a rigid hand passes [N m].
        grasp_points: of agents' hands in the load's frame [m], by the names of agent and contact; the hands
            that it leaves out are at the top edge that faces the agent, at 0.4 of the width to a side.
        label: what it is called where a problem has several loads.
        grasp_direction: from where forearms come to the load.
        grasp_cone: largest angle of a forearm from that direction [rad].
    """

    size: Vector
    mass: float
    center_of_mass: Vector = (0.0, 0.0, 0.0)
    grasp: Grasp = Grasp.POINT
    hand_moment: float = math.inf
    grasp_points: Mapping[tuple[str, str], Vector] = field(default_factory=dict)
    label: str = ""
    grasp_direction: GraspDirection = GraspDirection.FREE
    grasp_cone: float = math.radians(60.0)

    @property
    def inertia(self) -> Inertia:
        """Inertia in the load's frame, that of a uniform box moved to the centre of mass."""
        a, b, c = Box(*self.size).moments(self.mass)
        return Inertia(self.mass, self.center_of_mass, ((a, 0.0, 0.0), (0.0, b, 0.0), (0.0, 0.0, c)))

    def disturbed(self, disturbance: Disturbance) -> Payload:
        """The load as a disturbance makes it."""
        moved = [c + shift for c, shift in zip(self.center_of_mass, disturbance.center_of_mass, strict=True)]
        mass = self.mass * (1.0 + disturbance.mass_share)
        return replace(self, mass=mass, center_of_mass=(moved[0], moved[1], moved[2]))

    def faced(self, agent: Agent) -> Vector:
        """Depth, width and height of the box as an agent sees it, along its own axes [m]."""
        depth, width, height = self.size
        return (width, depth, height) if agent.quarters % 2 else self.size

    def grasp_point(self, agent: Agent, hand: Contact) -> Vector:
        """Grasp point of an agent's hand, from the box's centre, in that agent's frame [m]."""
        given = self.grasp_points.get((agent.name, hand.name))
        if given is not None:
            return agent.from_world(given)
        depth, width, height = self.faced(agent)
        return (-depth / 2.0, 0.4 * width * TO_THE_LEFT[hand.side], height / 2.0)


@dataclass(frozen=True, slots=True)
class StanceLimits:
    """Bounds that keep a posture one that a robot or person would take.

    Args:
        trunk_clearance: least distance of the trunk's frames from the load's near edge, along x [m].
        feet_apart: least and largest sideways distance of the soles' origins [m].
        feet_stagger: largest difference of the soles' origins along x [m].
        foot_yaw: largest turn of a foot against the agent's x [rad].
        base_tilt: largest roll, pitch and yaw of the root link [rad].
        push: largest horizontal force between the agents [N].
        feet_gap: least sideways distance of the soles' edges [m]; None: feet may stand on each other.
    """

    trunk_clearance: float = 0.15
    feet_apart: tuple[float, float] = (0.12, 0.50)
    feet_stagger: float = 0.30
    foot_yaw: float = 0.35
    base_tilt: float = 0.60
    push: float = 5.0
    feet_gap: float | None = None


@dataclass(frozen=True, slots=True)
class Gaze:
    """From where an agent sees the load.

    Args:
        link: its head, which looks along its x.
        place: of the eyes in that link [m].
        cone: largest angle of the load from straight ahead [rad].
    """

    link: str
    place: Vector
    cone: float


@dataclass(frozen=True, slots=True)
class Agent:
    """A robot or person and the parts of it that matter for the task.

    Args:
        name: unique in its scene.
        role: what it is.
        tree: links and joints.
        joints: names of the joints that move; the others are held at zero.
        contacts: with ground and load, in the order of programs.
        trunk: frames that keep clear of the load.
        label: who it is where a problem has several people.
        strengths: of its joints, by name; none for a robot.
        coupled_joints: ranges that several of its joints share.
        rhythms: movements that several of its joints make together; each joint has a part in one at most.
        torque_limits: largest torque [N m] of each joint that moves and has a limit.
        limits_torques: whether these limits hold in every posture.
        collisions: what its bodies keep clear of; None: they may pass through anything.
        gaze: from where it looks at the load; None: it may look anywhere.
        bent_ranges: of joints that stay bent in postures, within their limits [rad], by name.
        measured: what its posture is drawn to; None: torques alone decide.
        stance: limits of its postures; None: those of the scene.
        quarters: quarter turns about z that take its frame to the world.
    """

    name: str
    role: Role
    tree: Tree
    joints: tuple[str, ...]
    contacts: tuple[Contact, ...]
    trunk: tuple[str, ...]
    label: str = ""
    strengths: Mapping[str, JointStrength] = field(default_factory=dict)
    torque_limits: Mapping[str, float] = field(default_factory=dict)
    limits_torques: bool = False
    coupled_joints: tuple[CoupledJoints, ...] = ()
    rhythms: tuple[Rhythm, ...] = ()
    collisions: CollisionRules | None = None
    gaze: Gaze | None = None
    bent_ranges: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    measured: MeasuredPosture | None = None
    stance: StanceLimits | None = None
    quarters: int = 0

    @property
    def feet(self) -> tuple[Contact, ...]:
        """The contacts with the ground."""
        return touching(self.contacts, Touched.GROUND)

    @property
    def hands(self) -> tuple[Contact, ...]:
        """The contacts with the load."""
        return touching(self.contacts, Touched.LOAD)

    @property
    def hand_frames(self) -> tuple[str, ...]:
        """The frames of its hands."""
        return tuple(hand.frame for hand in self.hands)

    @property
    def foot_frames(self) -> tuple[str, ...]:
        """The frames of its soles."""
        return tuple(foot.frame for foot in self.feet)

    def frame(self, contact: str) -> str:
        """The frame of a contact of a name."""
        return next(each.frame for each in self.contacts if each.name == contact)

    @property
    def pushed_frame(self) -> str:
        """The frame that a push on the agent meets: the last of its trunk."""
        return self.trunk[-1]

    @property
    def facing(self) -> float:
        """Rotation about z that takes the agent's frame to the world [rad]."""
        return self.quarters * math.pi / 2.0

    @property
    def turn(self) -> NDArray[np.float64]:
        """That rotation as a matrix, exact."""
        cos, sin = QUARTERS[self.quarters % 4]
        return np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])

    def from_world(self, vector: Vector) -> Vector:
        """A vector of numbers in the agent's frame, from one in the world's."""
        x, y, z = vector
        cos, sin = QUARTERS[self.quarters % 4]
        return (cos * x + sin * y, cos * y - sin * x, z)


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
