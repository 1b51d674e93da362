"""The fuzzer (`make fuzz MINUTES=10`): segments, problems, robots and designs that are spoilt by grammar.

    python -m tests.fuzz.fuzzer --minutes 10                        as many cases as there is time for
    python -m tests.fuzz.fuzzer --segments 10000 --inputs 5000      so many, from case 0 on
    python -m tests.fuzz.fuzzer --case segments:5162                one of them again

A case is a function of its number; times are all that differs. Each is tried in a process of limited memory
and may take 5 s of processor time. Exit code 1 if one ends with anything but a record, a note or a sentence.
"""

from __future__ import annotations

import argparse
import multiprocessing
import secrets
import shutil
import sys
import tempfile
import time
import traceback
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from multiprocessing.connection import Connection
from pathlib import Path

from tests.fuzz.input_cases import MESHES, TEXTS, complaint, spoilt_files
from tests.fuzz.limits import Hanging, limit_memory, time_limit
from tests.fuzz.segment_cases import examine, messages_of, sound_run, spoilt
from tests.rewriting import write_anew

PATIENCE = 60.0
"""Seconds without an answer after which a case is ended from outside: one that waits uses no processor."""

SHOWN_EVERY = 1000

Try = Callable[[int], str]
"""Tries the case of a number; gives what it was and how it ended, in a few words."""


class Finding(Exception):
    """What is wrong with a case."""


def segments(folder: Path) -> Try:
    """Tries segments."""
    run = sound_run(folder / "sound")
    messages = messages_of(run)

    def attempt(number: int) -> str:
        place = folder / "case"
        place.mkdir()
        try:
            return "segment, read" if examine(place, spoilt(messages, number), run) else "segment, refused"
        finally:
            shutil.rmtree(place)

    return attempt


def inputs(folder: Path) -> Try:
    """Tries the files of a problem."""
    for name, text in (TEXTS | MESHES).items():
        (folder / name).write_text(text, encoding="utf-8")

    def attempt(number: int) -> str:
        case = spoilt_files(number)
        write_anew(folder / case.target, case.content)
        try:
            read, wrong = complaint(folder)
        finally:
            write_anew(folder / case.target, TEXTS[case.target].encode())
        if wrong:
            raise Finding(f"{case.target} ({', '.join(case.mutations)}): {wrong}")
        return f"{case.target}, {'read' if read else 'refused'}"

    return attempt


TARGETS: dict[str, Callable[[Path], Try]] = {"segments": segments, "inputs": inputs}
"""What is tried, by name."""


@dataclass
class Tried:
    """What was tried of a target: cases by kind and end, and what is wrong by number."""

    target: str
    ends: Counter[str] = field(default_factory=Counter)
    findings: dict[int, str] = field(default_factory=dict)


def _child(make: Callable[[Path], Try], folder: Path, pipe: Connection) -> None:
    """Try the cases whose numbers come; memory is limited from the second one on, when all is loaded."""
    attempt = make(folder)
    limited = False
    while True:
        number = pipe.recv()
        try:
            with time_limit():
                pipe.send((attempt(number), ""))
        except (Exception, Hanging) as error:  # noqa: BLE001 - the very thing that is looked for
            where = traceback.extract_tb(error.__traceback__)[-1]
            pipe.send(
                ("finding", f"{type(error).__name__} at {where.filename}:{where.lineno}: {str(error)[:500]}")
            )
        if not limited:
            limit_memory()
            limited = True


class _Worker:
    """A process that tries cases of a target, and is replaced when it dies."""

    def __init__(self, make: Callable[[Path], Try]) -> None:
        self._make = make
        self._begin()

    def _begin(self) -> None:
        self._folder = tempfile.TemporaryDirectory()
        self._pipe, other = multiprocessing.Pipe()
        context = multiprocessing.get_context("fork")
        self._process = context.Process(target=_child, args=(self._make, Path(self._folder.name), other))
        self._process.start()
        other.close()

    def end(self) -> None:
        """End the process."""
        self._process.kill()
        self._process.join()
        self._pipe.close()
        self._folder.cleanup()

    def attempt(self, number: int) -> tuple[str, str]:
        """How a case ended, and what is wrong with it."""
        self._pipe.send(number)
        try:
            if self._pipe.poll(PATIENCE):
                ended: tuple[str, str] = self._pipe.recv()
                return ended
            wrong = f"no answer within {PATIENCE:g} s"
        except EOFError:
            self._process.join()
            wrong = f"its process died (exit code {self._process.exitcode})"
        self.end()
        self._begin()
        return "finding", wrong


def try_cases(
    target: str, make: Callable[[Path], Try], numbers: Iterator[int], until: Callable[[], bool]
) -> Tried:
    """Try the cases of a target, in order, until there are no more or it is time to end."""
    tried, worker = Tried(target), _Worker(make)
    try:
        for number in numbers:
            if until():
                break
            end, wrong = worker.attempt(number)
            tried.ends[end] += 1
            if wrong:
                tried.findings[number] = wrong
                _say(f"FINDING {target} case {number}: {wrong}")
                _say(f"  again with: python -m tests.fuzz.fuzzer --case {target}:{number}")
            if tried.ends.total() % SHOWN_EVERY == 0:
                _say(f"{target}: {tried.ends.total()} cases, the last one {number}")
    finally:
        worker.end()
    return tried


def _say(sentence: str) -> None:
    sys.stdout.write(sentence + "\n")
    sys.stdout.flush()


def _timed(minutes: float, first: int) -> list[Tried]:
    """Each target for an equal share of the time."""
    found = []
    for place, (target, make) in enumerate(TARGETS.items()):
        end = time.monotonic() + 60.0 * minutes / len(TARGETS)
        numbers = iter(range(first, sys.maxsize))
        _say(f"{target} from case {first} on ({place + 1} of {len(TARGETS)})")
        found.append(try_cases(target, make, numbers, lambda end=end: time.monotonic() > end))
    return found


def _counted(counts: dict[str, int], first: int) -> list[Tried]:
    return [
        try_cases(target, make, iter(range(first, first + counts[target])), lambda: False)
        for target, make in TARGETS.items()
        if counts[target]
    ]


def main(arguments: list[str] | None = None) -> int:
    """Try cases, say what was tried and what was found."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--minutes", type=float, default=0.0)
    parser.add_argument(
        "--first", type=int, help="number of the first case (default: any with --minutes, or 0)"
    )
    for target in TARGETS:
        parser.add_argument(f"--{target}", type=int, default=0, metavar="N")
    parser.add_argument("--case", metavar="TARGET:NUMBER")
    options = parser.parse_args(arguments)
    if options.case:
        target, _, number = options.case.partition(":")
        found = [try_cases(target, TARGETS[target], iter([int(number)]), lambda: False)]
    elif options.minutes:
        found = _timed(options.minutes, secrets.randbelow(10**9) if options.first is None else options.first)
    else:
        found = _counted({target: getattr(options, target) for target in TARGETS}, options.first or 0)
    for tried in found:
        ends = ", ".join(f"{count} {end}" for end, count in sorted(tried.ends.items()))
        _say(f"{tried.target}: {tried.ends.total()} cases ({ends}), {len(tried.findings)} findings")
    return int(any(tried.findings for tried in found))


if __name__ == "__main__":
    raise SystemExit(main())
