"""A run goes on with the method that solved its designs, or says why it does not."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import msgspec

from evodesign.evolve import start
from evodesign.runlog.session_log import Silent
from tests.faults.synthetic import synthetic_header
from tests.runlog.toys import OrderedPool, ToyTask

COMMAND = [sys.executable, "-c", "from evodesign.__main__ import main; main()"]


def test_a_native_run_is_not_resumed_by_ipopt_unasked(tmp_path: Path) -> None:
    header = synthetic_header(budget=20, seed=4, population=10)
    header = msgspec.structs.replace(header, problem=msgspec.structs.replace(header.problem, method="native"))
    start(tmp_path / "run", header, ToyTask(header), OrderedPool(), Silent())
    done = subprocess.run(
        [*COMMAND, "resume", tmp_path / "run", "--evaluations", "40"],
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
        env={**os.environ, "CC": "/nowhere/cc"},
    )
    assert done.returncode == 2
    assert "solved by the native method" in done.stderr
    assert "no C compiler found ($CC names '/nowhere/cc')" in done.stderr
    assert "--accept-versions" in done.stderr
