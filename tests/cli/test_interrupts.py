"""Ctrl-C at any moment, once or more: an exit code that says whether there is a run to resume."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

import pytest

from evodesign.evolve import start
from evodesign.interrupts import Interrupts
from evodesign.posture.precompute.precomputed import Precomputed
from evodesign.runlog.directory import segments
from evodesign.runlog.run import read_run
from evodesign.runlog.session_log import Silent
from tests.faults.synthetic import synthetic_header
from tests.runlog.toys import OrderedPool, ToyTask

BEGUN = "begun"
SAYING = f"""
from evodesign.__main__ import main
from evodesign.interrupts import Interrupts

def begin(interrupts, begin=Interrupts.begin):
    begin(interrupts)
    print("{BEGUN}", flush=True)

Interrupts.begin = begin
main()
"""
COMMAND = [sys.executable, "-c", SAYING]
"""The command line, which says a word as soon as it heeds Ctrl-C."""

LONG = 300.0
"""A wait [s] that only a command that hangs takes."""
HEADER = synthetic_header(budget=20, seed=4, population=10)


def interrupted(arguments: Sequence[str | Path], delays: Sequence[float]) -> subprocess.CompletedProcess[str]:
    """A command that gets Ctrl-C, as all of its terminal does, after each of the delays [s] from its word."""
    command = [*COMMAND, *map(str, arguments)]
    pipe = subprocess.PIPE
    with subprocess.Popen(command, stdout=pipe, stderr=pipe, text=True, start_new_session=True) as process:
        try:
            assert process.stdout is not None
            assert process.stdout.readline().strip() == BEGUN
            for delay in delays:
                try:
                    process.wait(delay)
                except subprocess.TimeoutExpired:
                    os.killpg(process.pid, signal.SIGINT)
            output, errors = process.communicate(timeout=LONG)
        finally:
            process.kill()
    return subprocess.CompletedProcess(command, process.returncode, output, errors)


def check(done: subprocess.CompletedProcess[str], run: Path) -> None:
    assert "Traceback" not in done.stderr, done.stderr
    assert "Error" not in done.stderr, done.stderr
    assert "resource_tracker" not in done.stderr, done.stderr
    if segments(run):
        assert done.returncode in (0, 3), done.stderr
        assert done.returncode == 0 or f"evodesign resume {run}" in done.stderr
        assert read_run(run).header.budget == 4000 or done.returncode == 0
    else:
        assert done.returncode == 130
        assert done.stderr.splitlines()[-1] == "stopped"


AGAIN = ((), (0.05,), (0.4, 0.1))
"""After how many seconds the next signals follow the first."""

MOMENTS = [(delay, *AGAIN[place % len(AGAIN)]) for place, delay in enumerate((0.02, 0.4, 0.8, 1.6, 2.5, 4.0))]


@pytest.mark.parametrize(
    "delays",
    [
        (0.03,),
        (1.0, 0.2),
        (2.0, 0.0, 0.0),
        *(pytest.param(delays, marks=pytest.mark.slow) for delays in MOMENTS),
    ],
    ids=str,
)
def test_a_search_that_is_interrupted_says_whether_it_can_be_resumed(
    delays: Sequence[float], known: Precomputed, tmp_path: Path
) -> None:
    assert known.postures, "worked out before, so that a run begins within seconds"
    run = tmp_path / "run"
    sizes = ["--population", "4", "--evaluations", "4000", "--jobs", "2"]
    check(interrupted(["search", "point-grasp", "--run", run, *sizes], delays), run)


@pytest.mark.parametrize(
    "delays",
    [*(pytest.param(each, marks=pytest.mark.slow) for each in ((0.03,), (0.4,))), (0.1, 0.1), (0.6, 0.0)],
    ids=str,
)
@pytest.mark.parametrize("command", ["front", "report"])
def test_a_look_at_a_run_ends_with_130_or_is_done(
    command: str, delays: Sequence[float], tmp_path: Path
) -> None:
    start(tmp_path / "run", HEADER, ToyTask(HEADER), OrderedPool(), Silent())
    before = {path.name for path in (tmp_path / "run").iterdir()}
    done = interrupted([command, tmp_path / "run"], delays)
    assert done.returncode in (0, 130)
    assert "Traceback" not in done.stderr, done.stderr
    assert done.returncode == 0 or done.stderr.splitlines()[-1] == "stopped"
    assert {path.name for path in (tmp_path / "run").iterdir()} - {"report.html"} == before


def test_what_is_done_stays_done_when_its_end_is_interrupted(tmp_path: Path) -> None:
    start(tmp_path / "run", HEADER, ToyTask(HEADER), OrderedPool(), Silent())
    command = [*COMMAND, "front", str(tmp_path / "run"), "--csv"]
    pipe = subprocess.PIPE
    with subprocess.Popen(command, stdout=pipe, stderr=pipe, text=True, start_new_session=True) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        assert process.stdout.readline().strip() == BEGUN
        assert process.stdout.readline().startswith("design,")
        for _ in range(3):
            os.killpg(process.pid, signal.SIGINT)
        assert "Traceback" not in process.stderr.read()
    assert process.returncode in (0, 130)


def test_a_command_in_the_background_ignores_what_its_terminal_sends(tmp_path: Path) -> None:
    start(tmp_path / "run", HEADER, ToyTask(HEADER), OrderedPool(), Silent())
    handler = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        done = interrupted(["front", tmp_path / "run"], (0.0, 0.2, 0.2))
    finally:
        signal.signal(signal.SIGINT, handler)
    assert done.returncode == 0
    assert "the run lies in" in done.stdout


def test_an_interrupt_that_a_library_swallows_is_raised_again() -> None:
    interrupts = Interrupts()
    interrupts.check()
    with suppress(KeyboardInterrupt):
        interrupts.interrupt()
    with pytest.raises(KeyboardInterrupt):
        interrupts.check()


def test_an_interrupt_waits_for_the_module_that_is_loaded(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A library in C++ may abort the process where an exception comes out of its first instructions."""
    (tmp_path / "slowly_loaded.py").write_text(
        "import os, signal, time\nos.kill(os.getpid(), signal.SIGINT)\ntime.sleep(0.1)\nWHOLE = True\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    before = signal.getsignal(signal.SIGINT)
    try:
        Interrupts().work()
        with pytest.raises(KeyboardInterrupt):
            _load_and_wait("slowly_loaded")
    finally:
        signal.signal(signal.SIGINT, before)
        sys.unraisablehook = sys.__unraisablehook__
    assert sys.modules.pop("slowly_loaded").WHOLE


def _load_and_wait(module: str) -> None:
    __import__(module)
    time.sleep(LONG)
