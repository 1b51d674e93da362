"""Prices of limits are what the optimum costs more or less when the number in the file is another one."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import Any

import casadi as ca
import msgspec
import numpy as np
import pytest
import tomli_w
from scipy.optimize import lsq_linear

from evodesign.evaluation.evaluate import Evaluator
from evodesign.hardware.actuators import Actuator
from evodesign.mechanics.agent import Agent
from evodesign.nlp.program import Program
from evodesign.nlp.solver import Multipliers, SolverCache
from evodesign.posture.active_limits import LimitSlopes, priced
from evodesign.posture.check import Unchecked
from evodesign.posture.formulations.base import Setting
from evodesign.posture.formulations.joint import JointPostures, posture_program
from evodesign.posture.results import CaseSolution
from evodesign.posture.symmetry import symmetric_forms, whole
from evodesign.posture.terms.registry import TERMS
from evodesign.posture.warm_start import start_from
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.quantities.design_result import DesignResult
from evodesign.records import ActiveLimit, CaseDetail, Hold
from tests.posture.center_of_mass_term import mass_height
from tests.posture.resolved import (
    as_before,
    prices,
    slope,
    with_number,
    with_persons_joints,
    with_robot_joint,
)

TOUCHING = 1e-5
"""Slack of what counts as at its bound, and how far from stationary a point may be, in a program's units."""

WITHIN = 0.01
"""Largest share by which a price may differ from differences of optima."""

HEIGHTS = (0, 1, 2)


def unscaled(problem: DesignProblem) -> tuple[float, ...]:
    return problem.space.unscaled(problem.scene.robot.tree)


@pytest.fixture(scope="module")
def result(evaluator: Evaluator) -> DesignResult:
    return evaluator.solve(unscaled(evaluator.problem))


@pytest.fixture(scope="module")
def details(evaluator: Evaluator, result: DesignResult) -> tuple[CaseDetail, ...]:
    return evaluator.details(result)


def limit_of(detail: CaseDetail, part: str) -> ActiveLimit:
    (found,) = (limit for limit in detail.limits if part in limit.part)
    return found


def regularised(agent: Agent, solution: CaseSolution, joint: str, count: int, *, upper: bool) -> float:
    """By how much a wider range changes the effort where joints count relative to it [N m/rad].

    The regularisation is a hundredth of (q / (u - l))^2 of every joint.
    """
    assert solution.attempt is not None
    ends = agent.tree.joint_by_name[joint]
    wide, at = ends.upper - ends.lower, solution.postures[agent.name].joints[joint]
    slope = -0.02 * count * at**2 / wide**3 * (1.0 if upper else -1.0)
    return 10.0 * slope / (2.0 * math.sqrt(solution.attempt.cost))


@pytest.mark.parametrize("place", HEIGHTS)
def test_every_active_number_of_the_file_costs_what_other_numbers_save(
    evaluator: Evaluator, result: DesignResult, details: tuple[CaseDetail, ...], place: int
) -> None:
    """Robot and person are solved one after the other here, and together where the number is another one."""
    problem, solution = evaluator.problem, result.cases[place]
    active = prices(details[place].limits)
    assert active
    for number, (price, step) in active.items():
        changed = partial(with_number, problem, number)
        found = slope(evaluator, changed, step, unscaled(problem), solution)
        assert price == pytest.approx(found, rel=WITHIN), number


@pytest.mark.parametrize(
    ("joint", "twin", "upper"),
    [
        ("l_elbow", "r_elbow", True),
        ("torso_pitch", None, False),
        ("l_shoulder_roll", "r_shoulder_roll", False),
    ],
)
def test_a_range_in_the_urdf_costs_what_a_wider_one_saves(
    evaluator: Evaluator,
    result: DesignResult,
    details: tuple[CaseDetail, ...],
    joint: str,
    twin: str | None,
    upper: bool,
) -> None:
    """Of a pair of joints both ranges change."""

    def changed(step: float) -> DesignProblem:
        moved = with_robot_joint(evaluator.problem, joint, step, upper=upper)
        return moved if twin is None else with_robot_joint(moved, twin, step, upper=upper)

    limit = limit_of(details[0], joint)
    assert (limit.agent, limit.at_most, limit.unit) == ("robot", upper, "rad")
    assert limit.part == (joint if twin is None else f"{joint} and {twin}")
    solution = result.cases[0]
    found = slope(evaluator, changed, 1e-4, unscaled(evaluator.problem), solution)
    own = found - regularised(
        evaluator.problem.scene.robot, solution, joint, 1 + (twin is not None), upper=upper
    )
    assert limit.price_n_m == pytest.approx(own, rel=WITHIN)
    assert (limit.price_n_m < 0.0) is upper


