"""Sentences on where a design's results stop moving smoothly.

A solution is one of several local optima, held by some of its limits. Its derivative holds as long as the
same optimum wins and the same limits hold; what is said here is how far that is.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from evodesign.nlp.optimality import NotDifferentiable
from evodesign.nlp.sensitivity import Limit
from evodesign.posture.results import HeightSolution
from evodesign.posture.solution_derivative import PostureDerivative, ReachDerivative
from evodesign.problem.build import Problem
from evodesign.records import Status

__all__ = ["posture_notes", "reach_notes"]

NEAR = 0.01
"""Share of a parameter's range within which a change of limits gets a sentence."""

DISTINCT = 1e-5
"""Relative difference of costs above which two optima are not the same."""


def posture_notes(
    problem: Problem, height: HeightSolution, derivative: PostureDerivative | NotDifferentiable
) -> Iterator[str]:
    """What is to be said of the posture at one height that was solved."""
    label = problem.scenes[height.scene].label
    place = f"at {height.height:g} m" + (f", {label}" if label else "")
    yield f"{place}: {_winner(height, derivative)}"
    if isinstance(derivative, NotDifferentiable):
        yield f"{place}: no gradient, for {derivative.reason}"
    else:
        yield from _near(problem, place, derivative.limits)


def reach_notes(
    problem: Problem, which: str, derivative: ReachDerivative | NotDifferentiable
) -> Iterator[str]:
    """What is to be said of the highest or the lowest load."""
    place = f"{which} load"
    if isinstance(derivative, NotDifferentiable):
        yield f"{place}: no gradient, for {derivative.reason}"
        return
    other = (
        "the starts agree"
        if derivative.runner_up is None
        else f"the next best is {derivative.runner_up:.2g} m off"
    )
    yield f"{place}: start {derivative.start + 1} of {derivative.starts} won, {other}"
    yield from _near(problem, place, derivative.limits)


def _winner(height: HeightSolution, derivative: PostureDerivative | NotDifferentiable) -> str:
    """Which start won, and how far behind the next best optimum of the same program is."""
    best = height.attempt
    won = f"{best.name if best else 'no start'} won"
    if best is None or isinstance(derivative, NotDifferentiable):
        return won
    others = [a for a in height.attempts if a.formulation == best.formulation and a.start != best.start]
    behind = [a.cost / derivative.compared - 1.0 for a in others if a.status is Status.SOLVED]
    distinct = [share for share in behind if share > DISTINCT]
    if not others:
        return f"{won}, the only start"
    return (
        f"{won}, the next best optimum costs {min(distinct):.2%} more"
        if distinct
        else f"{won}, no other was met"
    )


def _near(problem: Problem, place: str, limits: Sequence[Limit]) -> Iterator[str]:
    """The change of limits that the least change of one parameter brings about, if it is near."""
    parameters = problem.space.parameters
    ranges = np.array([parameter.upper - parameter.lower for parameter in parameters])
    nearest, which, where = np.inf, None, 0
    for limit in limits:
        with np.errstate(divide="ignore"):
            shares = limit.margin / np.abs(limit.slope * ranges)
        position = int(np.argmin(shares))
        if shares[position] < nearest:
            nearest, which, where = float(shares[position]), limit, position
    if which is not None and nearest < NEAR:
        verb = "leaves" if which.active else "reaches"
        toward = "less" if which.slope[where] > 0.0 else "more"
        much = f"{nearest * ranges[where]:.2g} {toward} {parameters[where].name}"
        yield f"{place}: {which.name} {verb} its limit with {much} ({nearest:.1%} of its range)"
