"""Every example runs from a folder of its own, with a small budget, and prints what it promises."""

from __future__ import annotations

import ast
import os
import subprocess
import sys
from pathlib import Path

import pytest

from evodesign.api.run import open_run
from evodesign.posture.precompute.precomputed import Precomputed

pytestmark = pytest.mark.slow

EXAMPLES = Path(__file__).parents[2] / "examples"


def run_example(name: str, folder: Path, *arguments: str) -> str:
    """What an example prints; it must end well."""
    done = subprocess.run(
        [sys.executable, str(EXAMPLES / name), *arguments],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(EXAMPLES.parent)},
        capture_output=True,
        text=True,
        timeout=900,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def first(known: Precomputed, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    """The folder in which the first search ran, and what it printed."""
    assert known.postures, "worked out before, so that the examples find it in the cache"
    folder = tmp_path_factory.mktemp("first")
    return folder, run_example("first_search.py", folder, "6")


def test_first_search_leaves_run_figure_and_robot(first: tuple[Path, str]) -> None:
    folder, printed = first
    run = open_run(folder / "runs" / "first")
    assert len(run) == 6
    assert all(f"{design.number} {{'robot_torque': " in printed for design in run.front)
    assert (folder / "first_front.html").stat().st_size > 1000
    assert list((folder / "first_robot").rglob("*.urdf"))


def test_reading_a_run(first: tuple[Path, str], tmp_path: Path) -> None:
    printed = run_example("reading_a_run.py", tmp_path, str(first[0] / "runs" / "first"))
    run = open_run(first[0] / "runs" / "first")
    assert f"the front {[design.number for design in run.front]}" in printed
    assert f"largest joint torques of design {run.front[0].number} [N m]" in printed


def test_with_optuna(first: tuple[Path, str], tmp_path: Path) -> None:
    printed = run_example("with_optuna.py", tmp_path, "3", str(first[0] / "runs" / "first"))
    assert "runs.db" in printed
    assert (tmp_path / "runs.db").exists()


@pytest.mark.usefixtures("known")
def test_with_pymoo(tmp_path: Path) -> None:
    printed = run_example("with_pymoo.py", tmp_path, "1")
    assert "8 designs" in printed
    assert "found MOEAD, which takes no constraints" in printed


def test_lift_prints_torques_over_its_time(tmp_path: Path) -> None:
    """From fixed starts: to choose others takes two minutes."""
    folder = EXAMPLES.parent / "problems"
    text = (folder / "icub_lift.toml").read_text().replace('"robots/', f'"{folder}/robots/')
    text = text.replace('"../populations/', f'"{EXAMPLES.parent}/populations/')
    (tmp_path / "lift.toml").write_text(text + "\n[solver]\nstart_portfolio = false\n")
    lines = run_example("lift.py", tmp_path, "lift.toml").splitlines()
    assert lines[0].startswith("0.8 to 1.2 m in 1.5 s: {'robot_torque': ")
    assert [float(line.split()[0]) for line in (lines[2], lines[-1])] == [0.0, 1.5]


@pytest.mark.usefixtures("known")
def test_own_objective_reaches_the_processes(tmp_path: Path) -> None:
    run_example("own_objective.py", tmp_path, "6")
    run = open_run(tmp_path / "runs" / "light")
    assert len(run) == 6
    for design in run.front:
        largest = [
            max(posture.agents["robot"].wrenches[name][2] for name in ("left_foot", "right_foot"))
            for posture in run.postures(design.number or 0)
        ]
        found = design.objectives["own_objective:foot_force"]
        assert found == pytest.approx(sum(largest) / len(largest))


@pytest.mark.usefixtures("known")
def test_own_search_is_resumed(tmp_path: Path) -> None:
    printed = run_example("own_search.py", tmp_path, "12")
    run = open_run(tmp_path / "runs" / "steps")
    assert (len(run), run.log.header.search.algorithm) == (12, "own_search:SmallSteps")
    assert "N m in 12 designs" in printed


def test_own_robot(tmp_path: Path) -> None:
    printed = run_example("own_robot.py", tmp_path, "6")
    assert printed.startswith("solved")
    assert open_run(tmp_path / "runs" / "boxes").front


def test_own_term_narrows_the_reach(tmp_path: Path) -> None:
    without, with_term = run_example("own_term.py", tmp_path).splitlines()
    lowest = [float(line.split("loads from ")[1].split(" ")[0]) for line in (without, with_term)]
    assert lowest[1] > lowest[0] + 0.1


@pytest.mark.parametrize("example", sorted(EXAMPLES.glob("*.py")), ids=lambda path: path.stem)
def test_example_says_what_it_shows_and_is_listed(example: Path) -> None:
    said = ast.get_docstring(ast.parse(example.read_text()))
    assert said
    assert "second" in said or "minute" in said, "how long it takes"
    assert f"python examples/{example.name}" in said
    assert f"]({example.name})" in (EXAMPLES / "README.md").read_text()
    assert f"test_{example.stem}" in Path(__file__).read_text(), "each is run above"
