"""Lifts, and holds and lifts in MuJoCo, from a notebook."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from evodesign.api.problem import Problem
from evodesign.errors import InputError
from evodesign.motion.solution import LiftSolution
from evodesign.simulation.installed import refuse_without_mujoco
from evodesign.tasks.lift import Lift, profile_named

if TYPE_CHECKING:
    from evodesign.evaluation.simulations import SimulatedCase


def simulate(
    problem: Problem,
    design: Mapping[str, float] | Sequence[float] = (),
    *,
    heights_m: Sequence[float] = (),
    from_m: float | None = None,
    to_m: float | None = None,
    seconds: float | None = None,
    profile: str = "minimum_jerk",
    knots: int = 24,
    frequency: float = 8.0,
    damping: float = 1.0,
) -> tuple[SimulatedCase, ...]:
    """A design's holds and lifts, or with `from_m` and `to_m` another lift, in MuJoCo with everyone.

    Args:
        problem: opened.
        design: as for `Problem.evaluate`; left out, the unscaled robot.
        heights_m: of the holds, each one of the problem's [m]; left out, all of them.
        from_m: height of the load at the beginning of a lift [m].
        to_m: at its end [m].
        seconds: of a hold or lift [s]; left out, 2 for a hold and 1.5 for a lift.
        profile: of a lift, as for `lift`.
        knots: of a lift.
        frequency: natural frequency of the joints' feedback [rad/s].
        damping: its damping ratio [1].
    Returns:
        Plan, rollout and outcome of every hold or lift that was found.
    Raises:
        InputError: a design, height or lift that there is not, or MuJoCo is not installed.
    Example:
        >>> simulated = evodesign.simulate(problem, heights_m=[0.8], seconds=0.3)
        >>> [(each.name, each.outcome.stands, each.outcome.drift < 0.01) for each in simulated]
        [('short, 0.8 m', True, True), ('tall, 0.8 m', True, True)]
    """
    refuse_without_mujoco()
    from evodesign.control.gains import Feedback
    from evodesign.evaluation.simulations import (
        HOLD_SECONDS,
        lifts_among,
        picked_holds,
        simulated_holds,
        simulated_lifts,
    )

    if (from_m is None) != (to_m is None):
        raise InputError("simulate", "from_m", "both from_m and to_m, or neither", "one of them")
    given: Any = design if len(design) else {}
    values, feedback = problem.values(given), Feedback(frequency, damping)
    found = problem._evaluator.assess_values(values)
    built, space = problem.built, problem.built.space
    robot = space.resized(built.scene.designed_tree, space.given(values, found.assessment.rated_torques))
    if from_m is None or to_m is None:
        holds = picked_holds(found.cases, heights_m)
        time = HOLD_SECONDS if seconds is None else seconds
        done = [*simulated_holds(built.scenes, robot, holds, time, feedback)]
        lifts = lifts_among(built.tasks, heights_m, knots)
    else:
        done = []
        lifts = [Lift(from_m, to_m, 1.5 if seconds is None else seconds, profile_named(profile), knots)]
    for lift in lifts:
        done += simulated_lifts(built.scenes, robot, problem._lifted(values, lift), feedback)
    return tuple(done)


def lift(
    problem: Problem,
    design: Mapping[str, float] | Sequence[float] = (),
    *,
    from_m: float,
    to_m: float,
    seconds: float = 1.5,
    profile: str = "minimum_jerk",
    knots: int = 12,
) -> dict[tuple[str, str], LiftSolution]:
    """A design and each person lift each load straight up or down, from rest to rest.

    Args:
        problem: opened.
        design: as for `Problem.evaluate`; left out, the unscaled robot.
        from_m: height of the load's centre at the beginning [m].
        to_m: at the end [m].
        seconds: that the lift takes [s].
        profile: `minimum_jerk`, or `free`: the load goes as suits the torques, between both heights.
        knots: of the motion's splines.
    Returns:
        The motion, what it takes of both agents, and what the check found, or why there is none; by the
        names of person and load.
    Raises:
        InputError: a design or a lift that there is not.
    Example:
        >>> lifts = evodesign.lift(problem, from_m=0.9, to_m=2.5)
        >>> lifts["tall", ""].reason
        'the load cannot be held at the end of the lift: ...'
    """
    asked = Lift(from_m, to_m, seconds, profile_named(profile), knots)
    given: Any = design if len(design) else {}
    return problem._lifted(problem.values(given), asked)
