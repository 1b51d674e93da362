"""Agents walk with the load between them: what each is to do at every moment.

All swing their feet at the same moments, those on the same side of the way together. Each body, from where
it stands (`stance`), moves as an inverted pendulum (`pendulum`) whose pressure point goes from foot to foot;
hands and load move as the bodies do in the mean, and the hands' forces accelerate the load.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from evodesign.control.controller import HandShare
from evodesign.control.footsteps import Gait, progress, swing
from evodesign.control.limits import JointLimits
from evodesign.control.moving_body import MovingBody
from evodesign.control.pendulum import PendulumCourse, pendulum_course
from evodesign.control.stance import ReadyStance, ready_stance
from evodesign.control.target import Course, Target
from evodesign.mechanics.agent import Agent
from evodesign.mechanics.balance import GRAVITY

Array = NDArray[np.float64]

BEFORE, AFTER = 2.0, 2.0
"""From the beginning to the first swing, and from rest above both feet to the end, in times of a step."""

PASSING = math.cos(math.pi / 4.0)
"""Feet pass each other where the way is within 45 degrees of forwards or backwards."""


@dataclass(frozen=True, slots=True)
class Way:
    """Where all walk.

    Args:
        distance: [m].
        direction: in the world, from x to y [rad].
    """

    distance: float
    direction: float

    @property
    def along(self) -> Array:
        """Its direction, shape (2,)."""
        return np.array([math.cos(self.direction), math.sin(self.direction)])


@dataclass(frozen=True, slots=True)
class Footstep:
    """A swing of a foot.

    Args:
        foot: its place among the agent's feet.
        begin: moment [s].
        start: of the sole on the floor [m], shape (3,).
        end: likewise.
    """

    foot: int
    begin: float
    start: Array
    end: Array


@dataclass(frozen=True, slots=True, eq=False)
class Walker:
    """An agent's part.

    Args:
        agent: who walks.
        stance: before the first step.
        gait: of all.
        steps: in their order.
        pendulum: of the agent.
    """

    agent: Agent
    stance: ReadyStance
    gait: Gait
    steps: tuple[Footstep, ...]
    pendulum: PendulumCourse

    @classmethod
    def of(cls, body: MovingBody, own: ReadyStance, gait: Gait, way: Way, *, passing: bool) -> Walker:
        """The part of an agent that stands ready.

        Args:
            body: of the agent.
            own: how it stands.
            gait: of all.
            way: of all.
            passing: whether feet pass each other.
        """
        feet = [foot.place for foot in body.at(own.target.coordinates, own.target.velocity).feet]
        first = [np.array([*place[:2], 0.0]) for place in feet]
        aside = np.array([-way.along[1], way.along[0]])
        leading = aside if passing else way.along
        order = sorted(range(len(first)), key=lambda foot: -float(first[foot][:2] @ leading))
        places, steps, now = list(first), [], BEFORE * gait.seconds
        times, pressures = [0.0, now / 2.0, now], [own.pressure, own.pressure]
        for number, far in enumerate(progress(way.distance, gait.length, passing=passing)):
            foot, other = order[number % 2], order[1 - number % 2]
            if number:
                times.append(times[-1] + gait.shifting)
            end = first[foot] + np.append(far * way.along, 0.0)
            steps.append(Footstep(foot, times[-1], places[foot], end))
            times.append(times[-1] + gait.swinging)
            pressures += [places[other][:2]] * 2
            places[foot] = end
        last = own.pressure + way.distance * way.along
        times += [times[-1] + gait.shifting, times[-1] + gait.shifting + AFTER * gait.seconds]
        rate = math.sqrt(GRAVITY / own.pendulum)
        course = pendulum_course(rate, times, np.array([*pressures, last, last]))
        return cls(body.agent, own, gait, tuple(steps), course)

    @property
    def seconds(self) -> float:
        """Of the whole walk [s]."""
        return float(self.pendulum.times[-1])

    def moved(self, time: float) -> tuple[Array, Array, Array]:
        """How far the body is from where it stood [m], with velocity and acceleration, shape (3,) each."""
        center, velocity, acceleration, _ = self.pendulum.at(time)
        return _level(center - self.stance.pressure), _level(velocity), _level(acceleration)

    def target(self, time: float, load: tuple[Array, Array, Array], share: HandShare | None) -> Target:
        """What the agent is to do.

        Args:
            time: since the beginning [s].
            load: how far it is from where it was [m], with velocity and acceleration, shape (3,) each.
            share: of each hand.
        """
        target, (off, velocity, acceleration) = self.stance.target, self.moved(time)
        coordinates, hand_wrenches = target.coordinates.copy(), target.hand_wrenches.copy()
        coordinates[:3] += off
        if share is not None:
            hand_wrenches[:, :3] -= share.mass * load[2]
        center = replace(
            target.center, place=target.center.place + off, velocity=velocity, acceleration=acceleration
        )
        places, swings = self._feet(time)
        return replace(
            target,
            coordinates=coordinates,
            center=center,
            hands=tuple(_along(hand, load) for hand in target.hands),
            feet_wrenches=self._carried(time, places, list(swings)),
            hand_wrenches=hand_wrenches,
            swings=swings,
        )

    def _feet(self, time: float) -> tuple[list[Array], dict[int, Course]]:
        """Where soles stand or last stood [m], and the courses of those that swing."""
        places = {step.foot: step.start for step in reversed(self.steps)}
        swings = {}
        for step in self.steps:
            since = time - step.begin
            if since >= self.gait.swinging:
                places[step.foot] = step.end
            elif since >= 0.0:
                moved = swing(step.start, step.end, self.gait, since)
                place, velocity, acceleration = moved
                still = np.zeros(3)
                swings[step.foot] = Course(
                    self.agent.turn, place, np.append(velocity, still), np.append(acceleration, still)
                )
        return [places[foot] for foot in range(len(places))], swings

    def _carried(self, time: float, places: Sequence[Array], swinging: Sequence[int]) -> Array:
        """Wrenches of the feet, shape (feet, 6): they share the weight as the pressure point asks."""
        pressure = self.pendulum.at(time)[3]
        first, second = (place[:2] for place in places)
        between = second - first
        share = float(np.clip((pressure - first) @ between / (between @ between), 0.0, 1.0))
        shares = np.array([1.0 - share, share])
        shares[list(swinging)] = 0.0
        return np.asarray(2.0 * shares[:, None] * self.stance.target.feet_wrenches)


@dataclass(frozen=True, slots=True, eq=False)
class Walk:
    """All who walk with the load.

    Args:
        way: of all.
        walkers: by agent name.
        gait: of all.
        share: of each hand.
    """

    way: Way
    walkers: Mapping[str, Walker]
    gait: Gait
    share: HandShare | None

    @property
    def seconds(self) -> float:
        """Until everybody stands again [s]."""
        return max(walker.seconds for walker in self.walkers.values())

    @property
    def steps(self) -> int:
        """Of each agent."""
        return max(len(walker.steps) for walker in self.walkers.values())

    @property
    def reason(self) -> str:
        """Why somebody cannot walk; empty where all can."""
        return next((each.stance.reason for each in self.walkers.values() if each.stance.reason), "")

    def load(self, time: float) -> tuple[Array, Array, Array]:
        """How far the load is from where it was [m], with velocity and acceleration, shape (3,) each."""
        moved = [walker.moved(time) for walker in self.walkers.values()]
        place, velocity, acceleration = (np.mean(each, axis=0) for each in zip(*moved, strict=True))
        return place, velocity, acceleration

    def targets(self, time: float) -> dict[str, Target]:
        """What everybody is to do at a time [s], by name."""
        load = self.load(time)
        return {name: walker.target(time, load, self.share) for name, walker in self.walkers.items()}


def walk_of(
    bodies: Sequence[MovingBody],
    holds: Mapping[str, Target],
    limits: Mapping[str, JointLimits],
    share: HandShare | None,
    way: Way,
) -> Walk:
    """The walk of all who hold the load.

    Args:
        bodies: of those on feet.
        holds: of the plan, by agent name.
        limits: of the joints, likewise.
        share: of each hand.
        way: of all.
    """
    legs = [leg for body in bodies for leg in body.legs(holds[body.agent.name].coordinates)]
    gait = Gait.of(min(leg.height for leg in legs))
    passing = all(abs(body.agent.turn[:2, 0] @ way.along) > PASSING - 1e-9 for body in bodies)
    walkers = {}
    for body in bodies:
        name = body.agent.name
        own = ready_stance(body, holds[name], limits[name], gait.length * way.along)
        walkers[name] = Walker.of(body, own, gait, way, passing=passing)
    return Walk(way, walkers, gait, share)


def _level(vector: Array) -> Array:
    return np.append(vector, 0.0)


def _along(hand: Course, load: tuple[Array, Array, Array]) -> Course:
    off, velocity, acceleration = load
    return Course(
        hand.turn, hand.place + off, np.append(velocity, np.zeros(3)), np.append(acceleration, np.zeros(3))
    )
