"""A search ends with a few designs of its front, the run's figures, and commands that work as they stand."""

from __future__ import annotations

import json
import shlex
from pathlib import Path

import pytest

from evodesign.analysis.decision_making import knees
from evodesign.analysis.front import front
from evodesign.cli.front import print_front
from evodesign.cli.main import app
from evodesign.cli.session import show_result
from evodesign.cli.tables.result import MOST_KNEES, chosen_designs, next_commands
from evodesign.records import Evaluation
from evodesign.runlog.run import RunLog, read_run
from evodesign.runlog.writer import RunWriter
from tests.runlog.toys import toy_evaluations, toy_header

HEADER = toy_header(budget=60)
ALL = toy_evaluations(HEADER, 60)
FEASIBLE = [each for each in ALL if each.feasible]
INFEASIBLE = [each for each in ALL if not each.feasible]


def logged(directory: Path, evaluations: list[Evaluation]) -> RunLog:
    with RunWriter(directory, HEADER) as writer:
        for evaluation in evaluations:
            writer.write(evaluation)
    return read_run(directory)


def test_knees_come_first_then_the_best_in_each_objective_each_once() -> None:
    sharpest = knees(HEADER.objectives, front(HEADER.objectives, ALL))[:MOST_KNEES]
    chosen = chosen_designs(HEADER.objectives, ALL)
    assert [*chosen][: len(sharpest)] == [each.number for each in sharpest]
    assert len(chosen) <= MOST_KNEES + len(HEADER.objectives)
    lowest = min(FEASIBLE, key=lambda each: each.assessment.objectives["robot_torque"])
    highest = max(FEASIBLE, key=lambda each: each.assessment.objectives["reach_height"])
    assert "robot_torque" in chosen[lowest.number]
    assert "reach_height" in chosen[highest.number]


def test_a_front_of_one_design_is_one_row() -> None:
    (number,) = chosen_designs(HEADER.objectives, FEASIBLE[:1])
    assert number == FEASIBLE[0].number


def test_the_best_value_of_the_front_is_marked(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    show_result(logged(tmp_path / "run", ALL), json=False)
    shown = capsys.readouterr().out
    lowest = min(each.assessment.objectives["robot_torque"] for each in FEASIBLE)
    assert f"* {lowest:.4g} " in shown
    assert shown.count("│ knee │") == sum(
        "knee" in what for what in chosen_designs(HEADER.objectives, ALL).values()
    )
    assert f"{len(ALL)} evaluations, {len(FEASIBLE)} feasible" in shown


@pytest.mark.parametrize("name", ["run", "my run"])
def test_the_next_commands_work_as_they_stand(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    run = logged(Path(name), ALL)
    show_result(run, json=False)
    lines = capsys.readouterr().out.splitlines()
    commands = lines[lines.index("go on with:") + 1 :]
    assert [line.strip() for line in commands] == [
        *next_commands(run, chosen_designs(HEADER.objectives, ALL))
    ]
    report, show, front_of = (shlex.split(line) for line in commands)
    assert (report[:2], show[:2]) == (["evodesign", "report"], ["evodesign", "show"])
    assert int(show[-1]) in chosen_designs(HEADER.objectives, ALL)
    for words in (report, front_of):
        app(words[1:], standalone_mode=False)
    assert (Path(name) / "report.html").exists()


def test_where_nothing_is_feasible_it_says_what_comes_nearest_and_what_may_help(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run = logged(tmp_path / "run", INFEASIBLE)
    show_result(run, json=False)
    shown = capsys.readouterr().out
    nearest = min(INFEASIBLE, key=lambda each: each.assessment.violation or 0.0)
    assert f"design {nearest.number} comes nearest: it lacks {nearest.assessment.violation:.4g} m" in shown
    assert "what may help" in shown
    assert f"evodesign show {run.directory} {nearest.number}\n" in shown
    assert f"evodesign resume {run.directory} --evaluations {2 * HEADER.budget}\n" in shown


def test_a_run_without_evaluations_has_an_end_too(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    show_result(logged(tmp_path / "run", []), json=False)
    assert "nothing was evaluated yet" in capsys.readouterr().out


def test_as_json_it_is_the_whole_front(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run = logged(tmp_path / "run", ALL)
    show_result(run, json=True)
    shown = capsys.readouterr().out
    print_front(run, json=True)
    assert shown == capsys.readouterr().out
    assert len(json.loads(shown)["designs"]) == len(front(HEADER.objectives, ALL))
