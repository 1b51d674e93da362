"""`front`: every number that it prints is the log's, whatever the run is like."""

from __future__ import annotations

import csv
import io
import json
from io import StringIO
from pathlib import Path
from typing import Any

import msgspec
import pytest
from rich.console import Console

from evodesign.analysis.decision_making import knees
from evodesign.analysis.front import front
from evodesign.cli.front import front as command
from evodesign.cli.tables.card import card
from evodesign.errors import InputError
from evodesign.records import Evaluation, Objective, Parameter, RunHeader, Sense, materials_of
from evodesign.report.export.design import design_json
from evodesign.report.opened_design import OpenedDesign, RebuiltProblem
from evodesign.runlog.run import read_run
from evodesign.runlog.writer import RunWriter
from tests.runlog.toys import toy_evaluations, toy_header

HEADER = toy_header()
RUN = toy_evaluations(HEADER, 60)


def logged(directory: Path, header: RunHeader, evaluations: list[Evaluation]) -> Path:
    with RunWriter(directory, header) as writer:
        for evaluation in evaluations:
            writer.write(evaluation)
    return directory


@pytest.fixture
def run(tmp_path: Path) -> Path:
    return logged(tmp_path / "run", HEADER, RUN)


def printed(capsys: pytest.CaptureFixture[str], run: Path, **options: Any) -> str:
    command(run, **options)
    return capsys.readouterr().out


