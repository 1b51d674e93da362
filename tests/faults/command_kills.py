"""Killing commands that write beside a run, or write it anew, at random moments; what must then be true.

A file is the old or the new one, whole; a run in the making is none, or a whole one; the run that was read is
as it was. What is left of an unfinished file has gone when the command has been called again.
"""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from evodesign.evolve import resume, start
from evodesign.files import UNFINISHED
from evodesign.pool.worker import SerialPool
from evodesign.runlog.directory import segments
from evodesign.runlog.run import RunLog, read_run
from evodesign.runlog.session_log import Silent
from tests.faults.kills import LONGEST, ROOT, Tally
from tests.faults.synthetic import Synthetic, synthetic_header
from tests.runlog.toys import essence

BUDGET, POPULATION = 64, 16
SEGMENTS = 3
OLD = b"the old page"

ENDS = (0, 2, 4)
"""Exit codes: done; refused, since a branch of a synthetic problem cannot go on; from a damaged run."""

WRITING = 0.02
"""Seconds between the first sight of an unfinished file and a kill, at most."""


@dataclass(frozen=True)
class Command:
    """A command that is killed.

    Args:
        arguments: on a run, in a folder for what it writes.
        check: raises an AssertionError unless what a kill left is sound; is given the run as it was.
        done: raises one unless all is there after an undisturbed call.
    """

    arguments: Callable[[Path, Path], list[str]]
    check: Callable[[Path, Path, RunLog], None]
    done: Callable[[Path, Path, RunLog], None]


def kill_command(folder: Path, kills: int, name: str, seed: int, chance: random.Random) -> Tally:
    """Kill a command again and again, then let it end.

    Args:
        folder: for the run and what the command writes.
        kills: how often.
        name: of the command.
        seed: of the run.
        chance: of the run's end, and of the moments.
    """
    command, tally = COMMANDS[name], Tally()
    run, out = folder / "run", folder / "out"
    out.mkdir(parents=True)
    _write_killed_run(run, seed, chance)
    before, contents = read_run(run), _contents(run)
    seconds = _prepare(name, run, out)
    while tally.kills.total() < kills:
        tally.sessions += 1
        if doing := _killed(command.arguments(run, out), run, out, seconds, chance):
            tally.kills[f"{name}, {doing}"] += 1
        command.check(run, out, before)
        if name != "merge":
            assert _contents(run) == contents, "the run was changed"
        for file, content in contents.items():  # to be merged again
            (run / file).write_bytes(content)
    _finish(command.arguments(run, out))
    command.done(run, out, before)
    left = [path for place in (run, out) for path in place.rglob("*.part")]
    assert not left, f"left behind: {left}"
    return tally


