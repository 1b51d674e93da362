"""Disturbances from a problem file to objectives, records, gradients and the JSON of a design."""

from __future__ import annotations

from dataclasses import replace

import msgspec
import numpy as np
import pytest

from evodesign.errors import InputError
from evodesign.evaluation.baseline import Baseline
from evodesign.evaluation.evaluate import Evaluator, case_outcome, detail_of
from evodesign.evaluation.evaluation_json import evaluation_json
from evodesign.evaluation.precompute import precompute_setting
from evodesign.evaluation.sensitivities import Sensitivities
from evodesign.mechanics.agent import HUMAN, ROBOT
from evodesign.mechanics.disturbance import Disturbance, OverCases, PushedAt
from evodesign.posture.postures import Symmetry
from evodesign.posture.precompute.keys import key_of
from evodesign.posture.precompute.plan import stages
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.left_out import left_out
from evodesign.problem.notes import notes
from evodesign.quantities.design_result import DesignResult
from evodesign.quantities.objectives import objective_value
from evodesign.records import CaseDetail, CaseOutcome, ProblemSource

TABLES = """
[[disturbance]]
name = "heavier"
load_mass_share = 0.2

[[disturbance]]
push_n = [-20.0, 0.0, 0.0]
at = "robot"
"""
DESIGN_SEED = 4  # of 5 a neighbour has another optimum, 0.01 N m from the first one


def source_with(problem: DesignProblem, tables: str, task: str = "") -> ProblemSource:
    """The point-grasp problem at one height, without seeds, and with more tables."""
    text = problem.source.text.replace("heights_m = [0.8, 1.0, 1.2]", f"heights_m = [1.0]\n{task}")
    text = f"{text}\n[solver]\ncompile = false\nstart_portfolio = false\n{tables}"
    return ProblemSource(path="p.toml", text=text, files=problem.source.files)


@pytest.fixture(scope="module")
def shaken(problem: DesignProblem) -> DesignProblem:
    return build_problem(source_with(problem, TABLES))


@pytest.fixture(scope="module")
def values(shaken: DesignProblem) -> tuple[float, ...]:
    rng = np.random.default_rng(DESIGN_SEED)
    return shaken.space.values(tuple(rng.uniform(size=len(shaken.space.parameters))))


@pytest.fixture(scope="module")
def exact(shaken: DesignProblem) -> Evaluator:
    """Solved more exactly, so that differences show derivatives."""
    return Evaluator(replace(shaken, options=replace(shaken.options, tolerance=1e-10)))


@pytest.fixture(scope="module")
def result(exact: Evaluator, values: tuple[float, ...]) -> DesignResult:
    return exact.solve(values)


def test_tables_are_read_as_written(shaken: DesignProblem) -> None:
    found = shaken.scene.disturbances
    assert found.effort is OverCases.WORST
    assert found.cases == (
        Disturbance("heavier", mass_share=0.2),
        Disturbance("disturbance_2", push=(-20.0, 0.0, 0.0), at=PushedAt.ROBOT),
    )


def test_efforts_may_count_on_average(problem: DesignProblem) -> None:
    source = source_with(problem, TABLES, 'disturbed_effort = "mean"')
    assert build_problem(source).scene.disturbances.effort is OverCases.MEAN


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ("load_mass_share = -1.0", r"disturbance\[0\].load_mass_share: wanted a number > -1"),
        ("load_mass_share = nan", r"disturbance\[0\].load_mass_share: wanted a finite number"),
        ("center_of_mass_m = [0.3, 0.0, 0.0]", r"center_of_mass_m\[0\]: wanted a shift that leaves"),
        ("push_n = [20.0, 0.0]", r"disturbance\[0\].push_n: wanted"),
        ('at = "chest"', r"disturbance\[0\].at: wanted"),
        ("push = [1.0, 0.0, 0.0]", "did you mean 'push_n'"),
        ('name = "a"\n[[disturbance]]\nname = "a"', r"disturbance\[1\].name: wanted a unique name"),
    ],
)
def test_impossible_disturbances_are_refused_in_one_sentence(
    table: str, words: str, problem: DesignProblem
) -> None:
    with pytest.raises(InputError, match=words) as caught:
        build_problem(source_with(problem, f"[[disturbance]]\n{table}\n"))
    assert "\n" not in str(caught.value)


def test_a_push_to_the_side_is_solved_whole_or_refused_where_symmetry_is_asked_for(
    problem: DesignProblem,
) -> None:
    source = source_with(problem, "[[disturbance]]\npush_n = [0.0, 1.0, 0.0]\n")
    built = build_problem(source)
    assert built.symmetry is Symmetry.OFF
    (note,) = (each for each in notes(built) if each not in left_out(source))
    assert note.startswith("postures are solved whole, not symmetric: disturbance 'disturbance_1'")
    with pytest.raises(InputError, match=r"--symmetry: wanted 'auto', 'off'.*disturbance 'disturbance_1'"):
        build_problem(msgspec.structs.replace(source, symmetry="on"))


