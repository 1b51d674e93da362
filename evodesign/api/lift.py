"""A lift in a notebook."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from evodesign.api.problem import Problem
from evodesign.motion.solution import LiftSolution
from evodesign.tasks.lift import Lift, profile_named


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
