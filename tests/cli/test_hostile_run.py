"""Runs that came from elsewhere: whatever lies in them, every command ends in a sentence and in time."""

from __future__ import annotations

import json
import os
import select
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import msgspec
import pytest
import zstandard

from evodesign.evolve import start
from evodesign.records import Evaluation, RunHeader
from evodesign.runlog.channels import DETAIL, EVALUATION, FRONT, GENERATION, RUN
from evodesign.runlog.session_log import Silent
from tests.cli import limited
from tests.faults.synthetic import synthetic_header
from tests.runlog import crafted
from tests.runlog.toys import OrderedPool, ToyTask, toy_detail, toy_evaluations, toy_generation

HEADER = synthetic_header(budget=12, seed=4, population=12)
EVALUATIONS = toy_evaluations(HEADER, 12)
COMMANDS = (*limited.commands(Path(), Path()),)

Found = dict[str, tuple[int, str, str]]
EveryCommand = Callable[[Path], Found]

LONG = 600.0
"""A wait [s] that only a command that hangs takes."""


def prepared(work: Path) -> Path:
    """A folder with a sound run to compare with, and a directory for a hostile one."""
    start(work / "sound", HEADER, ToyTask(HEADER), OrderedPool(), Silent())
    (work / "run").mkdir()
    return work


@pytest.fixture
def work(tmp_path: Path) -> Path:
    return prepared(tmp_path)


@pytest.fixture(scope="module")
def every_command() -> Iterator[EveryCommand]:
    """Calls every command on a hostile run; all that they need is imported once."""
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
    with subprocess.Popen([sys.executable, limited.__file__], text=True, **pipes) as caller:

        def call(work: Path) -> Found:
            assert caller.stdin is not None
            assert caller.stdout is not None
            print(work, file=caller.stdin, flush=True)
            assert select.select([caller.stdout], [], [], LONG)[0], "a command hangs"
            assert caller.stdout.readline() == "\n"
            return found_in(work)

        try:
            yield call
            caller.communicate(timeout=LONG)
            assert caller.returncode == 0
        finally:
            caller.kill()


def found_in(work: Path) -> Found:
    """Exit code, output and errors of every command on a hostile run."""
    assert (work / "found.json").exists(), "a command took too long"
    found: Found = json.loads((work / "found.json").read_text())
    assert tuple(found) == COMMANDS
    for name, (_, _, errors) in found.items():
        assert "Traceback" not in errors, f"{name}: {errors[-3000:]}"
    return found


def sound_copy(work: Path, *segments: int) -> None:
    """The sound run's only segment under other numbers."""
    for number in segments:
        (work / f"run/{number:03d}.mcap").write_bytes((work / "sound/000.mcap").read_bytes())


def pipe(work: Path) -> None:
    sound_copy(work, 0)
    os.mkfifo(work / "run/001.mcap")


def device(work: Path) -> None:
    (work / "run/000.mcap").symlink_to("/dev/zero")


def link_elsewhere(work: Path) -> None:
    (work / "run/000.mcap").symlink_to(work / "sound/000.mcap")


def folder(work: Path) -> None:
    sound_copy(work, 0)
    (work / "run/001.mcap").mkdir()


@pytest.mark.parametrize(
    ("make", "kind"),
    [
        (pipe, "001.mcap: wanted a file, found a named pipe"),
        pytest.param(device, "000.mcap: wanted a file, found a symbolic link", marks=pytest.mark.slow),
        pytest.param(
            link_elsewhere, "000.mcap: wanted a file, found a symbolic link", marks=pytest.mark.slow
        ),
        pytest.param(folder, "001.mcap: wanted a file, found a directory", marks=pytest.mark.slow),
    ],
)
def test_what_is_no_regular_file_is_refused_by_every_command(
    make: Callable[[Path], None], kind: str, work: Path, every_command: EveryCommand
) -> None:
    make(work)
    for name, (code, _, errors) in every_command(work).items():
        assert (code, kind in errors, errors.count("\n")) == (2, True, 1), f"{name}: {errors}"


