"""How the sizes of actuators move with a design.

A size s_g = m_g D_g(p) depends on all that programs are given, p: the other parameters and all sizes. With
dD = D_p dp from the tangent of the posture that asks most of the group,

    (1 - m D_s) ds = m D_o do + D dm

for the other parameters o and the margins m. A size at its bound stays there.

Source: implicit function theorem.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from evodesign.evaluation.sizing import BOUNDS
from evodesign.mechanics.agent import ROBOT
from evodesign.mechanics.robot_gradient import RobotGradient
from evodesign.motion.derivative import LiftDerivative
from evodesign.nlp.optimality import Array, NotDifferentiable
from evodesign.nlp.sensitivity import Limit, LimitTable
from evodesign.posture.solution_derivative import PostureDerivative, ReachDerivative
from evodesign.quantities.demand import Demand
from evodesign.quantities.design_result import DesignResult

CaseDerivative = PostureDerivative | LiftDerivative
"""Of a load held still, or of a lift."""


def program_slopes(
    result: DesignResult,
    cases: Sequence[CaseDerivative | NotDifferentiable],
    robot: RobotGradient | None,
) -> Array | NotDifferentiable | None:
    """The derivatives of what programs are given, by the design's parameters, shape (parameters, parameters).

    Args:
        result: of a design.
        cases: tangents of its postures by what programs are given, one per case.
        robot: derivatives of what depends on it alone; None without one.
    Returns:
        None where no actuator is sized: then both are the same.
    """
    if not result.rated or result.standing is None or robot is None:
        return None
    as_given, demand = replace(result, values=result.rated), result.demand
    if demand is None:
        return NotDifferentiable("its actuators have no sizes")
    missing = [each for each in cases if isinstance(each, NotDifferentiable)]
    if missing:
        return missing[0]
    tangents = [each for each in cases if isinstance(each, PostureDerivative)]
    count, places = len(result.values), result.space.margins
    by_given, by_margin = np.zeros((len(places), count)), np.zeros(len(places))
    for row, place in enumerate(places):
        asked = float(np.abs(demand.torques[:, list(demand.members[row])]).max(initial=0.0))
        if not BOUNDS[0] < result.values[place] * asked < BOUNDS[1]:
            continue
        by_margin[row] = asked
        by_given[row] = result.values[place] * _slope(as_given, robot, demand, row, tangents)
    others = [place for place in range(count) if place not in places]
    slopes = np.eye(count)
    held = np.eye(len(places)) - by_given[:, list(places)]
    slopes[np.ix_(places, others)] = np.linalg.solve(held, by_given[:, others])
    slopes[np.ix_(places, places)] = np.linalg.solve(held, np.diag(by_margin))
    return slopes


def _slope(
    result: DesignResult,
    robot: RobotGradient,
    demand: Demand,
    row: int,
    cases: Sequence[PostureDerivative],
) -> Array:
    """Of what is asked of a group, by what programs are given."""
    columns = np.array(demand.members[row])
    torques = np.abs(demand.torques[:, columns])
    case, column = np.unravel_index(int(np.argmax(torques)), torques.shape)
    joint = demand.joints[int(columns[column])]
    sign = float(np.sign(demand.torques[case, columns[column]]))
    lifted = list(_places(result))
    if case < len(lifted):
        number, instant, load_case = lifted[case]
        return cases[number].along_torques(instant, load_case, {ROBOT: {joint: sign}})
    number = int(case) - len(lifted)
    alone, asked = demand.alone[number], abs(float(demand.torques[case, columns[column]]))
    weights = {joint: asked / alone.torques[joint]}
    return robot.stances[number].along(result.values, alone.offsets, weights)


def _places(result: DesignResult) -> Iterator[tuple[int, int, int]]:
    """Numbers of case, instant and load case, one after the other."""
    for number, solution in enumerate(result.cases):
        for instant, each in enumerate(solution.instants):
            for load_case in range(1 + len(each.disturbed)):
                yield number, instant, load_case


def along_design(
    derivative: CaseDerivative | NotDifferentiable, slopes: Array | NotDifferentiable | None
) -> CaseDerivative | NotDifferentiable:
    """The tangent of a posture by a design's parameters, from that by what programs are given."""
    if slopes is None or isinstance(derivative, NotDifferentiable):
        return derivative
    if isinstance(slopes, NotDifferentiable):
        return slopes
    if isinstance(derivative, LiftDerivative):
        along, cost_slope = derivative.slopes @ slopes, derivative.cost_slope @ slopes
        least = None if derivative.least_slope is None else derivative.least_slope @ slopes
        return replace(derivative, slopes=along, cost_slope=cost_slope, least_slope=least)
    return replace(
        derivative,
        slopes={name: each @ slopes for name, each in derivative.slopes.items()},
        cost_slope=derivative.cost_slope @ slopes,
        limits=_limits(derivative.limits, slopes),
    )


def reach_along_design(
    derivative: ReachDerivative | NotDifferentiable, slopes: Array | NotDifferentiable | None
) -> ReachDerivative | NotDifferentiable:
    """The same of an extreme height."""
    if slopes is None or isinstance(derivative, NotDifferentiable):
        return derivative
    if isinstance(slopes, NotDifferentiable):
        return slopes
    return replace(derivative, slope=derivative.slope @ slopes, limits=_limits(derivative.limits, slopes))


def _limits(limits: Sequence[Limit], slopes: Array) -> Sequence[Limit]:
    if isinstance(limits, LimitTable):
        return replace(limits, slopes=limits.slopes @ slopes)
    return [replace(limit, slope=limit.slope @ slopes) for limit in limits]
