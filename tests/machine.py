"""What a new machine may lack, and what then becomes of the tests that need it.

They are left out with reason and remedy, which the session says once more at its end. Where $CI is set they
fail: a machine that decides whether a change goes in has to run them all.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import tempfile
from collections import Counter
from collections.abc import Callable, Iterable
from functools import cache
from importlib.util import find_spec
from typing import NoReturn

import pytest

from tests.robots import robots_installed


def leave_out(reason: str) -> NoReturn:
    """End a test that this machine cannot run."""
    if os.environ.get("CI"):
        pytest.fail(f"{reason}; with $CI set no test may be left out", pytrace=False)
    pytest.skip(reason)


def chromium() -> str | None:
    """Path of Chromium, or None when it is not installed."""
    return shutil.which("chromium") or shutil.which("chromium-browser")


@cache
def compiler_works() -> bool:
    """Whether C can be compiled, headers and linker included.

    The answer does not come from evodesign's own search for a compiler, whose tests depend on it.
    """
    commands = [os.environ["CC"].split()] if os.environ.get("CC") else [["cc"], ["gcc"], ["clang"]]
    program = b"#include <math.h>\ndouble f(double x) { return sin(x); }\n"
    for command in commands:
        if shutil.which(command[0]):
            with tempfile.TemporaryDirectory() as folder:
                compile_it = [
                    *command,
                    "-shared",
                    "-fPIC",
                    "-x",
                    "c",
                    "-",
                    "-o",
                    f"{folder}/library.so",
                    "-lm",
                ]
                done = subprocess.run(compile_it, input=program, capture_output=True, check=False)
            return done.returncode == 0
    return False


@cache
def memory_sanitizer() -> tuple[str, ...]:
    """The command that compiles with clang's memory sanitizer; none where that does not work."""
    command = ("clang", "-fsanitize=memory")
    if shutil.which("clang"):
        with tempfile.TemporaryDirectory() as folder:
            compile_it = [*command, "-x", "c", "-", "-o", f"{folder}/program"]
            done = subprocess.run(
                compile_it, input=b"int main(void) { return 0; }\n", capture_output=True, check=False
            )
        return command if done.returncode == 0 else ()
    return ()


def drake_installed() -> bool:
    """Whether the second engine is there."""
    return find_spec("pydrake") is not None


NEEDS: dict[str, tuple[Callable[[], object], str]] = {
    "needs_chromium": (chromium, "no Chromium (Debian: apt-get install chromium)"),
    "needs_clang": (memory_sanitizer, "no clang with its memory sanitizer (Debian: apt-get install clang)"),
    "needs_compiler": (compiler_works, "no C compiler that works (Debian: apt-get install gcc libc6-dev)"),
    "needs_drake": (drake_installed, "no Drake (pip install 'evodesign[drake]')"),
    "needs_robots": (robots_installed, "no public robots (make test-all installs them)"),
}
"""By marker: whether this machine has what is needed, and the reason and remedy if not."""


def left_out(reports: Iterable[pytest.TestReport | pytest.CollectReport]) -> list[str]:
    """A sentence for each reason of skipped tests, with their number."""
    reasons = Counter(_reason(report) for report in reports)
    return [
        f"left out: {count} {'test' if count == 1 else 'tests'}: {reason}"
        for reason, count in sorted(reasons.items())
    ]


def _reason(report: pytest.TestReport | pytest.CollectReport) -> str:
    where = report.longrepr
    return where[2].removeprefix("Skipped: ") if isinstance(where, tuple) else str(where)
