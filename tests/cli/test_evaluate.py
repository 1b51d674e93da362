"""Everything that is made ready once only saves time: with and without it the answers are the same."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.cli.here import evodesign

pytestmark = pytest.mark.slow

COMMAND = [sys.executable, "-c", "from evodesign.__main__ import main; main()"]


def evaluate(problem: Path, environment: dict[str, str], *options: str) -> tuple[dict, str]:
    command = [*COMMAND, "evaluate", str(problem), *options, "--json"]
    done = subprocess.run(
        command, capture_output=True, text=True, timeout=300, check=True, env={**os.environ, **environment}
    )
    return without_seconds(json.loads(done.stdout)), done.stderr


def without_seconds(value):
    if isinstance(value, dict):
        return {key: without_seconds(item) for key, item in value.items() if key != "seconds"}
    return [without_seconds(item) for item in value] if isinstance(value, list) else value


@pytest.fixture(scope="module")
def quick(repository: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The point-grasp problem at one height."""
    place = tmp_path_factory.mktemp("quick")
    text = (repository / "problems" / "point_grasp.toml").read_text()
    text = text.replace("heights_m = [0.8, 1.0, 1.2]", "heights_m = [1.0]")
    text = text.replace("robots/icub_shapes.urdf", str(repository / "problems/robots/icub_shapes.urdf"))
    text = text.replace('start = "../populations/icub.toml"', "") + "[solver]\nstart_portfolio = false\n"
    (place / "problem.toml").write_text(text)
    return place / "problem.toml"


@pytest.fixture(scope="module")
def cold(quick: Path) -> tuple[dict, str]:
    """The answer, and what was said, when nothing was ready; it then lies beside the problem."""
    return evaluate(quick, {"EVODESIGN_CACHE": str(quick.parent / "cache")})


def test_cache_does_not_change_an_answer(quick: Path, cold: tuple[dict, str]) -> None:
    warm, second = evaluate(quick, {"EVODESIGN_CACHE": str(quick.parent / "cache")})
    assert "ready" not in cold[1] + second
    assert cold[0] == warm


@pytest.mark.needs_compiler
def test_without_a_compiler_ipopt_finds_the_same(quick: Path, cold: tuple[dict, str], tmp_path: Path) -> None:
    ipopt, _ = evaluate(quick, {"EVODESIGN_CACHE": str(tmp_path / "without"), "CC": "/nowhere/cc"})
    assert cold[0]["objectives"] == pytest.approx(ipopt["objectives"], rel=1e-6)
    assert cold[0]["reach"]["highest_m"] == pytest.approx(ipopt["reach"]["highest_m"], rel=1e-6)
    torques = [answer["heights"][0]["robot"]["torques"] for answer in (cold[0], ipopt)]
    assert torques[0] == pytest.approx(torques[1], abs=1e-3)
    assert any((quick.parent / "cache" / "functions").iterdir())
    assert not list((tmp_path / "without").glob("functions/*"))


def test_symmetry_can_be_chosen_on_the_command_line(quick: Path) -> None:
    answers = {}
    for symmetry in ("on", "polish"):
        answer, _ = evaluate(quick, {"CC": "/nowhere/cc"}, "--symmetry", symmetry)
        answers[symmetry] = answer["heights"][0]
    starts = [attempt["start"] for attempt in answers["polish"]["solver"]["attempts"]]
    assert starts[-1] == "whole: polish"
    assert not any("whole" in attempt["start"] for attempt in answers["on"]["solver"]["attempts"])
    assert answers["polish"]["robot"]["torque_norm"] != answers["on"]["robot"]["torque_norm"]


def test_unknown_symmetry_is_refused(quick: Path) -> None:
    done = evodesign("evaluate", quick, "--symmetry", "polsh")
    assert done.returncode == 2
    assert (
        "--symmetry: wanted one of auto, on, off, polish, found 'polsh'; did you mean 'polish'?"
        in done.stderr
    )


def test_asymmetric_design_is_solved_whole_with_a_note_and_refused_where_symmetry_is_asked_for(
    quick: Path, tmp_path: Path
) -> None:
    text = quick.read_text().replace('links = ["l_upper_arm", "r_upper_arm"]', 'links = ["l_upper_arm"]', 1)
    (tmp_path / "lame.toml").write_text(text)
    done = evodesign("check", tmp_path / "lame.toml")
    assert done.returncode == 0
    assert "note: postures are solved whole, not symmetric: " in done.stderr
    assert "'l_upper_arm' without 'r_upper_arm'" in done.stderr
    done = evodesign("evaluate", tmp_path / "lame.toml", "--symmetry", "on")
    assert done.returncode == 2
    assert "--symmetry: wanted 'auto', 'off', or a scene that is its own mirror image" in done.stderr


def test_figures_of_a_design_need_no_search(quick: Path, cold: tuple[dict, str], tmp_path: Path) -> None:
    place = tmp_path / "new" / "figures"
    _, said = evaluate(quick, {"EVODESIGN_CACHE": str(quick.parent / "cache")}, "--plot", str(place))
    stems = ("postures", "postures_front", "postures_side", "torques", "torques_by_joint")
    assert {path.name for path in place.iterdir()} == {
        f"{s}.{kind}" for s in stems for kind in ("png", "svg")
    }
    assert said.count("note: written: ") == 10
    title = (place / "postures_front.svg").read_text(encoding="utf-8")
    assert "point-grasp, unscaled: postures from the" in title


def test_a_place_for_figures_that_cannot_be_made_is_refused_before_anything_is_solved(
    quick: Path, tmp_path: Path
) -> None:
    (tmp_path / "file").write_text("mine")
    done = evodesign("evaluate", quick, "--plot", tmp_path / "file")
    assert done.returncode == 2
    assert "--plot: wanted a folder that can be written" in done.stderr


@pytest.mark.parametrize(("height", "code", "statuses"), [(1.45, 5, {"infeasible"}), (0.8, 0, {"solved"})])
def test_the_exit_code_says_whether_any_case_is_solved(
    height: float, code: int, statuses: set[str], repository: Path, tmp_path: Path
) -> None:
    text = (repository / "tests" / "golden" / "lifting" / "problem.toml").read_text("utf-8")
    text = text.replace("../../../problems", str(repository / "problems")).replace('start = "start.toml"', "")
    text = text.replace("heights_m = [0.8, 1.0]", f"heights_m = [{height}]")
    (tmp_path / "problem.toml").write_text(text, "utf-8")
    done = evodesign("evaluate", tmp_path / "problem.toml", "--json", "--jobs", 1)
    assert done.returncode == code
    assert {case["status"] for case in json.loads(done.stdout)["heights"]} == statuses
