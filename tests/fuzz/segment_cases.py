"""Cases of segments with right checksums and wrong content, by number, and what must be true of each."""

from __future__ import annotations

import json
import random
from collections.abc import Callable
from pathlib import Path
from typing import Any

import msgspec

from evodesign.analysis.audit import audit, losses
from evodesign.analysis.front import front
from evodesign.errors import EvodesignError, RunError
from evodesign.evolve import replay, start
from evodesign.records import Evaluation
from evodesign.report.page import page_content
from evodesign.runlog.channels import RECORDS
from evodesign.runlog.follow import Follower
from evodesign.runlog.reader import entries
from evodesign.runlog.rewrite import merge, recover
from evodesign.runlog.run import RunLog, read_run
from evodesign.runlog.session_log import Silent
from tests.faults.synthetic import synthetic_header
from tests.runlog import crafted
from tests.runlog.toys import OrderedPool, ToyTask, shuffled

Message = tuple[str, Any, int]
"""Topic, JSON and number."""

HEADER = synthetic_header(budget=24, seed=4, population=12)
STRANGE: tuple[Any, ...] = (
    *(None, True, "", "x", "\x1b[2J", "\u202e", "a" * 5000, [], {}, [[]], {"a": 1}, -1, 0, 1, 2, 0.5, -0.0),
    *(
        1e308,
        -1e308,
        1e-320,
        2**31,
        2**53 + 1,
        2**63,
        2**64,
        10**30,
        "minimise",
        "cma-es",
        "random",
        "solved",
    ),
)


def sound_run(directory: Path) -> RunLog:
    """A run without a fault, always the same but for times."""
    return start(directory, HEADER, ToyTask(HEADER), OrderedPool(shuffled(1)), Silent())


def messages_of(run: RunLog) -> list[Message]:
    """Every message of a run of one segment."""
    return [
        (entry.topic, msgspec.to_builtins(entry.record), entry.sequence)
        for entry in entries(run.directory / "000.mcap")
    ]


def places(value: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Where something stands in a JSON value."""
    inner = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    return [path, *(place for key, each in inner for place in places(each, (*path, key)))]


def with_a_strange_value(value: Any, chance: random.Random) -> Any:
    value = json.loads(json.dumps(value))
    path = chance.choice(places(value))
    if not path:
        return chance.choice(STRANGE)
    parent = value
    for key in path[:-1]:
        parent = parent[key]
    key = path[-1]
    way = chance.randrange(4)
    if way == 0 and isinstance(parent, dict):
        del parent[key]
    elif way == 1 and isinstance(parent, dict):
        parent[chance.choice(["", "stranger", "number", "robot"])] = parent[key]
    elif way == 2 and isinstance(parent, list):
        parent.insert(key, parent[key])
    else:
        parent[key] = chance.choice(STRANGE)
    return value


def with_changed_bytes(data: bytes, chance: random.Random) -> bytes:
    changed = bytearray(data)
    for _ in range(chance.randrange(1, 6)):
        place = chance.randrange(len(changed))
        changed[place : place + chance.randrange(3)] = chance.randbytes(chance.randrange(3))
    return bytes(changed) or b"\0"


def spoilt_part(part: bytes, message: Message, first: bool, chance: random.Random) -> bytes:
    """A chunk's records with another value, topic or other bytes, or twice."""
    topic, value, number = message
    described = crafted.channels() if first else b""
    match chance.choices(range(5), weights=(6, 2, 3, 1, 1))[0]:
        case 0:
            return described + crafted.told(topic, with_a_strange_value(value, chance), number)
        case 1:
            data = with_changed_bytes(msgspec.json.encode(value), chance)
            return described + crafted.message(topic, data, number)
        case 2:
            return with_changed_bytes(part, chance)
        case 3:
            return described + crafted.told(chance.choice([*RECORDS]), value, number)
    return part * 2


def spoilt(messages: list[Message], number: int) -> bytes:
    """A segment with one to three victims; a message that is only left out is the only one."""
    chance = random.Random(number)
    parts = [crafted.told(topic, value, number) for topic, value, number in messages]
    parts[0] = crafted.channels() + parts[0]
    if chance.randrange(8) == 0:
        del parts[chance.randrange(1, len(parts))]
        return crafted.segment(map(crafted.chunk, parts))
    for _ in range(chance.randrange(1, 4)):
        victim = chance.randrange(len(parts))
        parts[victim] = spoilt_part(parts[victim], messages[victim], victim == 0, chance)
    return crafted.segment(map(crafted.chunk, parts))


def examine(folder: Path, content: bytes, written: RunLog) -> bool:
    """Use a run with this segment in every way; whether it was read.

    Args:
        folder: empty, for the run and what is made of it.
        content: of the segment.
        written: the run without a fault.
    Raises:
        AssertionError: a changed front without a note, or a difference between the ways.
    """
    directory = folder / "spoilt"
    directory.mkdir()
    (directory / "000.mcap").write_bytes(content)
    run, refusal = _read(directory)
    followed = _followed(directory)
    if run is None:
        assert "000.mcap" in refusal
        assert refusal.isprintable()
        for way in (recover, merge):
            assert _refused(way, directory, folder / "refused"), f"{way.__name__} accepts what is refused"
        return False
    assert not followed, f"it is read, and cannot be followed: {followed}"
    assert all(note.isprintable() for note in run.notes)
    found = {each.number: each for each in run.evaluations}
    assert run.damaged or {each.number for each in written.evaluations} <= found.keys()
    losses(run)
    faults = audit(run)
    try:
        replay(run)
    except EvodesignError as error:
        faults.append(str(error))
    assert run.notes or faults or not _changed(run, written)
    assert recover(directory, folder / "recovered").evaluations == run.evaluations
    if not run.damaged:
        assert merge(directory, folder / "merged.mcap").evaluations == run.evaluations
    page_content(run, ())
    return True


def _read(directory: Path) -> tuple[RunLog | None, str]:
    try:
        return read_run(directory), ""
    except RunError as error:
        return None, str(error)


def _followed(directory: Path) -> str:
    """Why a run cannot be followed; empty if it can."""
    try:
        Follower(directory).look()
    except RunError as error:
        return str(error)
    return ""


def _refused(way: Callable[[Path, Path], RunLog], directory: Path, to: Path) -> bool:
    try:
        way(directory, to)
    except RunError:
        return True
    return False


def _changed(run: RunLog, written: RunLog) -> bool:
    """Whether designs of the front or their results differ, beside times and workers."""
    return _essence(run) != _essence(written)


def _essence(run: RunLog) -> list[Evaluation]:
    members = front(run.header.objectives, run.evaluations)
    return [
        msgspec.structs.replace(
            each,
            seconds=0.0,
            worker="",
            assessment=msgspec.structs.replace(
                each.assessment, reason="", reach=None, cases=(), status="solved"
            ),
        )
        for each in members
    ]
