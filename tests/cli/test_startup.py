"""A command loads only what it needs: the list of commands no numbers, a look at a run no solver."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from evodesign.evolve import start
from evodesign.runlog.session_log import Silent
from tests.faults.synthetic import synthetic_header
from tests.runlog.toys import OrderedPool, ToyTask, shuffled

HEAVY = ("casadi", "pinocchio")
READERS = ("trimesh", "collada", "fast_simplification")


def loaded(code: str, names: tuple[str, ...]) -> str:
    code = f"import sys\n{code}\nprint([name for name in {names} if name in sys.modules], file=sys.stderr)"
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stderr


def test_commands_are_listed_without_what_they_need() -> None:
    names = (*HEAVY, "numpy", "msgspec", "rich", "mcap", "pymoo", "plotly", "matplotlib", *READERS)
    assert loaded("import evodesign.cli.main", names) == "[]\n"


def test_a_problem_is_read_without_readers_of_meshes_until_it_shows_one() -> None:
    code = "from evodesign.problem.source import read_source\nread_source('icub-lifting')"
    assert loaded(code, READERS) == "[]\n"


def test_a_run_is_looked_at_without_a_solver(tmp_path: Path) -> None:
    """Commands one after the other, and what has been loaded after each: the first that loads one is seen."""
    header = synthetic_header(budget=20, seed=4, population=10)
    for run in ("run", "other"):
        start(tmp_path / run, header, ToyTask(header), OrderedPool(shuffled(1)), Silent())
    lines = [f"{command} run" for command in ("front", "verify", "watch --once", "merge", "recover")]
    code = (
        f"import os\nos.chdir({str(tmp_path)!r})\nfrom evodesign.cli.main import app\n"
        f"for line in {[*lines, 'compare run other']}:\n"
        "    app(line.split(), standalone_mode=False)\n"
        f"    assert not {set(HEAVY)} & set(sys.modules), line"
    )
    assert loaded(code, HEAVY).endswith("[]\n")