def test_a_persons_range_costs_what_a_wider_one_saves(
    evaluator: Evaluator, result: DesignResult, details: tuple[CaseDetail, ...]
) -> None:
    knees = "jLeftKnee_roty", "jRightKnee_roty"

    def changed(step: float) -> DesignProblem:
        return with_persons_joints(evaluator.problem, dict.fromkeys(knees, step), upper=False)

    limit = limit_of(details[2], knees[0])
    assert (limit.agent, limit.at_most, limit.value) == ("human", False, 0.0)
    solution = result.cases[2]
    found = slope(evaluator, changed, 1e-4, unscaled(evaluator.problem), solution)
    own = found - regularised(evaluator.problem.scene.human, solution, knees[0], 2, upper=False)
    assert limit.price_n_m == pytest.approx(own, rel=WITHIN)


TIGHT: Mapping[str, tuple[str, float, Mapping[str, Any]]] = {
    "friction": ("limits.friction", 0.8, {"limits": {"friction": 0.008}}),
    "twist": ("limits.torsional_friction_m", 1.0, {"limits": {"torsional_friction_m": 0.0005}}),
    "sole": ("robot.soles.size_m", 1.0, {"robot": {"soles": {"size_m": [0.01, 0.1]}}}),
    "tilt": ("limits.base_tilt_rad", 0.8, {"limits": {"base_tilt_rad": 0.01}}),
    "yaw": ("limits.foot_yaw_rad", 1.0, {"limits": {"foot_yaw_rad": 0.02}}),
    "apart": ("limits.feet_apart_m", 1.0, {"limits": {"feet_apart_m": [0.6, 0.9]}}),
    "gap": ("limits.feet_gap_m", 0.8, {"limits": {"feet_gap_m": 0.3}}),
    "moment": ("payload.hand_moment_n_m", 1.0, {"payload": {"grasp": "rigid", "hand_moment_n_m": 1.0}}),
    "gaze": ("human.gaze_cone_deg", 1.0, {"human": {"gaze_cone_deg": 25.0}}),
    "cone": ("payload.grasp_cone_deg", 1.0, {"payload": {"grasp_direction": "side", "grasp_cone_deg": 30.0}}),
    "torque": (
        "robot.torque_limits_n_m.*_shoulder_pitch",
        1.0,
        {"robot": {"torque_limits": "hard", "torque_limits_n_m": {"*_shoulder_pitch": 2.0}}},
    ),
    "disturbed": (
        "limits.push_n",
        0.8,
        {"limits": {"push_n": 1.0}, "disturbance": [{"name": "push", "push_n": [-20.0, 0.0, 0.0]}]},
    ),
}
"""Names of limits, the number that is each of them, and the height and tables with which it is active."""


