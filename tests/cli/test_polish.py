"""`polish` and the sensitivities of `evaluate`, through the command line."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from evodesign.posture.precompute.precomputed import Precomputed
from tests.cli.here import evodesign

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def problem_file(repository: Path) -> Path:
    return repository / "problems" / "point_grasp.toml"


@pytest.fixture(scope="module")
def run(problem_file: Path, known: Precomputed, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run of two designs, the unscaled one first."""
    place = tmp_path_factory.mktemp("runs") / "run"
    sizes = ["--evaluations", "2", "--population", "2", "--pool", "serial"]
    done = evodesign("search", problem_file, "--run", place, *sizes)
    assert done.returncode == 0, done.stderr
    return place


def test_polished_design_is_evaluated_as_it_was_reported(run: Path, problem_file: Path) -> None:
    done = evodesign("polish", run, "0", "--objective", "robot_torque", "--evaluations", "4", "--json")
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    assert told["after"]["objectives"]["robot_torque"] < told["before"]["objectives"]["robot_torque"]
    assert told["evaluations"] == 4
    assert "evaluation 4/4" in done.stderr
    assert told["file"] == str(run / "polished-0.toml")
    again = evodesign("evaluate", problem_file, "--design", told["file"], "--json")
    assert again.returncode == 0, again.stderr
    evaluation_json = json.loads(again.stdout)
    assert evaluation_json["design"] == told["after"]["parameters"]
    assert evaluation_json["objectives"] == pytest.approx(told["after"]["objectives"], rel=1e-9)
    assert set(evaluation_json["sensitivities"]) == set(evaluation_json["objectives"])
    for found in evaluation_json["sensitivities"].values():
        assert set(found) == {"gradient", "notes"}
        assert set(found["gradient"]) == set(evaluation_json["design"])


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["7"], ["DESIGN", "0 to 1", "found 7"]),
        (["0", "--objective", "mas"], ["--objective", "'mas'"]),
        (["0", "--weights", "robot_torque"], ["--weights", "NAME=NUMBER"]),
        (["0", "--weights", "robot_torque=1", "--objective", "robot_torque"], ["both"]),
        (["0", "--to", "."], ["--to", "a new file"]),
    ],
)
def test_wrong_wishes_are_explained(run: Path, arguments: list[str], words: list[str]) -> None:
    done = evodesign("polish", run, *arguments)
    assert done.returncode == 2, done.stderr
    assert len(done.stderr.strip().splitlines()) == 1
    for word in words:
        assert word in done.stderr
