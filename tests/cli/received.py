"""Every command on a received run, watched: `python received.py WORK COMMAND...`.

The run lies in WORK/run, a sound one in WORK/sound; what is made goes to WORK/out. Everything is imported
first; then each command has a process of its own, forked from there, in which an audit hook writes down what
is opened, listed, changed, started or connected to. That, and what came of it, goes
to WORK/watched.
"""

from __future__ import annotations

import importlib
import json
import os
import sys
from collections.abc import Callable
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2]))

from tests.cli import limited

WATCHED = (
    *("open", "import", "exec", "socket.connect", "socket.getaddrinfo", "subprocess.Popen", "ctypes.dlopen"),
    *("os.listdir", "os.scandir", "os.chdir", "os.system", "os.exec", "os.posix_spawn", "os.fork", "os.kill"),
    *("os.mkdir", "os.remove", "os.rename", "os.rmdir", "os.symlink", "os.link", "os.truncate", "os.utime"),
    *("os.chmod", "os.chown", "shutil.rmtree", "shutil.move", "shutil.copyfile", "tempfile.mkstemp"),
)
"""Events of Python's audit hooks by which a process touches anything beside its memory."""

UNTOLD = ("import", "exec", "os.fork")
"""Of these, those that are not written down: what they read and start is."""


def commands(work: Path) -> dict[str, list[str]]:
    """Arguments of every command that reads a run, by a name of its own; the first word is the command."""
    run, out = work / "run", work / "out"
    alone = ["--jobs", "1", "--pool", "serial"]
    told = limited.commands(run, out) | {
        "compare": [str(run), str(work / "sound")],
        "branch": [str(run), "--branch-from", "1", "--run", str(out / "new"), "--evaluations", "3", *alone],
    }
    return {name: [name, *arguments] for name, arguments in told.items()} | {
        "front in a file": ["front", str(run), "--plot", str(out / "front.html")],
        "report in the run": ["report", str(run)],
        "watch for programs": ["watch", str(run), "--json"],
        "polish": ["polish", str(run), "0", "--evaluations", "2", "--jobs", "1"],
        "recover beside": ["recover", str(run)],
        "merge in place": ["merge", str(run)],
        "resume with more": [
            *("resume", str(run), "--evaluations", "6", "--accept-versions", *alone),
        ],
    }


def hook(log: Path) -> Callable[[str, tuple[object, ...]], None]:
    """An audit hook that writes events to a file, one JSON list a line."""
    descriptor = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_APPEND)

    def told(event: str, arguments: tuple[object, ...]) -> None:
        if event in WATCHED and event not in UNTOLD:
            line = json.dumps([event, *(_text(each) for each in arguments)])
            os.write(descriptor, line.encode(errors="replace") + b"\n")

    return told


def _text(value: object) -> object:
    if isinstance(value, (str, bytes, os.PathLike)):
        return os.fsdecode(value)
    return value if isinstance(value, int) else repr(value)


def main() -> None:
    work, names = Path(sys.argv[1]), sys.argv[2:]
    os.chdir(work / "out")
    for module in limited.IMPORTED:
        importlib.import_module(module)
    for number, name in enumerate(names):
        child = os.fork()
        if child == 0:
            limited.SECONDS = 0.0  # without an end: a robot's postures are solved
            sys.addaudithook(hook(work / f"watched/events-{number}.jsonl"))
            command, *arguments = commands(work)[name]
            found = limited.call(command, arguments)
            (work / f"watched/found-{number}.json").write_text(json.dumps(found))
            os._exit(0)
        os.waitpid(child, 0)


if __name__ == "__main__":
    main()
