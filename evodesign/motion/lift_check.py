"""The independent check of a lift: pinocchio on whole trees, at every knot and between knots.

Every term of a hold finds its residuals anew (`posture.check`), with pinocchio's inverse dynamics (RNEA)
where a hold has gravity alone. At knots they are as small as those of a hold. Between knots, where splines
of torques and wrenches are compared with what the motion takes there, they keep within a share of the
largest ones.

New for a motion: joints within their speed; feet that stay, and rigid hands that do not turn; rest at both
ends; and a balance of energy,

    work of the joint torques = change of the potential and kinetic energy of robot, person and load
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin
import scipy
from numpy.typing import NDArray

from evodesign.mechanics.balance import GRAVITY
from evodesign.mechanics.payload import Grasp
from evodesign.mechanics.scene import Scene
from evodesign.motion.course import LiftCourse
from evodesign.motion.instant import fastest_joints
from evodesign.posture.check import TOLERANCE, AgentModel, Checker, SceneMotion
from evodesign.posture.results import AgentPosture, Instant
from evodesign.posture.symmetry import whole
from evodesign.posture.terms.base import Residual

Array = NDArray[np.float64]

BETWEEN = 4
"""Points between two knots at which a lift is looked at."""

PLACES = {"m": 3e-3, "m or rad": 5e-3, "rad": 5e-3, "1": 5e-3, "m/s": 3e-3, "rad/s": 5e-2}
"""What residuals between knots may be, by unit, that are no forces."""

LEAST_ENERGY = 1.0
"""Energy [J] of lifts that hardly change it, to which their work is compared."""

SHARE = 0.03
"""What residuals of forces and torques between knots may be, as a share of the largest ones."""


def fine_times(course: LiftCourse) -> Array:
    """Of the knots and of the points between them [s]."""
    count = (course.lift.knots - 1) * (BETWEEN + 1) + 1
    return np.linspace(0.0, course.lift.seconds, count)


@dataclass(frozen=True, slots=True)
class CheckedLift:
    """What the check found.

    Args:
        knots: largest residuals at knots, SI units, by name.
        between: those between knots.
        wrong: a sentence about the first that is too large; empty where none is.
        work: of the joint torques [J], by agent name.
        energy: gained by robot, person and load [J].
        powers: of the joint torques at `fine_times` [W], by agent name.
    """

    knots: Mapping[str, float]
    between: Mapping[str, float]
    wrong: str
    work: Mapping[str, float]
    energy: float
    powers: Mapping[str, Array]

    @property
    def energy_error(self) -> float:
        """Of the work, relative to the energy gained."""
        return abs(sum(self.work.values()) - self.energy) / max(abs(self.energy), 1e-9)


class LiftChecker:
    """Checks lifts of one design in a scene.

    Args:
        scene: with its disturbances.
        robot: the design's.
        human: the person.
        terms: the check of holds, of the same models.
    """

    def __init__(self, scene: Scene, robot: AgentModel, human: AgentModel, terms: Checker) -> None:
        self._scene, self._models, self._terms = scene, (robot, human), terms

    def check(self, course: LiftCourse) -> CheckedLift:
        """Residuals, work and energy of a motion."""
        times = fine_times(course)
        instants, motions = course.instants(times), course.motions(times)
        found = [
            self._residuals(*each, course.lift.seconds)
            for each in zip(instants, motions, course.heights(times), strict=True)
        ]
        self._add_slips(instants, found)
        found[0] += _rest(motions[0])
        found[-1] += _rest(motions[-1])
        at_knots = [each for place, each in enumerate(found) if place % (BETWEEN + 1) == 0]
        between = [each for place, each in enumerate(found) if place % (BETWEEN + 1)]
        powers = {
            model.agent.name: np.array(
                [
                    _power(model.agent.joints, i.postures[model.agent.name], m.agents[model.agent.name].rates)
                    for i, m in zip(instants, motions, strict=True)
                ]
            )
            for model in self._models
        }
        work = {name: float(scipy.integrate.simpson(power, x=times)) for name, power in powers.items()}
        begin, end = (self._energy(instants[place], motions[place], course) for place in (0, -1))
        energy = end - begin
        return CheckedLift(
            knots=_largest(at_knots),
            between=_largest(between),
            wrong=_wrong(at_knots, between, instants) or _unbalanced(sum(work.values()), energy),
            work=work,
            energy=energy,
            powers=powers,
        )

    def _residuals(
        self, instant: Instant, motion: SceneMotion, height: float, seconds: float
    ) -> list[Residual]:
        found = [*self._terms.residuals(instant, float(height), motion)]
        for model in self._models:
            name = model.agent.name
            fastest = fastest_joints(whole(model.agent), model.tree)
            speeds = np.abs(motion.agents[name].rates[6:])
            beyond = float(np.max(speeds - np.array(list(fastest.values()), float)))
            found.append(Residual(f"{name}.speed", max(0.0, beyond), "rad/s", "the speed of joints"))
        return found

    def _add_slips(self, instants: Sequence[Instant], found: Sequence[list[Residual]]) -> None:
        """By how much soles are not where they were at the beginning, and rigid hands turned."""
        for model in self._models:
            agent, first = model.agent, None
            for instant, residuals in zip(instants, found, strict=True):
                state = model.at(instant.postures[agent.name])
                poses = [state.pose(foot.frame) for foot in agent.feet]
                here = np.concatenate([np.r_[origin[:2], turn[1, 0]] for turn, origin in poses])
                if self._scene.payload.grasp is Grasp.RIGID:
                    turns = [state.pose(hand.frame)[0].ravel() for hand in agent.hands]
                    here = np.concatenate([here, *turns])
                first = here if first is None else first
                slip = float(np.abs(here - first).max())
                residuals.append(
                    Residual(
                        f"{agent.name}.slip", slip, "m or rad", "the place of a foot or the turn of a hand"
                    )
                )

    def _energy(self, instant: Instant, motion: SceneMotion, course: LiftCourse) -> float:
        """Potential and kinetic energy of robot and person, and of the load, up to a constant [J]."""
        payload, total = self._scene.payload, 0.0
        for model in self._models:
            posture = instant.postures[model.agent.name]
            state = model.at(posture, motion.agents[model.agent.name])
            body = model.body.model
            data = body.createData()
            total += pin.computePotentialEnergy(body, data, state.coordinates)
            total += pin.computeKineticEnergy(body, data, state.coordinates, state.speeds)
        height = float(course.heights([instant.time])[0])
        return float(total + payload.mass * GRAVITY * height)


def _rest(motion: SceneMotion) -> list[Residual]:
    """Speeds at an end."""
    fastest = max(float(np.abs(each.rates).max()) for each in motion.agents.values())
    return [Residual("rest", fastest, "m or rad", "rest at an end")]


def _power(joints: Sequence[str], posture: AgentPosture, rates: Array) -> float:
    """Of an agent's joint torques [W]."""
    return float(sum(posture.torques[name] * rate for name, rate in zip(joints, rates[6:], strict=True)))


