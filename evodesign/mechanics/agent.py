"""Agents: robots and people, with the parts of them that matter for the task.

Each agent has a frame of its own, the world turned about z by quarter turns so that the agent looks along +x
at the load.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from evodesign.body.placement import Vector
from evodesign.collision.rules import CollisionRules
from evodesign.human.coupled_joints import CoupledJoints, Rhythm
from evodesign.human.measured_posture import MeasuredPosture
from evodesign.human.strength import JointStrength
from evodesign.mechanics.contact import SoleSize
from evodesign.tree.model import Tree

ROBOT, HUMAN = "robot", "human"
"""Names of the first robot and the first person; those of others begin with them."""

SIDES = ("left", "right")

BASE = "base"
"""Name of the contact on which a robot without feet stands."""

TO_THE_LEFT = {"left": 1.0, "right": -1.0, "": 0.0}
"""The direction along y of a side."""

QUARTERS = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))
"""Cosine and sine of no, one, two and three quarter turns."""


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
        name: unique in its agent, such as `left_hand` or `base`.
        touched: what it touches.
        frame: of the agent; on the ground its z is the ground's normal.
        side: `left` or `right` of a pair of mirror images; empty on the middle line.
        patch: on which it stands on the ground; None: a hand.
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
        chosen_ranges: widest limits of joints whose own limits a design chooses [rad], by name.
        measured: what its posture is drawn to; None: torques alone decide.
        stance: limits of its postures; None: those of the scene.
        quarters: quarter turns about z that take its frame to the world.
        as_drawn: whether it stays as its file has it, whatever a design changes of robots.
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
    chosen_ranges: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    measured: MeasuredPosture | None = None
    stance: StanceLimits | None = None
    quarters: int = 0
    as_drawn: bool = False

    @property
    def designed(self) -> bool:
        """Whether designs change it."""
        return self.role is Role.ROBOT and not self.as_drawn

    @property
    def feet(self) -> tuple[Contact, ...]:
        """The contacts with the ground."""
        return touching(self.contacts, Touched.GROUND)

    @property
    def hands(self) -> tuple[Contact, ...]:
        """The contacts with the load."""
        return touching(self.contacts, Touched.LOAD)

    @property
    def on_feet(self) -> bool:
        """Whether it stands on a left and a right foot, and on no wheels."""
        return len(self.feet) == len(SIDES)

    @property
    def hand_frames(self) -> tuple[str, ...]:
        """The frames of its hands."""
        return tuple(hand.frame for hand in self.hands)

    @property
    def foot_frames(self) -> tuple[str, ...]:
        """The frames of its soles."""
        return tuple(foot.frame for foot in self.feet)

    def mirrored(self, contact: Contact) -> Contact | None:
        """The contact of the other side that touches the same; None of one that has none."""
        alike = touching(self.contacts, contact.touched)
        other = {"left": "right", "right": "left"}.get(contact.side)
        return next((each for each in alike if each.side == other), None)

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

    def to_world(self, vector: Vector) -> Vector:
        """A vector of numbers in the world's frame, from one in the agent's."""
        x, y, z = vector
        cos, sin = QUARTERS[self.quarters % 4]
        return (cos * x - sin * y, sin * x + cos * y, z)

    def from_world(self, vector: Vector) -> Vector:
        """A vector of numbers in the agent's frame, from one in the world's."""
        x, y, z = vector
        cos, sin = QUARTERS[self.quarters % 4]
        return (cos * x + sin * y, cos * y - sin * x, z)