@pytest.mark.slow
def test_a_lock_that_is_a_pipe_or_a_link_holds_nobody_up(work: Path, every_command: EveryCommand) -> None:
    sound_copy(work, 0)
    os.mkfifo(work / "run/lock")
    assert every_command(work)["resume"][0] in (0, 2)
    (work / "run/lock").unlink()
    (work / "found.json").unlink()
    (work / "run/lock").symlink_to(work / "made elsewhere")
    found = every_command(work)
    assert "cannot be locked" in found["resume"][2]
    assert not (work / "made elsewhere").exists()


def test_a_sparse_segment_of_ten_gigabytes_is_refused_by_every_command(
    work: Path, every_command: EveryCommand
) -> None:
    with (work / "run/000.mcap").open("wb") as file:
        file.truncate(10 * 10**9)
    for name, (code, _, errors) in every_command(work).items():
        assert (code, errors.count("\n")) == (2, 1), f"{name}: {errors}"


@pytest.mark.slow
@pytest.mark.parametrize(("share", "evaluations"), [(0.37, range(1, 12)), (0.9, range(12, 13))])
def test_what_stands_around_a_hole_of_ten_gigabytes_is_read(
    share: float, evaluations: range, work: Path, every_command: EveryCommand
) -> None:
    """The hole is among the evaluations, or in the index after them."""
    content = (work / "sound/000.mcap").read_bytes()
    place = int(share * len(content))
    with (work / "run/000.mcap").open("wb") as file:
        file.write(content[:place])
        file.seek(10 * 10**9)
        file.write(content[place:])
    found = every_command(work)
    assert found["front"][0] == 4
    assert "note: 000.mcap " in found["front"][2]
    recovered = found["recover"]
    assert recovered[0] == 0
    assert any(f" {count} evaluations, " in recovered[1] for count in evaluations), recovered


def plain(value: Any) -> Any:
    return msgspec.to_builtins(value)


def evaluation(**changes: Any) -> bytes:
    return crafted.told(EVALUATION, plain(EVALUATIONS[3]) | changes, 3)


def assessment(**changes: Any) -> bytes:
    return evaluation(assessment=plain(EVALUATIONS[3].assessment) | changes)