def _unbalanced(work: float, energy: float) -> str:
    """A sentence where work is done on nothing."""
    if abs(work - energy) <= SHARE * max(abs(energy), LEAST_ENERGY):
        return ""
    return f"the check found that joints do {work:.4g} J of work for {energy:.4g} J of energy"


def _largest(found: Sequence[Sequence[Residual]]) -> dict[str, float]:
    sizes: dict[str, float] = {}
    for residual in (each for here in found for each in here):
        sizes[residual.name] = max(sizes.get(residual.name, 0.0), residual.size)
    return sizes


def _wrong(
    at_knots: Sequence[Sequence[Residual]], between: Sequence[Sequence[Residual]], instants: Sequence[Instant]
) -> str:
    worst = max((each for here in at_knots for each in here), key=lambda residual: residual.size)
    if not worst.size <= TOLERANCE:
        found = f"the check found {worst.name} {worst.size:.1e} above {TOLERANCE:g}"
        return f"{found} at a knot ({worst.words})"
    postures = [
        posture
        for instant in instants
        for load_case in (instant.postures, *instant.disturbed.values())
        for posture in load_case.values()
    ]
    torque = max(posture.torque_norm for posture in postures)
    wrenches = [wrench for posture in postures for wrench in posture.wrenches.values()]
    force = max(float(np.abs(wrench[:3]).max()) for wrench in wrenches)
    allowed = {**PLACES, "N m": SHARE * torque, "N": SHARE * force}
    excess = [(each.size / allowed[each.unit], each) for here in between for each in here]
    share, worst = max(excess, key=lambda pair: pair[0], default=(0.0, worst))
    if share <= 1.0:
        return ""
    most = f"{worst.size:.2g} {worst.unit} above {allowed[worst.unit]:.2g}"
    return f"between knots the check found {worst.name} {most} ({worst.words}); more knots may do"
