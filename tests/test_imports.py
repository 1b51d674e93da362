"""Reading a run or testing a search loads no solver and no robot library."""

from __future__ import annotations

import subprocess
import sys

import pytest

HEAVY = ("casadi", "pinocchio")


@pytest.mark.parametrize(
    "module",
    [
        "evodesign.analysis.front",
        "evodesign.analysis.hypervolume",
        "evodesign.runlog.run",
        "evodesign.runlog.writer",
        "evodesign.search.registry",
        "evodesign.pool.registry",
        "evodesign.evolve",
        "evodesign.cli.fronts",
        "evodesign.cli.showing",
        "evodesign.report.front_figure",
        "evodesign.report.figures.joint_torques",
        "evodesign.report.figures.posture_figure",
        "evodesign.report.figures.torque_boxes",
        "evodesign.report.replay.layout",
        "evodesign.report.replay.recording",
        "evodesign.api.opened_run",
        "evodesign.cli.watching",
        "evodesign.cli.comparing",
    ],
)
def test_module_loads_without_casadi(module: str) -> None:
    code = f"import sys, {module}; print([name for name in {HEAVY} if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


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
