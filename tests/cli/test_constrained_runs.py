"""A search of the point-grasp problem for light robots, and what every view of its run says of the bounds."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest
from rich.console import Console

from evodesign.analysis.audit import audit
from evodesign.analysis.front import front
from evodesign.api.problem import Problem
from evodesign.api.pymoo_problem import as_pymoo_problem
from evodesign.api.run import Run
from evodesign.cli.front import front as front_command
from evodesign.cli.show import show
from evodesign.cli.tables.design import design_tables
from evodesign.evaluation.evaluate import Evaluator
from evodesign.evaluation.evaluation_json import evaluation_json
from evodesign.evaluation.progress import PrecomputeProgress
from evodesign.evolve import replay, resume, start
from evodesign.pool.base import Pool
from evodesign.pool.registry import make_pool
from evodesign.posture.precompute.precomputed import Precomputed
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.records import Evaluation, RunHeader
from evodesign.report.export.design import ExportedDesign, design_json
from evodesign.report.export.readme import readme_text
from evodesign.report.live.state import FollowedRun
from evodesign.report.opened_design import open_design
from evodesign.report.page import page_content
from evodesign.runlog.header import header_of
from evodesign.runlog.run import RunLog, read_run
from evodesign.runlog.session_log import Silent
from evodesign.runlog.writer import RunWriter
from tests.runlog.toys import essence

pytestmark = pytest.mark.slow

HEAVIEST, LOWEST = 65.0, 1.35
BOUNDS = f"\n[constraints]\nmass_kg = {{ upper = {HEAVIEST} }}\nreach_height_m = {{ lower = {LOWEST} }}\n"
BUDGET, POPULATION = 48, 12


@pytest.fixture(scope="module")
def light(native: DesignProblem) -> DesignProblem:
    return build_problem(msgspec.structs.replace(native.source, text=f"{native.source.text}{BOUNDS}"))


@pytest.fixture(scope="module")
def lights(light: DesignProblem, known: Precomputed) -> Evaluator:
    return Evaluator(light, known)


@pytest.fixture(scope="module")
def pool() -> Pool:
    return make_pool("serial", 1)


def searched(place: Path, evaluator: Evaluator, pool: Pool, budget: int, **settings: bool) -> RunLog:
    problem = evaluator.problem
    header = header_of(problem, problem.settings("nsga2", POPULATION, 1, **settings), budget)
    return start(place, header, lambda: evaluator.assess, pool, Silent())


@pytest.fixture(scope="module")
def run(lights: Evaluator, pool: Pool, tmp_path_factory: pytest.TempPathFactory) -> RunLog:
    return searched(tmp_path_factory.mktemp("light") / "run", lights, pool, BUDGET)


def heavy(run: RunLog) -> Evaluation:
    return next(each for each in run.evaluations if each.assessment.constrained["mass"] > HEAVIEST)


def test_no_design_of_the_front_is_beyond_the_bounds(run: RunLog, lights: Evaluator) -> None:
    objectives = run.header.objectives
    best = front(objectives, run.evaluations)
    assert len(best) > 1
    space, tree = lights.problem.space, lights.problem.scene.robot.tree
    for design in best:
        links = space.resized(tree, space.values(design.genome)).links
        assert sum(float(link.inertia.mass) for link in links) <= HEAVIEST
        assert design.assessment.objectives["reach_height"] >= LOWEST
    free = [msgspec.structs.replace(e.assessment, violation=0.0) for e in run.evaluations]
    unbounded = [
        msgspec.structs.replace(evaluation, assessment=assessment)
        for evaluation, assessment in zip(run.evaluations, free, strict=True)
    ]
    chosen = {each.number for each in front(objectives, unbounded)}
    assert chosen - {each.number for each in best}, "without the bounds other designs would be on it"


@pytest.mark.parametrize("asynchronous", [False, True])
def test_a_resumed_search_equals_an_uninterrupted_one(
    tmp_path: Path, lights: Evaluator, pool: Pool, asynchronous: bool
) -> None:
    whole = searched(tmp_path / "whole", lights, pool, 24, asynchronous=asynchronous)
    searched(tmp_path / "halves", lights, pool, 14, asynchronous=asynchronous)
    both = resume(tmp_path / "halves", lambda header: lambda: lights.assess, pool, Silent(), 24)
    assert essence(both) == essence(whole)
    assert any(each.assessment.violation for each in both.evaluations)
    replay(both)


def test_the_log_agrees_with_itself_and_a_changed_violation_is_found(run: RunLog) -> None:
    assert audit(run) == []
    wrong = msgspec.structs.replace(heavy(run).assessment, violation=1e-3)
    changed = tuple(
        msgspec.structs.replace(each, assessment=wrong) if each.number == heavy(run).number else each
        for each in run.evaluations
    )
    found = audit(with_evaluations(run, changed))
    assert f"evaluation {heavy(run).number}: its violation is not that of its values" in found


def with_evaluations(run: RunLog, evaluations: tuple[Evaluation, ...]) -> RunLog:
    return RunLog(
        run.directory, run.header, evaluations, (), (), run.details, complete=run.complete, notes=()
    )


def printed(capsys: pytest.CaptureFixture[str], place: Path, **options: Any) -> str:
    front_command(place, **options)
    return capsys.readouterr().out


def test_fronts_show_value_and_bounds(run: RunLog, capsys: pytest.CaptureFixture[str]) -> None:
    best = {each.number: each.assessment for each in front(run.header.objectives, run.evaluations)}
    rows = list(csv.DictReader(io.StringIO(printed(capsys, run.directory, csv=True))))
    assert {int(row["design"]): float(row["mass"]) for row in rows} == {
        number: assessment.constrained["mass"] for number, assessment in best.items()
    }
    assert list(rows[0]).count("reach_height") == 1, "an objective that is bounded too has one column"
    designs = json.loads(printed(capsys, run.directory, json=True))["designs"]
    for design in designs:
        light, high = design["constraints"]
        assert light == {
            "name": "mass",
            "unit": "kg",
            "lower": None,
            "upper": HEAVIEST,
            "value": best[design["id"]].constrained["mass"],
            "violation": 0.0,
        }
        assert (high["lower"], high["violation"]) == (LOWEST, 0.0)
    table = printed(capsys, run.directory)
    assert "at most 65 kg" in " ".join(table.replace("│", " ").split())
    assert all(f"{assessment.constrained['mass']:.4g}" in table for assessment in best.values())


def test_conditions_know_what_is_constrained(run: RunLog, capsys: pytest.CaptureFixture[str]) -> None:
    designs = json.loads(printed(capsys, run.directory, where=["mass <= 60"], json=True))["designs"]
    assert designs
    assert all(design["constraints"][0]["value"] <= 60.0 for design in designs)
    chosen = Run(run).choose(where="mass <= 60")
    assert [design.number for design in chosen] == [design["id"] for design in designs]


def test_a_run_without_feasible_designs_says_what_comes_nearest(
    run: RunLog, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    only = heavy(run)
    with RunWriter(tmp_path / "heavy", run.header) as log:
        log.write(only)
    excess = only.assessment.constrained["mass"] - HEAVIEST
    shown = printed(capsys, tmp_path / "heavy")
    assert f"design {only.number} comes nearest: mass is {excess:.4g} kg above 65 kg" in shown


def test_a_card_says_why_a_design_is_not_feasible(run: RunLog, capsys: pytest.CaptureFixture[str]) -> None:
    number, assessment = heavy(run).number, heavy(run).assessment
    excess = assessment.constrained["mass"] - HEAVIEST
    show(run.directory, number, jobs=1)
    card = capsys.readouterr().out
    assert f"not feasible: mass is {excess:.4g} kg above 65 kg" in card
    (row,) = [line for line in card.splitlines() if "mass [kg]" in line]
    cells = [cell.strip() for cell in row.strip("│ ").split("│")]
    assert cells == ["mass [kg]", "at most 65 kg", f"{assessment.constrained['mass']:.4g}", f"{excess:.4g}"]
    told = design_json(run.header, heavy(run), (), on_front=False)
    assert [each["violation"] for each in told["constraints"]] == [pytest.approx(excess), 0.0]


def test_an_exported_folder_lists_the_constraints(run: RunLog) -> None:
    opened = open_design(
        run, front(run.header.objectives, run.evaluations)[0].number, 1, PrecomputeProgress()
    )
    design = ExportedDesign("run", run.header, opened.evaluation, opened.scene_set(), opened.cases)
    mass = opened.evaluation.assessment.constrained["mass"]
    assert f"- `mass` (at most 65 kg): {mass!r} kg" in readme_text(design, (), {})


def test_the_page_holds_values_bounds_and_reasons(run: RunLog) -> None:
    content = page_content(run)
    assert content.constraints == run.header.constrained
    assert content.points.constraints["mass"] == [
        each.assessment.constrained["mass"] for each in run.evaluations
    ]
    row = content.points.number.index(heavy(run).number)
    assert content.points.kind[row] == "infeasible"
    assert content.points.reason[row].startswith("mass is ")
    causes = {each.cause: each.count for each in content.failures}
    assert sum(causes.values()) == sum(not each.feasible for each in run.evaluations)
    assert "mass above 65 kg" in causes


def test_a_live_page_counts_exceeded_bounds(run: RunLog) -> None:
    exceeded = FollowedRun(run.directory).state()["exceeded"]
    masses = [each.assessment.constrained["mass"] for each in run.evaluations]
    assert exceeded["mass above 65 kg"] == sum(mass > HEAVIEST for mass in masses)


def test_python_has_values_and_violations(run: RunLog) -> None:
    opened = Run(run)
    assert opened.constraints == run.header.constrained
    assert opened.table()["mass"].tolist() == [
        each.assessment.constrained["mass"] for each in run.evaluations
    ]
    design = opened.design(heavy(run).number)
    mass, reach = design.constraints["mass"], design.constraints["reach_height"]
    assert design.violations == {
        "height": 0.0,
        "mass": mass - HEAVIEST,
        "reach_height": max(0.0, LOWEST - reach),
    }
    assert design.violation == pytest.approx((mass - HEAVIEST) / HEAVIEST + max(0.0, LOWEST - reach) / LOWEST)


def test_a_problem_in_python_evaluates_its_constraints(light: DesignProblem, known: Precomputed) -> None:
    assert known.postures, "worked out before, so that the problem finds it in the cache"
    opened = Problem(light.source)
    assert opened.constraints == light.constraints
    design = opened.evaluate({f"density.{part}": 2000.0 for part in ("thigh", "shank")})
    assert not design.feasible
    assert design.violations["mass"] == design.constraints["mass"] - HEAVIEST
    assert design.violations["mass"] > 0.0


def test_pymoo_and_optuna_get_a_column_for_each_constraint(
    light: DesignProblem, known: Precomputed, run: RunLog
) -> None:
    """They add up to what the search ranks by."""
    assert known.postures, "worked out before, so that the problem finds it in the cache"
    opened = Problem(light.source)
    design = heavy(run).assessment
    out = as_pymoo_problem(opened).evaluate(
        np.array([[design.design[each.name] for each in opened.parameters]]), return_as_dictionary=True
    )
    ((height, mass, reach),) = out["G"].tolist()
    assert (height, mass) == (0.0, (design.constrained["mass"] - HEAVIEST) / HEAVIEST)
    assert height + mass + reach == design.violation
    assert np.isnan(out["F"]).all()
    study = Run(run).to_optuna()
    for trial, evaluation in zip(study.trials, run.evaluations, strict=True):
        columns = trial.system_attrs["constraints"]
        assert len(columns) == 3
        assert sum(columns) == evaluation.assessment.violation
    best = {tuple(trial.values) for trial in study.best_trials}
    names = [objective.name for objective in run.header.objectives]
    assert best == {
        tuple(each.assessment.objectives[name] for name in names)
        for each in front(run.header.objectives, run.evaluations)
    }


def test_evaluate_tells_constraints_in_json_and_tables(lights: Evaluator) -> None:
    problem = lights.problem
    values = problem.space.unscaled(problem.scene.robot.tree)
    result = lights.solve(values)
    assessment = lights.assessment(values, result)
    solved = lights.details(result)
    told = evaluation_json(problem, values, result, assessment, {}, solved)
    mass, reach = (assessment.constrained[name] for name in ("mass", "reach_height"))
    assert [(each["value"], each["violation"]) for each in told["constraints"]] == [(mass, 0.0), (reach, 0.0)]
    shown = io.StringIO()
    for table in design_tables(problem, "unscaled", result, assessment, {}, solved):
        Console(file=shown, width=120).print(table)
    assert f"│ {mass:.4g} │" in shown.getvalue()
    assert "at least 1.35 m" in shown.getvalue()


def test_a_header_reads_its_constraints_back(run: RunLog) -> None:
    header: RunHeader = read_run(run.directory).header
    assert [(each.name, each.lower, each.upper) for each in header.constrained] == [
        ("mass", None, HEAVIEST),
        ("reach_height", LOWEST, None),
    ]