def test_csv_holds_every_number_of_the_log(run: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rows = list(csv.DictReader(io.StringIO(printed(capsys, run, csv=True))))
    expected = front(HEADER.objectives, RUN)
    assert sorted(int(row["design"]) for row in rows) == [each.number for each in expected]
    for row in rows:
        assessment = RUN[int(row["design"])].assessment
        for name, value in {**assessment.objectives, **assessment.design}.items():
            assert float(row[name]) == value


def test_a_front_tells_what_its_problem_leaves_out(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = '[payload]\ngrasp = "rigid"\nhand_moment_n_m = inf\n[human]\njoint_ranges = "coupled"\n'
    source = msgspec.structs.replace(HEADER.problem, text=text)
    command(logged(tmp_path / "run", msgspec.structs.replace(HEADER, problem=source), RUN))
    notes = [line for line in capsys.readouterr().err.splitlines() if line.startswith("note: ")]
    assert [note.split(":")[1] for note in notes] == [" no [collisions]", " hand_moment_n_m = inf"]


def of_materials() -> RunHeader:
    """A header whose second parameter is a density of two materials."""
    first, second = HEADER.parameters
    made = msgspec.structs.replace(
        second, upper=2700.0, choices=(800.0, 2700.0), materials=("shell", "alloy")
    )
    search = msgspec.structs.replace(HEADER.search, start=(), choices=(0, 2))
    return msgspec.structs.replace(HEADER, parameters=(first, made), search=search)


def test_materials_stand_beside_their_densities(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    header = of_materials()
    evaluations = toy_evaluations(header, 60)
    run = logged(tmp_path / "run", header, evaluations)
    rows = list(csv.DictReader(io.StringIO(printed(capsys, run, csv=True))))
    designs = json.loads(printed(capsys, run, json=True))["designs"]
    expected = front(header.objectives, evaluations)
    assert [design["id"] for design in designs] == [int(row["design"]) for row in rows]
    assert len(rows) == len(expected)
    for row, design in zip(rows, designs, strict=True):
        material = {800.0: "shell", 2700.0: "alloy"}[evaluations[design["id"]].assessment.design["arm.1"]]
        assert row["arm.1.material"] == material
        assert design["materials"] == {"arm.1": material}
        told = design_json(header, evaluations[design["id"]], (), on_front=True)
        assert told["materials"] == {"arm.1": material}
    shown = StringIO()
    opened = OpenedDesign(read_run(run), evaluations[5], (), on_front=False, rebuilt=RebuiltProblem(header))
    Console(file=shown, width=120).print(card(opened, (), {}))
    assert materials_of(header.parameters, evaluations[5].assessment.design)["arm.1"] in shown.getvalue()


def test_a_run_without_materials_says_nothing_of_any(run: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert ".material" not in printed(capsys, run, csv=True)
    assert '"materials"' not in printed(capsys, run, json=True)


def test_table_holds_the_log_s_numbers_to_four_figures(run: Path, capsys: pytest.CaptureFixture[str]) -> None:
    shown = printed(capsys, run)
    for each in front(HEADER.objectives, RUN):
        (line,) = [line for line in shown.splitlines() if f"│ {each.number:>6} │" in line]
        for value in each.assessment.objectives.values():
            assert f" {value:.4g} " in line


def test_knees_within_a_condition_come_as_json(run: Path, capsys: pytest.CaptureFixture[str]) -> None:
    shown = printed(capsys, run, knee=True, where=["reach_height >= 1.5"], limit=2, json=True)
    found = json.loads(shown)
    high = [each for each in RUN if each.assessment.objectives["reach_height"] >= 1.5]
    expected = knees(HEADER.objectives, front(HEADER.objectives, high))[:2]
    assert [design["id"] for design in found["designs"]] == [each.number for each in expected]
    assert found["where"] == ["reach_height >= 1.5"]
    assert found["front"] == len(front(HEADER.objectives, high))


def test_what_the_limit_leaves_out_is_said(run: Path, capsys: pytest.CaptureFixture[str]) -> None:
    whole = len(front(HEADER.objectives, RUN))
    assert f"2 of {whole} designs are shown" in printed(capsys, run, limit=2)
    assert "are shown" not in printed(capsys, run)


def test_empty_and_infeasible_runs_say_so(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    empty = logged(tmp_path / "empty", HEADER, [])
    assert "nothing was evaluated yet" in printed(capsys, empty)
    infeasible = [each for each in RUN if not each.feasible][:3]
    nearest = min(infeasible, key=lambda each: each.assessment.violation or 0.0)
    shown = printed(capsys, logged(tmp_path / "infeasible", HEADER, infeasible))
    assert f"design {nearest.number} comes nearest" in shown
    assert f"{nearest.assessment.violation:.4g} m" in shown
    for run in (empty, tmp_path / "infeasible"):
        assert json.loads(printed(capsys, run, knee=True, json=True))["designs"] == []


@pytest.mark.parametrize("count", [1, 5])
def test_runs_of_one_and_of_five_objectives_have_a_table(
    count: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    objectives = tuple(
        Objective(name=f"number_{index}", sense=Sense.MINIMISE, unit="kg") for index in range(count)
    )
    search = msgspec.structs.replace(HEADER.search, objectives=count)
    header = msgspec.structs.replace(HEADER, objectives=objectives, search=search)
    run = [_with_objectives(each, objectives) for each in RUN]
    place = logged(tmp_path / "run", header, run)
    for options in ({}, {"knee": True}, {"different": True}, {"near": "number_0=0"}):
        shown = printed(capsys, place, **options)
        assert f"{len(front(objectives, run))} on the front" in shown


def _with_objectives(each: Evaluation, objectives: tuple[Objective, ...]) -> Evaluation:
    values = {
        objective.name: (each.number * (7 + position) % 61) / 61.0
        for position, objective in enumerate(objectives)
    }
    assessment = msgspec.structs.replace(each.assessment, objectives=values, violation=0.0)
    return msgspec.structs.replace(each, assessment=assessment)


def test_names_are_shown_as_text(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    name = "<script>[bold]\x1b[31m"
    parameters = tuple(Parameter(name=f"{name}{index}", lower=0.5, upper=2.0, unit="1") for index in range(2))
    header = msgspec.structs.replace(HEADER, problem_name=name, parameters=parameters)
    run = logged(tmp_path / "run", header, toy_evaluations(header, 40))
    table = printed(capsys, run, where=[f"{name}1 >= 0.5"])
    assert "<script>[bold]\\x1b[31m" in table
    assert "\x1b" not in table
    rows = list(csv.DictReader(io.StringIO(printed(capsys, run, csv=True))))
    assert f"{name}1" in rows[0]


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"knee": True, "different": True}, "--knee: wanted one way to choose"),
        ({"near": "reach=1"}, "--near: wanted objectives among .*'reach_height'"),
        ({"where": ["reach_height"]}, "--where: wanted NAME <"),
        ({"json": True, "csv": True}, "--csv: wanted one form of output"),
    ],
)
def test_options_that_make_no_sense_are_refused_in_one_sentence(
    options: dict[str, Any], words: str, run: Path
) -> None:
    with pytest.raises(InputError, match=words):
        command(run, **options)
