"""Factories of an importable module, as workers need them."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from evodesign.pool.base import Limits


@dataclass(frozen=True)
class Counted:
    """Builds a task that squares; every building leaves a file in the folder."""

    folder: str

    def __call__(self) -> Callable[[int], int]:
        stamp = time.monotonic_ns()
        (Path(self.folder) / f"{os.getpid()}-{stamp}").touch()
        return square


def square(number: int) -> int:
    time.sleep(0.002)
    return number * number


def squares() -> Callable[[int], int]:
    return square


def picky() -> Callable[[int], int]:
    def task(number: int) -> int:
        if number == 3:
            raise ValueError("three\nis refused")
        if number == 5:
            raise SystemExit(1)
        return number

    return task


@dataclass(frozen=True)
class Broken:
    """A factory that cannot build its task; every try leaves a file in the folder."""

    folder: str

    def __call__(self) -> Callable[[int], int]:
        (Path(self.folder) / f"{os.getpid()}-{time.monotonic_ns()}").touch()
        raise OSError("no such robot")


def deadly() -> Callable[[str], str]:
    """A task that loses its worker in the way that its argument names."""

    def task(word: str) -> str:
        if word == "kill":
            os.kill(os.getpid(), signal.SIGKILL)
        if word == "exit":
            os._exit(7)
        time.sleep(0.01)
        return word.upper()

    return task


@dataclass(frozen=True)
class KillsOnce:
    """A task that kills its worker the first time that it meets the culprit."""

    folder: str
    culprit: int

    def __call__(self) -> Callable[[int], int]:
        mark = Path(self.folder) / "killed"

        def task(number: int) -> int:
            if number == self.culprit and not mark.exists():
                mark.touch()
                os.kill(os.getpid(), signal.SIGKILL)
            return number

        return task


def unsendable() -> Callable[[int], object]:
    """A task whose result for 2 does not pickle."""

    def task(number: int) -> object:
        return (x for x in ()) if number == 2 else number

    return task


def environment() -> Callable[[str], str | None]:
    return os.environ.get


def process() -> Callable[[float], int]:
    """A task that sleeps for its argument [s] and gives its process."""

    def task(seconds: float) -> int:
        time.sleep(seconds)
        return os.getpid()

    return task


def held() -> Callable[[str], None]:
    """A task that waits while the file that it is given is there."""

    def task(hold: str) -> None:
        while hold and Path(hold).exists():
            time.sleep(0.01)

    return task


@dataclass(frozen=True)
class Alone:
    """A task that fails when another one runs beside it, and gives its process."""

    folder: str

    def __call__(self) -> Callable[[int], int]:
        def task(number: int) -> int:
            mark = Path(self.folder) / "at work"
            mark.touch(exist_ok=False)
            time.sleep(0.02)
            mark.unlink()
            return os.getpid()

        return task


@dataclass(frozen=True)
class Within:
    """A factory of `process` with limits."""

    limits: Limits

    def __call__(self) -> Callable[[float], int]:
        return process()


@dataclass(frozen=True)
class SlowToBuild:
    """A factory of `process` that takes its time [s]."""

    seconds: float
    limits: Limits

    def __call__(self) -> Callable[[float], int]:
        time.sleep(self.seconds)
        return process()


@dataclass(frozen=True)
class Hoards:
    """A task that takes as many bytes as its argument says."""

    limits: Limits

    def __call__(self) -> Callable[[int], int]:
        return lambda size: len(bytearray(size))


class Grows:
    """A task that keeps 200 MB each time, and gives its process."""

    def __call__(self) -> Callable[[int], int]:
        kept: list[bytes] = []

        def grow(_: int) -> int:
            kept.append(b"x" * 200_000_000)
            time.sleep(1.1)
            return os.getpid()

        return grow


def mark() -> Callable[[object], str]:
    """A task that reads how readily the system ends its process."""
    return lambda _: Path("/proc/self/oom_score_adj").read_text().strip()


@dataclass(frozen=True)
class Where:
    """A task that gives a name and its process; a large one."""

    name: str
    memory: int | None = None
    filling: bytes = field(default=b"x" * 1_000_000, compare=False)

    @property
    def limits(self) -> Limits:
        """With some memory."""
        return Limits(memory=self.memory)

    def __call__(self) -> Callable[[int], tuple[str, int]]:
        return lambda _: (self.name, os.getpid())
