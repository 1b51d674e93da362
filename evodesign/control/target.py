"""What a controller is to do at a moment: the plan's places, velocities and accelerations, and its wrenches.

A hold stays what it is. Those of a lift are sampled at the controller's moments from its splines.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from evodesign.control.moving_body import FrameMotion, MovingBody
from evodesign.mechanics.floating_base import ROOT
from evodesign.motion.course import LiftCourse
from evodesign.posture.check import AgentMotion
from evodesign.posture.results import AgentPosture

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Course:
    """Where a point or frame shall be, in the world.

    Args:
        turn: rotation, shape (3, 3).
        place: [m], shape (3,).
        velocity: [m/s, rad/s], shape (3,) of a point, (6,) of a frame.
        acceleration: its derivative.
    """

    turn: Array
    place: Array
    velocity: Array
    acceleration: Array

    @classmethod
    def of(cls, frame: FrameMotion, change: Array) -> Course:
        """That of a motion.

        Args:
            frame: how it moves.
            change: of the body's velocities, shape (v,).
        """
        return cls(frame.turn, frame.place, frame.velocity, frame.jacobian @ change + frame.drift)


@dataclass(frozen=True, slots=True, eq=False)
class Target:
    """An agent's part of a plan at a moment; v velocities in pinocchio's order.

    Args:
        coordinates: pinocchio's configuration.
        velocity: shape (v,).
        acceleration: likewise.
        center: of mass.
        trunk: of the frame that pushes meet.
        hands: of the agent, in its order.
        feet_wrenches: on the feet in their sole frames, shape (feet, 6).
        hand_wrenches: on the hands in world axes, about the grasp points, shape (hands, 6).
        swings: of the soles that do not stand, by their place among the agent's feet.
    """

    coordinates: Array
    velocity: Array
    acceleration: Array
    center: Course
    trunk: Course
    hands: tuple[Course, ...]
    feet_wrenches: Array
    hand_wrenches: Array
    swings: Mapping[int, Course] = field(default_factory=dict)

    @property
    def stance(self) -> tuple[int, ...]:
        """The feet that stand, by their place among the agent's."""
        return tuple(foot for foot in range(len(self.feet_wrenches)) if foot not in self.swings)


def target_of(body: MovingBody, posture: AgentPosture, motion: AgentMotion | None = None) -> Target:
    """The target at a moment of a plan.

    Args:
        body: of the agent.
        posture: with torques and wrenches.
        motion: of the agent; None at rest.
    """
    agent, v, a = body.agent, np.zeros(body.size), np.zeros(body.size)
    if motion is not None:
        for own, planned in zip((v, a), motion.velocities(posture.base_angles), strict=True):
            own[:ROOT], own[body.rates] = planned[:ROOT], planned[ROOT:]
    q = body.posed(posture.base_position, posture.base_angles, posture.joints)
    moved = body.at(q, v)
    turned = np.kron(np.eye(2), agent.turn)
    hands = [turned @ posture.wrenches[hand.name] for hand in agent.hands]
    return Target(
        coordinates=q,
        velocity=v,
        acceleration=a,
        center=Course.of(moved.center, a),
        trunk=Course.of(moved.trunk, a),
        hands=tuple(Course.of(hand, a) for hand in moved.hands),
        feet_wrenches=np.array([posture.wrenches[foot.name] for foot in agent.feet]),
        hand_wrenches=np.array(hands).reshape(-1, 6),
    )


def lift_targets(bodies: Sequence[MovingBody], course: LiftCourse, times: Array) -> dict[str, list[Target]]:
    """Targets of a lift at each of some times [s], by agent name."""
    moments = list(zip(course.instants(times), course.motions(times), strict=True))
    return {
        body.agent.name: [
            target_of(body, instant.postures[body.agent.name], motion.agents[body.agent.name])
            for instant, motion in moments
        ]
        for body in bodies
    }
