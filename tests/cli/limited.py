"""Every command on a run, in one process of limited memory and processor time: `python limited.py RUN WORK`.

The limits count from where all has been imported. Prints exit code, output and errors of each as JSON.
"""

from __future__ import annotations

import contextlib
import importlib
import io
import json
import os
import resource
import signal
import sys
import traceback
from pathlib import Path

MEGABYTE = 2**20
MEMORY = 300 * MEGABYTE
SECONDS = 5.0
"""Processor time of a command; a process that takes longer is ended by the system."""

IMPORTED = ("evodesign.api.sessions", "evodesign.report.page", "evodesign.report.opened_design", "plotly.io")


def commands(run: Path, work: Path) -> dict[str, list[str]]:
    """Arguments of every command that reads a run."""
    return {
        "front": [str(run)],
        "verify": [str(run)],
        "report": [str(run), "--output", str(work / "page.html")],
        "show": [str(run), "0", "--json"],
        "export": [str(run), "0", "--to", str(work / "exported")],
        "compare": [str(run), str(work / "sound")],
        "watch": [str(run), "--once"],
        "recover": [str(run), "--to", str(work / "recovered")],
        "branch": [str(run), "--branch-from", "1", "--run", str(work / "branched"), "--jobs", "1"],
        "merge": [str(run), "--to", str(work / "merged.mcap")],
        "resume": [str(run), "--jobs", "1", "--pool", "serial", "--accept-versions"],
    }


def call(name: str, arguments: list[str]) -> tuple[int, str, str]:
    """Exit code, output and errors of a command; 1 with a traceback as the interpreter would."""
    from evodesign.cli import main

    out, errors, code = io.StringIO(), io.StringIO(), 0
    sys.argv = ["evodesign", name, *arguments]
    signal.setitimer(signal.ITIMER_PROF, SECONDS)
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(errors):
        try:
            main()
        except SystemExit as left:
            code = left.code if isinstance(left.code, int) else int(left.code is not None)
        except BaseException:  # noqa: BLE001 - the very thing that is looked for
            traceback.print_exc()
            code = 1
    signal.setitimer(signal.ITIMER_PROF, 0.0)
    return code, out.getvalue(), errors.getvalue()


def main() -> None:
    """Call all."""
    for module in IMPORTED:
        importlib.import_module(module)
    run, work = map(Path, sys.argv[1:3])
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    limit = pages * os.sysconf("SC_PAGE_SIZE") + MEMORY
    resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
    found = {name: call(name, arguments) for name, arguments in commands(run, work).items()}
    print(json.dumps(found))  # noqa: T201 - what the test reads


if __name__ == "__main__":
    main()
