"""The gradient baseline as a run: starts are evaluations, failures are rows, equal starts end alike."""

from __future__ import annotations

from pathlib import Path

import msgspec
import numpy as np
import pytest

from evodesign import evolve
from evodesign.analysis.front import front
from evodesign.errors import InputError
from evodesign.evaluation.baseline import Baseline, BaselineFactory
from evodesign.pool.worker import SerialPool
from evodesign.posture.terms.paper_tasks import density_task, mass_height_task
from evodesign.problem.build import build_problem
from evodesign.problem.source import read_source
from evodesign.records import FORMAT_VERSION, ProblemSource, RunHeader, Status
from evodesign.runlog.run import RunLog
from evodesign.searches.base import JOINT_STARTS
from evodesign.searches.registry import make_search


@pytest.fixture(scope="module")
def source(repository: Path) -> ProblemSource:
    """The paper's problem at one height."""
    return at_one_height(read_source(repository / "problems" / "sartore2022.toml"))


def at_one_height(source: ProblemSource, extra: str = "") -> ProblemSource:
    text = source.text.replace("heights_m = [0.8, 1.0, 1.2, 1.5]", "heights_m = [1.0]")
    assert text != source.text
    return msgspec.structs.replace(source, text=text.replace("[baseline]\n", f"[baseline]\n{extra}"))


def run_of(source: ProblemSource, directory: Path, starts: int) -> RunLog:
    problem = build_problem(source)
    header = RunHeader(
        format_version=FORMAT_VERSION,
        problem=source,
        problem_name=problem.name,
        parameters=problem.space.records,
        objectives=problem.objectives,
        search=problem.settings(JOINT_STARTS, 3, 7),
        budget=starts,
        versions={},
        git=None,
        started="now",
    )
    return evolve.start(directory, header, BaselineFactory("1", source), SerialPool(), evolve.Silent())


def test_a_baseline_is_a_run_like_any_other(source: ProblemSource, tmp_path: Path) -> None:
    run = run_of(source, tmp_path / "run", 3)
    problem = build_problem(source)
    assert [e.genome for e in run.evaluations[:2]] == list(problem.joint_start)
    assert all(e.assessment.status is Status.SOLVED and e.feasible for e in run.evaluations)
    (best,) = front(run.header.objectives, run.evaluations)
    assert best.assessment.objectives == {
        "paper_cost": min(e.assessment.objectives["paper_cost"] for e in run.evaluations)
    }
    assert best.number in [detail.evaluation for detail in run.details]
    moved = np.abs(np.array(problem.space.genome(list(best.assessment.design.values()))) - best.genome)
    assert moved.max() > 0.05


def test_the_logged_cost_is_that_of_equation_14(source: ProblemSource) -> None:
    """From the logged torque norms and design, with the weights of the file."""
    problem = build_problem(source)
    assessment = Baseline(problem).assess(problem.joint_start[1]).assessment
    (height,) = assessment.cases
    values = tuple(assessment.design.values())
    tree = problem.space.resized(problem.scene.robot.tree, values)
    assert height.robot_torque_norm is not None
    assert height.human_torque_norm is not None
    squared = (height.robot_torque_norm**2 + height.human_torque_norm**2) / 100.0
    density = float(density_task(problem.space, values, (1405.0, 4000.0)))
    stand = float(mass_height_task(problem.scene.robot, tree))
    assert assessment.objectives["paper_cost"] == pytest.approx(squared + 0.01 * density + 0.1 * stand)
    assert height.residual is not None
    assert height.residual < 1e-5


def test_the_same_start_ends_alike(source: ProblemSource) -> None:
    problem = build_problem(source)
    (genome,) = make_search(problem.settings(JOINT_STARTS, 3, 7)).ask()[2:]
    first, again = (Baseline(problem).assess(genome) for _ in range(2))
    assert first == again
    assert genome not in problem.joint_start


def test_a_start_that_fails_is_a_row(repository: Path, tmp_path: Path) -> None:
    whole = read_source(repository / "problems" / "sartore2022.toml")
    run = run_of(at_one_height(whole, "iterations = 4\n"), tmp_path / "run", 2)
    for evaluation in run.evaluations:
        assert evaluation.assessment.status is Status.ITERATION_LIMIT
        assert evaluation.assessment.objectives == {}
        assert evaluation.assessment.violation is None
        assert "Maximum_Iterations_Exceeded" in evaluation.assessment.reason
    assert front(run.header.objectives, run.evaluations) == ()


@pytest.mark.slow
def test_limits_that_are_not_enforced_are_named(repository: Path) -> None:
    """In the reason of a height that is solved all the same, and not counted as residuals."""
    published = read_source(repository / "problems" / "sartore2022_as_published.toml")
    problem = build_problem(published)
    assessment = Baseline(problem).assess(problem.joint_start[0]).assessment
    height = assessment.cases[0]
    assert assessment.status is Status.SOLVED
    assert assessment.violation == 0.0
    assert "limits not enforced and exceeded: " in height.reason
    assert height.residual is not None
    assert height.residual < 1e-5


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "[baseline]\n",
            '[baseline]\nstart = ["paper_strat"]\n',
            "baseline.start[0]: wanted the name of a design of '../populations/sartore2022.toml', "
            "found 'paper_strat'; did you mean 'paper_start'?",
        ),
        (
            "preferred_densities_kg_per_m3 = [1405.0, 4000.0]",
            "",
            "baseline.preferred_densities_kg_per_m3: wanted densities, as baseline.weights.density asks for, "
            "found none",
        ),
        ("torque = 1.0", "torque = 0.0", "baseline.weights.torque: wanted a number > 0.0, found 0.0"),
        ("[baseline]\n", "[baseline]\njoint_limit = true\n", "did you mean 'joint_limits'?"),
        (
            'start = "../populations/sartore2022.toml"\n\n[baseline]\n',
            '\n[baseline]\nstart = ["paper_start"]\n',
            "baseline.start: wanted search.start, the file that holds designs, found none",
        ),
    ],
)
def test_a_wrong_baseline_is_refused(source: ProblemSource, old: str, new: str, message: str) -> None:
    assert old in source.text
    with pytest.raises(InputError) as refusal:
        build_problem(msgspec.structs.replace(source, text=source.text.replace(old, new)))
    assert message.replace("`", "") in str(refusal.value)


def test_a_weight_without_a_density_to_change_is_refused(repository: Path) -> None:
    published = read_source(repository / "problems" / "sartore2022_as_published.toml")
    wrong = "[baseline.weights]\ndensity = 0.1\n"
    text = published.text.replace("[baseline.weights]\n", wrong)
    text = text.replace("[baseline]\n", "[baseline]\npreferred_densities_kg_per_m3 = [1405.0]\n")
    with pytest.raises(
        InputError, match=r"baseline.weights.density: wanted 0.0 without a \[\[design.density"
    ):
        build_problem(msgspec.structs.replace(published, text=text))