def bomb() -> bytes:
    """A chunk of 98 kB that declares 3 GiB of zeros, as it holds."""
    packer = zstandard.ZstdCompressor(level=1).compressobj(size=3 * 2**30)
    part = bytes(2**24)
    data = b"".join(packer.compress(part) for _ in range(3 * 2**30 // len(part))) + packer.flush()
    return crafted.compressed_chunk(data, 3 * 2**30, 0)


def many_bombs() -> bytes:
    """Chunks that declare as much as a sound one may, again and again."""
    full = bytes(8 * 2**20 - 1000)
    unfit = evaluation(worker=full.decode())
    return crafted.chunk(unfit) * 400


def nested_chunks() -> bytes:
    """Each of many chunks declares to reach to the end of the file, and none is sound."""
    prefix = zstandard.compress(bytes(100_000))[:18]
    step = len(crafted.compressed_chunk(prefix, 100_000, 1))
    count = 40_000
    return b"".join(
        crafted.record(6, crafted.compressed_chunk(prefix, 100_000, 1)[9:])[:9].replace(
            (step - 9).to_bytes(8, "little"), ((count - each) * step - 9).to_bytes(8, "little")
        )
        + crafted.compressed_chunk(prefix, 100_000, 1)[9:]
        for each in range(count)
    )


DEEP = b"[" * 200_000

CONTENTS: dict[str, Callable[[], bytes]] = {
    "a record without its length": lambda: crafted.chunk(b"\x05" + b"\xff" * 7),
    "a record longer than its chunk": lambda: crafted.chunk(b"\x05" + b"\xff" * 8),
    "a message too short": lambda: crafted.chunk(crafted.record(5, b"abc")),
    "a channel too short": lambda: crafted.chunk(crafted.record(4, b"abc")),
    "a topic that is no UTF-8": lambda: crafted.chunk(crafted.channels([b"\xff"])),
    "no JSON": lambda: crafted.chunk(crafted.message(EVALUATION, b"abc")),
    "JSON that is no UTF-8": lambda: crafted.chunk(crafted.message(EVALUATION, b'{"number":"\xff"}')),
    "nested JSON": lambda: crafted.chunk(crafted.message(EVALUATION, DEEP)),
    "a nested problem": lambda: crafted.chunk(crafted.message(RUN, b'{"format_version":1,"problem":' + DEEP)),
    "a long number": lambda: crafted.chunk(crafted.message(EVALUATION, b"9" * 1_000_000)),
    "three GiB of zeros": bomb,
    "many large records": many_bombs,
    "nested chunks": nested_chunks,
    "a header without a version": lambda: crafted.chunk(crafted.told(RUN, {"problem": 1})),
    "a header without parameters": lambda: crafted.chunk(
        crafted.told(RUN, plain(HEADER) | {"parameters": []})
    ),
    "a design of nothing": lambda: crafted.chunk(assessment(design={})),
    "a genome that is too short": lambda: crafted.chunk(evaluation(genome=[0.5])),
    "an unknown objective": lambda: crafted.chunk(assessment(objectives={"speed": 1.0})),
    "a number below zero": lambda: crafted.chunk(evaluation(number=-1)),
    "a number beyond all": lambda: crafted.chunk(evaluation(number=10**18)),
    "a turn without turns": lambda: crafted.chunk(evaluation(turn={"number": 0, "told": 0})),
    "a state of many evaluations": lambda: crafted.chunk(
        crafted.told(GENERATION, plain(toy_generation(0, 10**15)))
    ),
    "a front of strangers": lambda: crafted.chunk(
        crafted.told(FRONT, {"generation": 0, "evaluations": [10**9, 5]})
    ),
    "postures of nobody": lambda: crafted.chunk(
        crafted.told(
            DETAIL,
            plain(toy_detail(EVALUATIONS[3]))
            | {"cases": [plain(toy_detail(EVALUATIONS[3]).cases[0]) | {"instants": []}]},
        )
    ),
    "a copy of the header that is none": lambda: crafted.attachment(b"abc"),
}


@pytest.mark.parametrize(
    "name",
    [
        *[*CONTENTS][:5],
        *(pytest.param(name, marks=pytest.mark.slow) for name in [*CONTENTS][5:]),
    ],
)
def test_crafted_content_with_right_checksums_costs_itself_and_nothing_else(
    name: str, work: Path, every_command: EveryCommand
) -> None:
    """With sound evaluations around it."""
    parts = [
        crafted.chunk(crafted.channels() + crafted.told(RUN, plain(HEADER))),
        *(crafted.chunk(crafted.told(EVALUATION, plain(each), each.number)) for each in EVALUATIONS[:2]),
        CONTENTS[name](),
        *(crafted.chunk(crafted.told(EVALUATION, plain(each), each.number)) for each in EVALUATIONS[4:]),
    ]
    (work / "run/000.mcap").write_bytes(crafted.segment(parts))
    found = every_command(work)
    code, out, errors = found["front"]
    assert "Front of" in out
    assert (code == 0) == (name in HARMLESS), errors
    recovered = found["recover"]
    assert recovered[0] == 0, recovered
    assert "10 evaluations" in recovered[1]
    assert (found["verify"][0] == 0) <= (name in HARMLESS)
    assert {code for code, _, _ in found.values()} <= {0, 2, 4}


HARMLESS = ("a copy of the header that is none",)
"""What nothing is read from as long as there is a header."""


def test_the_types_of_the_crafted_records_are_those_of_the_log() -> None:
    assert msgspec.convert(plain(HEADER), RunHeader) == HEADER
    assert msgspec.convert(plain(EVALUATIONS[3]), Evaluation) == EVALUATIONS[3]
