"""Commands in processes that may use 300 MB beyond what they import, and six times its processor time.

On a slow or busy machine importing takes about as much longer as everything else. What a command loads when
it needs it counts as what it imports, the search of the tests' problem too. What grows faster than its input
takes many times as long. All is imported once: each command has a process of its own, forked from there.
"""

from __future__ import annotations

import json
import math
import os
import resource
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

IMPORTS, BYTES = 6, 300_000_000
LONGEST = 120
"""Of a command that waits for something [s]."""

Command = Callable[..., subprocess.CompletedProcess[str]]


@contextmanager
def bounded_commands(place: Path) -> Iterator[Command]:
    """Runs commands within the bounds; beyond them they are killed, or fail with a traceback."""
    command = [sys.executable, "-m", "tests.cli.bounded"]
    root = Path(__file__).parents[2]
    environment = os.environ | {"OPENBLAS_NUM_THREADS": "1"}  # stacks of idle threads are no memory of ours
    pipe = subprocess.PIPE
    with subprocess.Popen(command, cwd=root, env=environment, stdin=pipe, stdout=pipe, text=True) as server:
        assert server.stdin is not None
        assert server.stdout is not None
        requests, exits = server.stdin, server.stdout

        def evodesign(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
            written = place / "output", place / "errors"
            words = [*map(str, (*written, *arguments))]
            print(json.dumps(words), file=requests, flush=True)
            code = int(exits.readline())
            return subprocess.CompletedProcess(words, code, *(path.read_text("utf-8") for path in written))

        yield evodesign


def _bound(seconds: int) -> None:
    """Set the bounds from what this process has used so far."""
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
    room = pages * resource.getpagesize() + BYTES
    resource.setrlimit(resource.RLIMIT_AS, (room, room))
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))
    signal.alarm(LONGEST)


def _forked() -> bool:
    """Whether this is a process with a command to run; the one that forks comes back when none is left."""
    usage = resource.getrusage(resource.RUSAGE_SELF)
    seconds = math.ceil(IMPORTS * max(usage.ru_utime + usage.ru_stime, 1.0))
    for line in sys.stdin:
        if child := os.fork():
            sys.stdout.write(f"{os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])}\n")
            sys.stdout.flush()
            continue
        output, errors, *sys.argv[1:] = json.loads(line)
        for number, path in enumerate((os.devnull, output, errors)):
            os.dup2(os.open(path, os.O_RDWR | os.O_CREAT | os.O_TRUNC), number)
        _bound(seconds)
        return True
    return False


if __name__ == "__main__":
    import casadi  # noqa: F401
    import lxml.etree  # noqa: F401
    import scipy.interpolate  # what a command loads when it needs it counts as what it imports
    import scipy.optimize
    import scipy.spatial  # noqa: F401

    import evodesign.cli.check
    import evodesign.guess.preflight
    import evodesign.problem.inertia_rules
    import evodesign.problem.mesh_reading
    import evodesign.searches.nsga2  # noqa: F401
    from evodesign.cli import main

    if _forked():
        main()
