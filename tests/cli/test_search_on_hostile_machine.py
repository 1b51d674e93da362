"""Searches where shared memory or standard output is missing, or an objective of the user's own raises."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

import pytest

from evodesign.runlog.run import read_run
from tests.machine import leave_out

pytestmark = pytest.mark.slow

COMMAND = (sys.executable, "-c", "from evodesign.__main__ import main; main()")
WITHOUT_SHARED_MEMORY = (
    *("unshare", "--mount", "sh", "-c"),
    'mount -t tmpfs -o ro,size=4k none /dev/shm && exec "$@"',
    "sh",
)
EVALUATIONS = 3
MISTAKEN = """
from evodesign.quantities.objectives import CaseQuantity

torque = CaseQuantity("N m", lambda scene, postures: postures["robto"].torque_norm)
"""


@pytest.fixture
def problem(repository: Path, tmp_path: Path) -> Path:
    """One robot, one person, one height: evaluated in a second."""
    text = (repository / "tests" / "golden" / "lifting" / "problem.toml").read_text("utf-8")
    text = text.replace("../../../problems", str(repository / "problems")).replace('start = "start.toml"', "")
    (tmp_path / "problem.toml").write_text(
        text.replace("heights_m = [0.8, 1.0]", "heights_m = [0.8]"), "utf-8"
    )
    return tmp_path / "problem.toml"


def search(
    problem: Path, *before: str, environment: Mapping[str, str] | None = None
) -> subprocess.CompletedProcess[str]:
    """A search of a generation, after what a shell or another program does first."""
    run = problem.parent / "run"
    sizes = ("--population", str(EVALUATIONS), "--evaluations", str(EVALUATIONS), "--jobs", "1")
    command = [*before, *COMMAND, "search", str(problem), "--run", str(run), *sizes]
    return subprocess.run(
        command, capture_output=True, text=True, check=False, env={**os.environ, **(environment or {})}
    )


def test_without_shared_memory_a_search_is_serial_and_says_so_in_one_line(problem: Path) -> None:
    there = subprocess.run([*WITHOUT_SHARED_MEMORY, "true"], capture_output=True, text=True, check=False)
    if there.returncode:
        leave_out(f"/dev/shm cannot be taken away: {there.stderr.strip()} (as root: unshare)")
    done = search(problem, *WITHOUT_SHARED_MEMORY)
    assert done.returncode == 0, done.stderr
    (note,) = (line for line in done.stderr.splitlines() if "/dev/shm" in line)
    assert note.startswith("note: no worker processes (semaphores in /dev/shm: ")
    assert "arning" not in done.stderr
    run = read_run(problem.parent / "run")
    assert [evaluation.feasible for evaluation in run.evaluations] == [True] * EVALUATIONS


@pytest.mark.parametrize("closed", [">&-", "2>&-", "<&- >&- 2>&-"])
def test_closed_streams_cost_a_search_nothing(closed: str, problem: Path) -> None:
    done = search(problem, "sh", "-c", f'exec "$@" {closed}', "sh")
    assert done.returncode == 0, done.stderr
    assert "Traceback" not in done.stderr
    run = read_run(problem.parent / "run")
    assert run.complete
    assert not run.notes
    assert [evaluation.feasible for evaluation in run.evaluations] == [True] * EVALUATIONS


def test_an_objective_that_raises_ends_a_search_with_its_reason_and_costs_nothing(problem: Path) -> None:
    (problem.parent / "of_mine.py").write_text(MISTAKEN)
    problem.write_text(
        problem.read_text("utf-8").replace('"worst_human_torque"', '"of_mine:torque"'), "utf-8"
    )
    path = f"{problem.parent}{os.pathsep}{os.environ.get('PYTHONPATH', '')}"
    done = search(problem, environment={"EVODESIGN_MODULES": "of_mine", "PYTHONPATH": path})
    assert done.returncode == 5
    last = done.stderr.splitlines()[-1]
    assert last.startswith(
        f"error: the first {EVALUATIONS} evaluations of this session all failed for one reason"
    )
    assert "KeyError: 'robto' (of_mine.py:4 in <lambda>)" in last
    assert f"evodesign resume {problem.parent / 'run'}" in last
    assert read_run(problem.parent / "run").evaluations == ()
