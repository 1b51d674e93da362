"""What commands say of a run whose front met samples of people."""

from __future__ import annotations

import csv
import json
import shutil
from io import StringIO
from pathlib import Path

import pytest
import tomli_w

from evodesign.cli.main import app
from evodesign.runlog.run import read_run
from evodesign.runlog.sampled_file import SAMPLED_FILE, read_sampled
from tests.measured_people import LIFTING, SAMPLES, measured_tables

HUMAN = "worst_human_torque"


def said(capsys: pytest.CaptureFixture[str], *arguments: object) -> str:
    capsys.readouterr()
    app([*map(str, arguments)], standalone_mode=False)
    out, told = capsys.readouterr()
    assert out, told
    return out


def torques(run: Path, design: int) -> list[float]:
    found, _ = read_sampled(read_run(run))
    assert found is not None
    return [each.assessment.objectives[HUMAN] for each in found.designs if each.design == design]


def test_front_shows_mean_deviation_and_on_how_many_fronts_a_design_is(
    run_with_people: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    told = json.loads(said(capsys, "front", run_with_people, "--json"))
    assert told["spread"] == {"samples": SAMPLES, "reference": 0}
    for design in told["designs"]:
        own = torques(run_with_people, design["id"])
        assert design["spread"]["quantities"][HUMAN]["mean"] == pytest.approx(sum(own) / SAMPLES)
    rows = [*csv.DictReader(StringIO(said(capsys, "front", run_with_people, "--csv")))]
    assert [int(row["samples_on_front"]) for row in rows] == [
        design["spread"]["on_front"] for design in told["designs"]
    ]
    assert float(rows[0][f"{HUMAN}.deviation"]) > 1.0
    table = said(capsys, "front", run_with_people)
    assert "samples of people: " in table
    assert " ± " in table
    assert f"over {SAMPLES} samples of people" in table


def test_show_compares_a_design_with_the_unscaled_robot(
    run_with_people: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    number = next(each for each in range(1, 6) if torques(run_with_people, each))
    told = json.loads(said(capsys, "show", run_with_people, number, "--json"))["spread"]
    less = [a - b for a, b in zip(torques(run_with_people, number), torques(run_with_people, 0), strict=True)]
    difference = told["quantities"][HUMAN]["difference"]
    assert difference["mean"] == pytest.approx(sum(less) / SAMPLES, abs=1e-12)
    card = said(capsys, "show", run_with_people, number)
    assert f"beside {SAMPLES} samples of people: on the front in" in card
    assert "less that of" in card


def test_a_design_that_met_nobody_and_a_run_without_samples_say_nothing_of_people(
    run_with_people: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    number = next(each for each in range(6) if not torques(run_with_people, each))
    assert "spread" not in json.loads(said(capsys, "show", run_with_people, number, "--json"))
    run = shutil.copytree(run_with_people, tmp_path / "run")
    (run / SAMPLED_FILE).unlink()
    assert "spread" not in json.loads(said(capsys, "front", run, "--json"))
    assert "samples" not in said(capsys, "front", run, "--csv")


def test_spread_prints_what_is_kept(run_with_people: Path, capsys: pytest.CaptureFixture[str]) -> None:
    told = json.loads(said(capsys, "spread", run_with_people, "--jobs", 1, "--json"))
    assert (told["samples"], told["reference"]) == (SAMPLES, 0)
    for design in told["designs"]:
        own = torques(run_with_people, design["id"])
        assert design["quantities"][HUMAN]["mean"] == pytest.approx(sum(own) / SAMPLES)
    assert "samples of people" in said(capsys, "spread", run_with_people, "--jobs", 1)


def test_evaluate_asks_the_samples_of_its_problem(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    tables = measured_tables(spread=2)
    tables["robot"]["urdf"] = str((LIFTING / tables["robot"]["urdf"]).resolve())
    file = tmp_path / "problem.toml"
    file.write_text(tomli_w.dumps(tables), encoding="utf-8")
    (tmp_path / "longer.toml").write_text(
        'name = "longer"\n[[design]]\nname = "longer"\nlength = { forearm = 1.2 }\n', encoding="utf-8"
    )
    arguments = ("evaluate", file, "--design", tmp_path / "longer.toml", "--jobs", 1)
    told = json.loads(said(capsys, *arguments, "--json"))["spread"]
    assert told["samples"] == 2
    assert told["quantities"]["robot_torque"]["difference"]["samples"] == 2
    printed = said(capsys, *arguments)
    assert "beside 2 samples of people" in printed
    assert "unscaled robot" in printed