def _write_killed_run(run: Path, seed: int, chance: random.Random) -> None:
    """A run of several segments, the last of which ends where its session was killed."""
    for number in range(SEGMENTS):
        header = synthetic_header(BUDGET * (number + 1) // SEGMENTS, seed, population=POPULATION)
        task = Synthetic(header, 0.0)
        if number == 0:
            start(run, header, task, SerialPool(), Silent())
        else:
            resume(run, lambda header: Synthetic(header, 0.0), SerialPool(), Silent(), header.budget)
    last = max(segments(run).items())[1]
    content = last.read_bytes()
    last.write_bytes(content[: chance.randint(len(content) // 2, len(content) - 1)])


def _contents(run: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in run.glob("*.mcap")}


def _prepare(name: str, run: Path, out: Path) -> float:
    """What a first, undisturbed call writes is kept to compare with; the seconds that it takes."""
    reference = out / "undisturbed"
    reference.mkdir()
    begun = time.monotonic()
    if name == "merge":
        _finish(["merge", str(run), "--to", str(reference / "merged.mcap")])
    else:
        printed = _finish(COMMANDS[name].arguments(run, reference))
        (reference / "printed").write_bytes(printed)
    seconds = time.monotonic() - begun
    for path in reference.glob("*.html"):
        (out / path.name).write_bytes(OLD)
    return seconds


def _called(arguments: list[str], output: int) -> subprocess.Popen[bytes]:
    return subprocess.Popen(
        [sys.executable, "-m", "evodesign", *arguments],
        cwd=ROOT,
        env=os.environ | {"PYTHONPATH": str(ROOT), "PYTHONWARNINGS": "ignore"},
        stdout=output,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )


def _finish(arguments: list[str]) -> bytes:
    """What a call that nobody disturbs prints."""
    with tempfile.TemporaryFile() as output:
        code = _called(arguments, output.fileno()).wait(LONGEST)
        assert code in ENDS, f"{arguments}: {code}"
        output.seek(0)
        return output.read()


def _killed(arguments: list[str], run: Path, out: Path, seconds: float, chance: random.Random) -> str:
    """Call a command and kill it at a moment of its life, or soon after a file of it is seen.

    Returns:
        What it was doing, as far as that can be seen; empty if it had ended.
    """
    moment, writing = chance.random(), chance.random() < 0.6
    before = _unfinished(run, out)
    with (out / "printed").open("wb") as printed:
        process = _called(arguments, printed.fileno())
        if writing:
            end = time.monotonic() + LONGEST
            while process.poll() is None and _unfinished(run, out) <= before and time.monotonic() < end:
                time.sleep(0.0005)
            time.sleep(WRITING * moment**2)
        else:
            with suppress(subprocess.TimeoutExpired):
                process.wait(1.2 * seconds * moment)
        process.kill()
        killed = process.wait() == -signal.SIGKILL
    doing = "at other times" if _unfinished(run, out) <= before else "with a file half written"
    return doing if killed else ""


def _unfinished(run: Path, out: Path) -> set[tuple[Path, int]]:
    """Files that are not finished, and when each was changed."""
    found = set()
    for path in (path for place in (run, out, out / "new") for path in place.glob("*.part")):
        with suppress(FileNotFoundError):
            found.add((path, path.stat().st_ctime_ns))
    return found


# What each command is called with, and what must be true when it was killed and when it was not


def _whole_page(name: str) -> Callable[[Path, Path, RunLog], None]:
    def check(run: Path, out: Path, before: RunLog) -> None:
        page, new = (out / name).read_bytes(), (out / "undisturbed" / name).read_bytes()
        assert page in (OLD, new), f"a page of {len(page)} bytes is neither the old one nor the new one"
        if page == new:
            (out / name).write_bytes(OLD)

    return check


def _new_page(name: str) -> Callable[[Path, Path, RunLog], None]:
    def done(run: Path, out: Path, before: RunLog) -> None:
        assert (out / name).read_bytes() == (out / "undisturbed" / name).read_bytes()
        assert not [path for path in out.iterdir() if UNFINISHED.fullmatch(path.name)]

    return done


def _prefix(run: Path, out: Path, before: RunLog) -> None:
    whole = (out / "undisturbed/printed").read_bytes()
    assert whole.startswith((out / "printed").read_bytes()), "it printed something else"


def _nothing(run: Path, out: Path, before: RunLog) -> None:
    """Nothing is to be there."""


def _same_run(run: Path, out: Path, before: RunLog) -> None:
    merged = read_run(run)
    assert essence(merged) == essence(before)
    assert merged.details == before.details
    assert not merged.damaged, merged.faults


def _merged(run: Path, out: Path, before: RunLog) -> None:
    _same_run(run, out, before)
    assert list(segments(run)) == [0]


def _no_run_or_whole(run: Path, out: Path, before: RunLog) -> None:
    new = out / "new"
    if segments(new):
        _whole_run(run, out, before)
        for path in new.iterdir():
            path.unlink()


def _whole_run(run: Path, out: Path, before: RunLog) -> None:
    undisturbed, new = read_run(out / "undisturbed/new"), read_run(out / "new")
    assert essence(new) == essence(undisturbed)
    assert new.details == undisturbed.details
    assert new.complete
    assert not new.damaged


COMMANDS: dict[str, Command] = {
    "report": Command(
        lambda run, out: ["report", str(run), "--output", str(out / "report.html")],
        _whole_page("report.html"),
        _new_page("report.html"),
    ),
    "front --plot": Command(
        lambda run, out: ["front", str(run), "--plot", str(out / "front.html")],
        _whole_page("front.html"),
        _new_page("front.html"),
    ),
    "front": Command(lambda run, out: ["front", str(run), "--csv"], _prefix, _nothing),
    "merge": Command(lambda run, out: ["merge", str(run)], _same_run, _merged),
    "recover": Command(
        lambda run, out: ["recover", str(run), "--to", str(out / "new")], _no_run_or_whole, _whole_run
    ),
    "branch": Command(
        lambda run, out: [
            *("branch", str(run), "--branch-from", "1", "--run", str(out / "new")),
            *("--seed", "7", "--pool", "serial"),
        ],
        _no_run_or_whole,
        _whole_run,
    ),
}
"""By the name under which their kills are counted."""
