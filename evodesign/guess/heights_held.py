"""Whether a robot and people hold the load at the heights of their problem, solved for within seconds.

The robot as it is in its file has a reach, and a posture at one height within. A height outside of it is
refused where robots of the lengths that reach farthest do not reach it either, or a person does not.
Postures are solved without `[collisions]`, of which the robot's colliding pairs would have to be found first,
in a minute.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from evodesign.design.parameter import ParameterKind
from evodesign.errors import InputError, listed
from evodesign.evaluation.evaluate import Evaluator
from evodesign.mechanics.scene import Scene
from evodesign.posture.formulations.reach import HIGHEST, LOWEST, Reach, people_reach
from evodesign.posture.postures import Symmetry
from evodesign.posture.solution_derivative import ReachDerivative
from evodesign.problem.build import DesignProblem

WIDEST = {
    ParameterKind.LOWER: False,
    ParameterKind.UPPER: True,
    ParameterKind.ACTUATOR: True,
    ParameterKind.MARGIN: True,
}
"""Whether the upper bound of a parameter, not the lower, lets a robot reach farther."""


def holds(problem: DesignProblem) -> str:
    """The robot's reach, or everyone's where there is none, and a height at which a posture is solved.

    Raises:
        InputError: nothing is held, or a height is out of reach for every design.
    """
    scene = problem.scene

    def freed(scene: Scene) -> Scene:
        return scene.with_agents(*(replace(each, collisions=None) for each in scene.agents))

    alone = replace(
        problem,
        scenes=tuple(map(freed, problem.scenes[:1] if scene.robots else problem.scenes)),
        options=replace(problem.options, compiled=False),
        start_portfolio=False,
        whole_reach=True,
    )
    unscaled = problem.space.unscaled(scene.designed_tree)
    middle = problem.holds[len(problem.holds) // 2]
    result = Evaluator(replace(alone, tasks=(middle,))).solve(unscaled)
    case, reach = result.cases[0], result.reach
    if reach.lowest is None or reach.highest is None:
        key, who = ("robot.hands", "the robot") if scene.robots else ("payload", "people")
        wanted = (
            f"hands that can hold the load in front of {who} at some height; a smaller payload.size_m or "
            "limits.trunk_clearance_m may do"
        )
        raise InputError(key, "", wanted, f"none ({reach.reason})")
    within = tuple(task for task in problem.holds if reach.beyond(task.heights) == 0.0)
    beyond = ", ".join(f"{task.height_m:g}" for task in problem.holds if task not in within)
    found = f"from {reach.lowest:.2f} to {reach.highest:.2f} m"
    if not within:
        who = "the robot reaches" if scene.robots else "everyone reaches"
        raise InputError("task.heights_m", "", f"a height that {who}, {found}", beyond)
    if beyond:
        _refuse_beyond_every_design(problem, replace(alone, tasks=within[:1]), reach)
    if middle not in within:
        case = Evaluator(replace(alone, tasks=within[:1])).solve(unscaled).cases[0]
    if not case.solved:
        wanted = f"a posture with the load at {case.case.task}"
        raise InputError("task.heights_m", "", wanted, f"{case.status}: {case.reason}")
    out = f"; out of reach unless a design reaches farther: {beyond} m" if beyond else ""
    apart = "" if scene.agents[0].collisions is None else ", [collisions] aside"
    return f"{found}; a posture at {case.case.task} is solved{apart}{out}"


def _refuse_beyond_every_design(problem: DesignProblem, alone: DesignProblem, reach: Reach) -> None:
    """Refuse heights that robots of the lengths that reach farthest do not reach.

    Which these are the derivatives of the reach say; where joints may move or there is no derivative, nobody
    knows.

    Args:
        problem: whose heights these are.
        alone: the same as it is solved here.
        reach: of the robot as it is.
    """
    free = {parameter.kind for parameter in problem.space.free}
    if free & {ParameterKind.OFFSET, ParameterKind.TILT}:
        return
    evaluator, reaches, design = Evaluator(alone), [reach], ""
    if free & {ParameterKind.LENGTH, *WIDEST}:
        design = " as it is or with lengths at bounds"
        for sense in (HIGHEST, LOWEST):
            values = _farthest(problem, evaluator, sense)
            if values is None:
                return
            reaches.append(evaluator.solve(values).reach)
    lowest = min(each.lowest for each in reaches if each.lowest is not None)
    highest = max(each.highest for each in reaches if each.highest is not None)
    who = "the robot" if problem.scene.robots else "everyone"
    _refuse_outside(problem, f"{who} reaches{design}", lowest, highest)


def _farthest(problem: DesignProblem, evaluator: Evaluator, sense: float) -> tuple[float, ...] | None:
    """Values of the robot with the lengths that reach farthest, widest joints and strongest actuators.

    Lengths are at the bounds to which the extreme height of the unscaled robot moves farther out; None where
    it has no derivative.
    """
    unscaled = problem.space.unscaled(problem.scene.designed_tree)
    found = [each.derivative(unscaled, sense) for each in evaluator.inner.reaches.values()]
    slopes = [each.slope for each in found if isinstance(each, ReachDerivative)]
    if len(slopes) < len(found):
        return None
    outwards = (-sense * np.sum(slopes, axis=0)).tolist()
    values = list[float]()
    for parameter, value, farther in zip(problem.space.parameters, unscaled, outwards, strict=True):
        at_upper = {ParameterKind.LENGTH: farther > 0.0, **WIDEST}.get(parameter.kind)
        ends = {None: value, True: parameter.upper, False: parameter.lower}
        values.append(ends[at_upper])
    return tuple(values)


def _refuse_outside(problem: DesignProblem, who: str, lowest: float, highest: float) -> None:
    """Refuse heights of a problem [m] that are not within some."""
    outside = {key: f"{at:g}" for key, at in problem.named_heights.items() if not lowest <= at <= highest}
    if outside:
        wanted = f"heights that {who}, from {lowest:.2f} to {highest:.2f} m"
        raise InputError(listed([*outside]), "", wanted, listed([*outside.values()]))


def people_hold(problem: DesignProblem) -> str:
    """Heights that every person reaches, which no design changes; with the last load of each.

    Raises:
        InputError: somebody does not reach a height.
    """
    options = replace(problem.options, compiled=False, seldom=True)
    symmetric = problem.symmetry is not Symmetry.OFF
    found = []
    for person, scene in {scene.pair[0]: scene for scene in problem.scenes}.items():
        reach = people_reach(scene, options, symmetric=symmetric)
        if reach is not None:
            _refuse_outside(problem, f"{person or 'the person'} reaches", reach.lowest, reach.highest)
            found.append(reach)
    if not found:
        return "not known"
    lowest, highest = max(each.lowest for each in found), min(each.highest for each in found)
    return f"from {lowest:.2f} to {highest:.2f} m"
