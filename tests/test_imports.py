"""Reading a run or testing a search loads no solver and no robot library."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

HEAVY = ("casadi", "pinocchio")


LIGHT = (
    "evodesign.analysis.front",
    "evodesign.analysis.hypervolume",
    "evodesign.runlog.run",
    "evodesign.runlog.writer",
    "evodesign.searches.registry",
    "evodesign.pool.registry",
    "evodesign.evolve",
    "evodesign.report.front_figure",
    "evodesign.report.figures.joint_torques",
    "evodesign.report.figures.posture_figure",
    "evodesign.report.replay.layout",
    "evodesign.report.replay.recording",
    "evodesign.api.run",
    "evodesign.report.opened_design",
    "evodesign.report.live.state",
)


def test_modules_load_without_casadi() -> None:
    """In one process, one after the other: the first that loads it is in the difference."""
    code = (
        "import sys, importlib\n"
        f"for module in {LIGHT}:\n"
        "    importlib.import_module(module)\n"
        f"    print(module, [name for name in {HEAVY} if name in sys.modules])\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines() == [f"{module} []" for module in LIGHT]


def test_evodesign_itself_loads_nothing_and_offers_its_names() -> None:
    heavy = (*HEAVY, "numpy", "pymoo", "plotly", "rich", "mcap")
    code = (
        "import sys, evodesign\n"
        f"print([name for name in {heavy} if name in sys.modules])\n"
        "print([name for name in evodesign.__all__ if not hasattr(evodesign, name)])\n"
        "print(dir(evodesign) == evodesign.__all__, hasattr(evodesign, 'open_rum'))\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines() == ["[]", "[]", "True False"]


def test_the_command_line_is_imported_by_itself_and_its_tests_alone() -> None:
    root = Path(__file__).parents[1]
    files = [path for folder in ("tests", "benchmarks") for path in (root / folder).rglob("*.py")]
    assert [
        path
        for path in files
        if root / "tests" / "cli" not in path.parents
        and re.search(r"^\s*(from|import) evodesign\.cli\b", path.read_text(), re.MULTILINE)
    ] == []