def merged(tables: dict[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    for key, value in changes.items():
        tables[key] = merged(tables.get(key, {}), value) if isinstance(value, dict) else value
    return tables


def tight(problem: DesignProblem, changes: Mapping[str, Any], height: float = 1.0) -> DesignProblem:
    tables = merged(tomllib.loads(problem.source.text), {**changes, "task": {"heights_m": [height]}})
    return as_before(
        problem, build_problem(msgspec.structs.replace(problem.source, text=tomli_w.dumps(tables)))
    )


def solved(problem: DesignProblem, *, halves: bool) -> tuple[JointPostures, CaseSolution]:
    """The optimum of robot and person together, from the program's own starts, with its formulation."""
    scene = problem.scene
    forms = symmetric_forms(scene) if halves else (whole(scene.robot), whole(scene.human))
    setting = Setting(scene, problem.space, problem.weights, problem.options)
    postures = JointPostures("symmetric" if halves else "whole", forms, setting, SolverCache())
    task = problem.tasks[0]
    trial = postures.solve(unscaled(problem), task, postures.starts(task), Unchecked())
    assert trial.best is not None
    best = trial.best
    case = scene.case(task)
    return postures, CaseSolution(
        case, best.attempt.status, "solved", best.instants, attempt=best.attempt, raw=best.raw
    )


@pytest.mark.slow
@pytest.mark.parametrize("name", TIGHT)
def test_a_tight_limit_costs_what_a_wider_one_saves(problem: DesignProblem, name: str) -> None:
    key, height, changes = TIGHT[name]
    close = tight(problem, changes, height)
    postures, solution = solved(close, halves=True)
    active = prices(postures.active_limits(unscaled(close), solution))
    shown = key.removesuffix(".*_shoulder_pitch")
    (number,) = (number for number in active if number[0] == shown)
    price, step = active[number]
    at_most = number[1] and name != "sole"  # of the sole the first number of the pair, its length
    changed = partial(with_number, close, (key, at_most))
    found = slope(Evaluator(close), changed, step, unscaled(close), solution)
    assert abs(found) > 1e-2
    assert price == pytest.approx(found, rel=WITHIN)


def driven(problem: DesignProblem, rated: float) -> DesignProblem:
    """With shoulders whose actuators weigh nothing and hold so much [N m]."""
    robot = problem.scene.robot
    drive = Actuator(rated, 2.0 * rated, 0.0, 1.0, 0.0, 1.0, 1.0)
    joints = tuple(
        replace(joint, actuator=drive) if joint.name.endswith("shoulder_pitch") else joint
        for joint in robot.tree.joints
    )
    robot = replace(robot, tree=robot.tree.reshaped(robot.tree.links, joints))
    return replace(problem, scenes=tuple(scene.with_agents(robot) for scene in problem.scenes))


def test_what_an_actuator_holds_costs_what_a_larger_one_saves(problem: DesignProblem) -> None:
    bare = tight(problem, {})
    weak = driven(bare, 2.0)
    postures, solution = solved(weak, halves=True)
    (limit,) = (
        each for each in postures.active_limits(unscaled(weak), solution) if each.name == "rated torque"
    )
    assert limit.part == "l_shoulder_pitch and r_shoulder_pitch"
    assert (limit.value, limit.at_most, limit.unit) == (2.0, True, "N m")
    found = slope(Evaluator(weak), lambda much: driven(bare, 2.0 + much), 1e-3, unscaled(weak), solution)
    assert found < -1e-2
    assert limit.price_n_m == pytest.approx(found, rel=WITHIN)


def recovered(program: Program, parameters: Mapping[str, Any], values: Mapping[str, Any]) -> Multipliers:
    """Multipliers of a stationary point by least squares, from exact derivatives."""
    x, p = program.packed(values), program.packed_parameters(parameters)
    derivatives = ca.Function(
        "derivatives",
        [program.symbols, program.given],
        [
            ca.gradient(program.cost, program.symbols),
            program.rows,
            ca.jacobian(program.rows, program.symbols),
        ],
    )
    gradient, rows, jacobian = (np.array(part) for part in derivatives(x, p))
    everything, columns = np.concatenate([x, rows.ravel()]), np.vstack([np.eye(len(x)), jacobian])
    lower, upper = (np.concatenate(pair) for pair in zip(program.bounds, program.limits, strict=True))
    at = [np.abs(everything - side) < TOUCHING for side in (lower, upper)]
    held = at[0] | at[1]
    least, most = (np.where(one, sign * np.inf, 0.0) for one, sign in zip(at, (-1.0, 1.0), strict=True))
    found = lsq_linear(columns[held].T, -gradient.ravel(), (least[held], most[held]), method="bvls")
    assert np.abs(columns[held].T @ found.x + gradient.ravel()).max() < TOUCHING
    multipliers = np.zeros(len(everything))
    multipliers[held] = found.x
    return Multipliers(multipliers[: len(x)], multipliers[len(x) :])


@pytest.mark.parametrize("name", ["friction", "moment", "twist", "gap"])
def test_whole_postures_have_the_prices_of_their_halves(
    problem: DesignProblem, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    """A pair's price is the sum of both sides', and so is that of a number that bounds both feet or hands.

    The symmetric optimum is stationary among whole postures, where its multipliers are computed anew; but
    for the regularisation of wrenches, which counts feet that push each other apart in whole ones alone.
    """
    monkeypatch.delitem(TERMS, "wrench_regularisation")
    _, height, changes = TIGHT[name]
    close = tight(problem, changes, height)
    values = unscaled(close)
    halves, solution = solved(close, halves=True)
    assert solution.raw is not None
    forms = whole(close.scene.robot), whole(close.scene.human)
    setting = Setting(close.scene, close.space, close.weights, close.options)
    program = posture_program(forms, setting)
    found = start_from(program, forms, solution.instants)
    parameters = {"design": values, "height": height, "mass": close.scene.payload.mass}
    raw = replace(solution.raw, values=found, multipliers=recovered(program, parameters, found))
    of_whole = priced(LimitSlopes(program).of(parameters, raw), solution.raw.cost)
    of_halves = halves.active_limits(values, solution)
    assert prices(of_halves)
    for number, (price, _) in prices(of_halves).items():
        assert prices(of_whole)[number][0] == pytest.approx(price, rel=1e-3), number
    pairs = [limit for limit in of_halves if " and " in limit.part and limit.name == "joint range"]
    assert pairs
    for pair in pairs:
        left = next(each for each in of_whole if each.part == pair.part.split(" and ")[0])
        assert 2.0 * left.price_n_m == pytest.approx(pair.price_n_m, rel=1e-3), pair.part


def test_a_limit_of_a_term_that_does_not_say_what_it_is_has_the_row_s_name(
    problem: DesignProblem, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(TERMS, "mass_height", mass_height(0.6))
    close = tight(problem, {})
    postures, solution = solved(close, halves=True)
    found = [each for each in postures.active_limits(unscaled(close), solution) if each.name == "mass height"]
    assert found
    assert all((each.value, each.at_most, each.unit) == (0.6, False, "") for each in found)
    assert all(each.price_n_m > 0.0 for each in found)


def test_multipliers_that_are_none_have_no_prices(problem: DesignProblem) -> None:
    postures, solution = solved(tight(problem, {}), halves=True)
    assert solution.raw is not None
    raw = solution.raw
    nothing = replace(
        raw.multipliers,
        bounds=np.zeros_like(raw.multipliers.bounds),
        constraints=np.zeros_like(raw.multipliers.constraints),
    )
    program = postures._solver.program
    assert LimitSlopes(program).of({}, replace(raw, multipliers=nothing)) == {}
    assert priced({}, raw.cost) == ()


def test_steps_and_words_of_limits() -> None:
    apart = ActiveLimit(name="feet apart", value=0.5, unit="m", price_n_m=-4.0, at_most=True, agent="robot")
    assert apart.words == "feet apart, at most 50 cm"
    assert apart.change_n_m == pytest.approx(-0.04)
    elbow = ActiveLimit(
        name="joint range", value=math.radians(75.0), unit="rad", price_n_m=-9.0, at_most=True, part="l_elbow"
    )
    assert elbow.words == "joint range of l_elbow, at most 75 degrees"
    assert elbow.change_n_m == pytest.approx(-9.0 * math.pi / 180.0)
    slip = ActiveLimit(name="friction", value=0.5, unit="1", price_n_m=-30.0, at_most=True)
    assert (slip.words, slip.step[1]) == ("friction, at most 0.5", "0.01")


def test_a_lift_has_no_limits_and_a_hold_keeps_its_own(details: tuple[CaseDetail, ...]) -> None:
    assert all(isinstance(detail.case.task, Hold) and detail.limits for detail in details)
    assert details[0].moments[0].limits == details[0].limits
    again = msgspec.json.decode(msgspec.json.encode(details[0]), type=CaseDetail)
    assert again == details[0]
    before = msgspec.json.encode(msgspec.structs.replace(details[0], limits=()))
    assert b"limits" not in before
