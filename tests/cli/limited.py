"""Every command on a run, in a process of limited memory and processor time: `python limited.py`.

It reads directories WORK, a line each, and answers each with a line when the commands have ended. The run
lies in WORK/run, a sound one in WORK/sound. The limits count from where all has been imported, which is done
once: each run has a process of its own, forked from there. Exit code, output and errors of each command go to
WORK/found.json; it is missing where the process was ended by its limits.
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

IMPORTED = (
    *("evodesign.api.sessions", "evodesign.report.page", "evodesign.report.opened_design", "plotly.io"),
    *("evodesign.cli.main", "evodesign.searches.nsga2", "pydantic", "rich.progress", "typer.rich_utils"),
)


def commands(run: Path, work: Path) -> dict[str, list[str]]:
    """Arguments of every command that reads a run."""
    return {
        "front": [str(run)],
        "verify": [str(run)],
        "report": [str(run), "--output", str(work / "page.html")],
        "matters": [str(run), "--design", "0"],
        "families": [str(run)],
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


def run_all(work: Path) -> None:
    """Call every command on a run."""
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    limit = pages * os.sysconf("SC_PAGE_SIZE") + MEMORY
    resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
    found = {name: call(name, arguments) for name, arguments in commands(work / "run", work).items()}
    (work / "found.json").write_text(json.dumps(found))


def main() -> None:
    """Call all, one run after the other."""
    for module in IMPORTED:
        importlib.import_module(module)
    for line in sys.stdin:
        child = os.fork()
        if child == 0:
            os.dup2(os.open(os.devnull, os.O_RDONLY), sys.stdin.fileno())
            run_all(Path(line.rstrip("\n")))
            os._exit(0)
        os.waitpid(child, 0)
        sys.stdout.write("\n")
        sys.stdout.flush()


if __name__ == "__main__":
    main()
