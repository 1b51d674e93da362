"""Pushes on a design's robot: in its holds and lifts, with all who hold the load, or alone."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from evodesign.evaluation.logged_posture import logged_posture
from evodesign.mechanics.agent import ROBOT
from evodesign.mechanics.scene import Scene
from evodesign.motion.solution import MotionCase
from evodesign.problem.build import DesignProblem
from evodesign.quantities.design_result import DesignResult
from evodesign.quantities.push_quantities import (
    ALONE,
    MARGIN,
    RECOVERY,
    SATURATION,
    TRACKING,
    FoundPushes,
    PushSettings,
)
from evodesign.records import CaseDetail
from evodesign.simulation.push import Push, PushOutcome
from evodesign.simulation.push_margin import Margin, different_directions, least_margin, margin_in, margins
from evodesign.simulation.pushed_plan import PushConditions, PushedDesign, PushedPlan, pushed_cases
from evodesign.tree.model import Tree

PERTURBED = {"friction": 0.8, "mass": 1.05, "delay": 1}
"""What may be otherwise: friction and the load's mass by these factors, sensors late by so many answers."""


def pushed_holds(scenes: Sequence[Scene], robot: Tree, holds: Sequence[CaseDetail]) -> list[PushedPlan]:
    """Holds of the log in which a robot is pushed.

    Args:
        scenes: of the problem.
        robot: the design's tree.
        holds: of the design, with their postures.
    """
    return [
        PushedPlan.hold(
            scenes,
            robot,
            detail.case,
            {name: logged_posture(own) for name, own in detail.agents.items()},
            detail.height_m,
        )
        for detail in holds
    ]


def pushed_design(result: DesignResult) -> PushedDesign:
    """Where the robot of an evaluated design is pushed, all of whose cases are solved."""
    plans, pushed = [], pushed_cases([solution.case for solution in result.cases])
    for solution in result.cases:
        case, scenes, robot = solution.case, result.scenes, result.tree
        if case not in pushed:
            continue
        if isinstance(solution, MotionCase) and solution.motion and solution.motion.course:
            plans.append(PushedPlan.lift(scenes, robot, case, solution.motion.course))
        else:
            plans.append(PushedPlan.hold(scenes, robot, case, solution.postures, case.task.heights[0]))
    return PushedDesign(tuple(plans))


def found_pushes(result: DesignResult, settings: PushSettings, problem: DesignProblem) -> FoundPushes:
    """What simulations say of an evaluated design, all of whose cases are solved.

    Args:
        result: of the design.
        settings: of pushes.
        problem: whose quantities ask for them.
    """
    together = pushed_design(result)
    names = {*(each.name for each in problem.objectives), *(each.name for each in problem.constraints)}
    conditions = PushConditions(settings.feedback)
    margin = alone = None
    outcomes: tuple[PushOutcome, ...] = ()
    if MARGIN in names:
        margin = least_margin(together.tests(conditions), ROBOT, together.mass)
    if ALONE in names:
        alone = least_margin(replace(together, alone=True).tests(conditions), ROBOT, together.mass)
    if not {TRACKING, SATURATION, RECOVERY}.isdisjoint(names):
        outcomes = tuple(
            test.pushed(Push(settings.impulse, direction))
            for test in together.tests(conditions).values()
            for direction in dict.fromkeys(different_directions(test).values())
        )
    return FoundPushes(margin, alone, outcomes)


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
    found = FoundMargins(margins(tests, ROBOT, pushed.mass, directions), {})
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
        name: margin_in(pushed.tests(other)[least.moment], least.moment, push, pushed.mass).impulse
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
