"""Pushes on a design's robot: in its holds and lifts, with all who hold the load, or alone."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from evodesign.errors import InputError
from evodesign.evaluation.logged_posture import logged_posture
from evodesign.mechanics.agent import ROBOT
from evodesign.mechanics.scene import Scene, scene_of
from evodesign.motion.solution import LiftSolution
from evodesign.records import CaseDetail
from evodesign.simulation.push import Push, PushOutcome, PushTest
from evodesign.simulation.push_margin import Margin, margin_in, margins
from evodesign.simulation.pushed_plan import PushConditions, alone_test, hold_test, lift_tests
from evodesign.tree.model import Tree

PERTURBED = {"friction": 0.8, "mass": 1.05, "delay": 1}
"""What may be otherwise: friction and the load's mass by these factors, sensors late by so many answers."""


@dataclass(frozen=True, slots=True)
class PushedDesign:
    """Where a robot of a design is pushed.

    Args:
        scenes: of the problem.
        robot: the design's tree.
        holds: of the design, with their postures.
        lifts: of the design, by person and load.
        alone: whether the robot stands alone, in the postures of its holds.
    """

    scenes: Sequence[Scene]
    robot: Tree
    holds: Sequence[CaseDetail]
    lifts: Sequence[tuple[tuple[str, str], LiftSolution]] = ()
    alone: bool = False

    def tests(self, conditions: PushConditions) -> dict[str, PushTest]:
        """Of every moment, by its name.

        Raises:
            InputError: there is none, or a scene without a robot on feet.
        """
        found: dict[str, PushTest] = {}
        for name, scene, detail in self._holds():
            postures = {agent: logged_posture(own) for agent, own in detail.agents.items()}
            trees = self._trees(scene)
            found[name] = (
                alone_test(scene, trees, postures, conditions)
                if self.alone
                else hold_test(scene, trees, postures, detail.height_m, conditions)
            )
        for pair, solution in () if self.alone else self.lifts:
            scene = self._scene(pair)
            if solution.course is not None:
                tests = lift_tests(scene, self._trees(scene), solution.course, conditions)
                label = ", ".join([*(part for part in pair if part), f"{solution.lift}"])
                found |= {f"{label}, after {time:.2g} s": test for time, test in tests.items()}
        if not found:
            raise InputError("push", "", "a hold or a lift that was found", "none")
        return found

    def mass(self) -> float:
        """Of the robot [kg]."""
        return float(self.robot.mass)

    def _holds(self) -> Iterator[tuple[str, Scene, CaseDetail]]:
        for detail in self.holds:
            yield detail.case.name, self._scene(detail.case.pair), detail

    def _scene(self, pair: tuple[str, str]) -> Scene:
        scene = scene_of(self.scenes, pair).undisturbed
        if not scene.robots:
            raise InputError("push", "", "a robot in the problem", "people alone")
        wheeled = next((agent.name for agent in scene.agents if not agent.on_feet), None)
        if wheeled is not None:
            raise InputError("push", "", "agents on two feet", f"'{wheeled}', which stands on something else")
        return scene

    def _trees(self, scene: Scene) -> dict[str, Tree]:
        return {each.name: self.robot if each.designed else each.tree for each in scene.agents}


@dataclass(frozen=True, slots=True)
class FoundMargins:
    """What a design's robot survives.

    Args:
        margins: in every direction at every moment.
        spread: by how much the least of them changes under each perturbation [N s]; empty unless asked for.
    """

    margins: tuple[Margin, ...]
    spread: Mapping[str, float]

    @property
    def least(self) -> Margin:
        """The smallest."""
        return min(self.margins, key=lambda margin: margin.impulse)


def found_margins(
    pushed: PushedDesign, conditions: PushConditions, directions: Sequence[float], *, spread: bool
) -> FoundMargins:
    """The margins of a design.

    Args:
        pushed: where.
        conditions: of everything else.
        directions: from forwards to the left [rad].
        spread: whether the least margin is found again under each perturbation.
    """
    tests = pushed.tests(conditions)
    found = FoundMargins(margins(tests, ROBOT, pushed.mass(), directions), {})
    return replace(found, spread=_spread(pushed, conditions, found.least)) if spread else found


def _spread(pushed: PushedDesign, conditions: PushConditions, least: Margin) -> dict[str, float]:
    late = replace(conditions.timing, delay=conditions.timing.delay + int(PERTURBED["delay"]))
    others = {
        "friction": replace(conditions, friction=PERTURBED["friction"]),
        "load mass": replace(conditions, mass=PERTURBED["mass"]),
        "sensor delay": replace(conditions, timing=late),
    }
    push = Push(0.0, least.direction)
    return {
        name: margin_in(pushed.tests(other)[least.moment], least.moment, push, pushed.mass()).impulse
        - least.impulse
        for name, other in others.items()
    }


def margins_json(found: FoundMargins, conditions: PushConditions) -> dict[str, Any]:
    """What the table of margins shows, in SI units and degrees."""
    return {
        "feedback": {
            "frequency_rad_s": conditions.feedback.frequency,
            "damping_ratio": conditions.feedback.damping,
        },
        "push_margin_n_s": found.least.impulse,
        "margins": [
            {
                "moment": each.moment,
                "direction_deg": float(np.degrees(each.direction)),
                "margin_n_s": each.impulse,
                "reason": each.reason,
                "trials": each.trials,
            }
            for each in found.margins
        ],
        "spread_n_s": dict(found.spread),
    }


def outcome_json(moment: str, outcome: PushOutcome) -> dict[str, Any]:
    """What came of one push, in SI units and degrees."""
    return {
        "moment": moment,
        "impulse_n_s": outcome.push.impulse,
        "direction_deg": float(np.degrees(outcome.push.direction)),
        "survived": outcome.survived,
        "reason": outcome.reason,
        "seconds": outcome.seconds,
        "recovery_s": outcome.recovery,
        "load_off_m": outcome.load_off,
        "torque_saturation": outcome.saturation,
        "capture_point_m": outcome.capture,
    }