def test_a_way_to_count_efforts_that_does_not_exist_is_refused(problem: DesignProblem) -> None:
    with pytest.raises(InputError, match=r"task.disturbed_effort"):
        build_problem(source_with(problem, TABLES, 'disturbed_effort = "median"'))


def test_a_push_needs_a_trunk(problem: DesignProblem) -> None:
    source = source_with(problem, TABLES)
    text = source.text.replace("[robot]\n", "[robot]\ntrunk = []\n", 1)
    with pytest.raises(InputError, match=r"disturbance\[1\].at: wanted a trunk to push"):
        build_problem(msgspec.structs.replace(source, text=text))


def test_the_joint_problem_refuses_disturbances(shaken: DesignProblem) -> None:
    with pytest.raises(InputError, match="disturbance: wanted none in the joint problem, found 2"):
        Baseline(shaken)


def test_disturbed_cases_count_as_cases(result: DesignResult) -> None:
    (height,) = result.cases
    cases = (height.postures, *height.disturbed.values())
    norms = {agent: [postures[agent].torque_norm for postures in cases] for agent in (ROBOT, HUMAN)}
    assert len(norms[ROBOT]) == 3
    assert objective_value("robot_torque", result) == pytest.approx(sum(norms[ROBOT]) / 3.0)
    assert objective_value("worst_human_torque", result) == max(norms[HUMAN])
    assert objective_value("q50_robot_torque", result) == pytest.approx(sorted(norms[ROBOT])[1])
    undisturbed = norms[ROBOT][0] ** 2 + norms[HUMAN][0] ** 2
    assert objective_value("paper_cost", result) == pytest.approx(undisturbed / 100.0), (
        "the paper knows no disturbances"
    )


def test_records_hold_the_load_cases_and_nothing_where_there_are_none(result: DesignResult) -> None:
    (height,) = result.cases
    outcome, detail = case_outcome(height), detail_of(height)
    posture = height.disturbed["heavier"][ROBOT]
    assert outcome.disturbed["heavier"][ROBOT] == posture.torque_norm
    assert detail.instants[0].disturbed["heavier"][ROBOT].torques_n_m == posture.torques
    for record, kind in ((outcome, CaseOutcome), (detail, CaseDetail)):
        assert msgspec.json.decode(msgspec.json.encode(record), type=kind) == record
    undisturbed = replace(height, instants=(replace(height.instants[0], disturbed={}),))
    for record in (case_outcome(undisturbed), detail_of(undisturbed)):
        assert b"disturbed" not in msgspec.json.encode(record)


def test_the_result_shows_torques_and_wrenches_of_every_case(
    shaken: DesignProblem, exact: Evaluator, values: tuple[float, ...], result: DesignResult
) -> None:
    assessment, solved = exact.assessment(values, result), exact.details(result)
    whole = evaluation_json(shaken, values, result, assessment, {}, solved)
    (told,), (case,) = whole["heights"], whole["cases"]
    names = {"person": "", "payload": "", "task": {"kind": "hold", "height_m": told["height_m"]}}
    assert case | {"height_m": told["height_m"]} == told | names
    (height,) = result.cases
    assert list(told["disturbed"]) == ["heavier", "disturbance_2"]
    shown = told["disturbed"]["disturbance_2"]
    assert shown["human"]["torque_norm"] == height.disturbed["disturbance_2"][HUMAN].torque_norm
    wrench = height.disturbed["disturbance_2"][ROBOT].wrenches["left_foot"]
    assert shown["wrenches"]["robot.left_foot"] == wrench.tolist()
    assert "heavier: load.force_balance" in told["residuals"]


@pytest.mark.slow
def test_gradients_are_differences_of_disturbed_evaluations(
    shaken: DesignProblem, exact: Evaluator, values: tuple[float, ...], result: DesignResult
) -> None:
    wanted = ("robot_torque", "reach_height")
    found = Sensitivities(exact.problem).at(values, result).sensitivities()
    for place in (0, 5):
        parameter = shaken.space.parameters[place]
        step = 1e-5 * (parameter.upper - parameter.lower)
        ends = []
        for sign in (1.0, -1.0):
            moved = list(values)
            moved[place] += sign * step
            ends.append(exact.solve(moved))
        for name in wanted:
            gradient = found[name].gradient
            assert gradient is not None, found[name].notes
            above, below = (objective_value(name, end) for end in ends)
            assert above is not None
            assert below is not None
            slope = (above - below) / (2.0 * step)
            assert gradient[parameter.name] == pytest.approx(slope, rel=1e-4, abs=1e-6)


def test_pieces_follow_from_how_postures_are_shaken(problem: DesignProblem, shaken: DesignProblem) -> None:
    undisturbed = replace(shaken, scenes=(replace(shaken.scene, disturbances=problem.scene.disturbances),))
    for stage in stages(precompute_setting(shaken), shaken.tasks, portfolios=True, person_reaches=False):
        for piece in stage:
            assert key_of(precompute_setting(shaken), piece) != key_of(precompute_setting(undisturbed), piece)
