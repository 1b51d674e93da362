"""A run that came as a tar from elsewhere, opened by every command as another user.

Nothing beside its directory, the given output and the user's cache is read or written, and nothing that came
with it is executed: the processes are watched by an audit hook, and secrets and a module beside the run tell
by their times of access whether anything else has looked at them.
"""

from __future__ import annotations

import io
import json
import os
import shutil
import subprocess
import sys
import tarfile
import tempfile
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

import msgspec
import pytest

from evodesign.evolve import start
from evodesign.runlog.channels import RUN
from evodesign.runlog.reader import entries
from evodesign.runlog.session_log import Silent
from tests.cli import received
from tests.faults.synthetic import synthetic_header
from tests.runlog import crafted
from tests.runlog.toys import OrderedPool, ToyTask

ROOT = Path(__file__).parents[2]
GOLDEN = ROOT / "tests/golden/lifting/format-2/000.mcap"
NOBODY = 65534
LINKED = ("report.html", "segment.part", "merged.part", f".evodesign-{'0' * 16}.part")
"""Names of files that commands write in a run; in the tar they are links that lead out."""

SYSTEM = tuple(map(Path, ("/proc", "/sys", "/dev", "/usr", "/etc", "/lib", "/lib64", "/bin")))
PYTHON = tuple({Path(place).resolve() for place in (sys.prefix, sys.base_prefix, ROOT, *sys.path)})
"""Where the interpreter, this project and what they need lie."""

READING = ("os.listdir", "os.scandir", "ctypes.dlopen")
COMMANDS = tuple(received.commands(Path()))
IN_THE_RUN = ("resume", "report in the run", "merge in place", "resume with more", "polish")
"""Commands whose output is the run's own directory."""

WITH_WORKERS = ("polish",)
"""Commands that need processes of their own, which a user who cannot reach the interpreter does not get."""

Header = dict[str, Any]


@cache
def other_user() -> tuple[tuple[str, ...], bool]:
    """The words before a command that make it another user's, and whether they do.

    Where that user cannot reach the interpreter, the right to read everything is left to it.
    """
    if os.geteuid() != 0:
        return (), False
    plain = ("setpriv", f"--reuid={NOBODY}", f"--regid={NOBODY}", "--clear-groups")
    able = ("--inh-caps=+dac_read_search", "--ambient-caps=+dac_read_search")
    for words in (plain, (*plain, *able)):
        command = [*words, sys.executable, "-c", "import evodesign"]
        if shutil.which(words[0]) and subprocess.run(command, cwd=ROOT, check=False).returncode == 0:
            return words, True
    return (), False


@pytest.fixture
def work() -> Iterator[Path]:
    """A folder of another user with a sound run, an empty home, and secrets beside it all."""
    place = Path(tempfile.mkdtemp(prefix="received-")).resolve()
    for name in ("work/out", "work/home", "work/run", "work/watched", "secret"):
        (place / name).mkdir(parents=True)
    header = synthetic_header(budget=12, seed=4, population=12)
    start(place / "work/sound", header, ToyTask(header), OrderedPool(), Silent())
    for name in ("robot.urdf", "start.toml", "problem.toml", "mesh.stl", "page.html", "lock"):
        (place / "secret" / name).write_text("secret")
    canary = f"open({str(place / 'work/executed')!r}, 'w').close()\nclass Search: pass\nobjective = None\n"
    (place / "work/canary.py").write_text(canary)
    place.chmod(0o755)
    yield place / "work"
    shutil.rmtree(place)


def received_run(work: Path, change: Callable[[Header], None]) -> None:
    """The run of real robots with another header, as it comes out of a tar, with whatever may lie in it."""
    told = [(entry.topic, msgspec.to_builtins(entry.record), entry.sequence) for entry in entries(GOLDEN)]
    for topic, record, _ in told:
        if topic == RUN:
            change(record)
    parts = [crafted.told(*each) for each in told]
    content = crafted.segment(map(crafted.chunk, [crafted.channels() + parts[0], *parts[1:]]))
    packed = io.BytesIO()
    with tarfile.open(fileobj=packed, mode="w") as tar:
        files = {"000.mcap": content} | {
            name: (work / "canary.py").read_bytes()
            for name in ("canary.py", "sitecustomize.py", "numpy.py", "evodesign/__init__.py", "conftest.py")
        }
        for name, data in files.items():
            member = tarfile.TarInfo(name)
            member.size = len(data)
            tar.addfile(member, io.BytesIO(data))
        for name in LINKED:
            member = tarfile.TarInfo(name)
            member.type, member.linkname = tarfile.SYMTYPE, str(work.parent / "secret/page.html")
            tar.addfile(member)
    packed.seek(0)
    with tarfile.open(fileobj=packed) as tar:
        tar.extraction_filter = lambda member, path: member  # the argument `filter` came with Python 3.11.4
        tar.extractall(work / "run")  # as whoever received it would
    for path in (work, *work.rglob("*")):
        if other_user()[1]:
            os.chown(path, NOBODY, NOBODY, follow_symlinks=False)


def hostile_paths(work: Path) -> Callable[[Header], None]:
    """Files of the problem under paths that lead out, absolute and relative, and a mesh elsewhere."""

    def change(header: Header) -> None:
        source, secret = header["problem"], work.parent / "secret"
        mesh = f'<visual><geometry><mesh filename="{secret}/mesh.stl"/></geometry></visual>'
        names = {"urdf": "../secret/robot.urdf", "toml": str(secret / "start.toml")}
        for name, content in list(source["files"].items()):
            new = names[name.rpartition(".")[2]]
            source["text"] = source["text"].replace(f'"{name}"', f'"{new}"')
            del source["files"][name]
            source["files"][new] = content.replace('<link name="head">', f'<link name="head">{mesh}')
        source["path"] = str(secret / "problem.toml")
        assert '"../secret/robot.urdf"' in source["text"]
        assert any("mesh.stl" in content for content in source["files"].values())

    return change


def own_search(work: Path) -> Callable[[Header], None]:
    def change(header: Header) -> None:
        header["search"]["algorithm"] = "canary:Search"

    return change


def own_objective(work: Path) -> Callable[[Header], None]:
    def change(header: Header) -> None:
        text = header["problem"]["text"]
        header["problem"]["text"] = text.replace('"worst_human_torque"', '"canary:objective"')
        assert header["problem"]["text"] != text

    return change


def stamps(folder: Path) -> dict[str, tuple[bytes, int, int]]:
    """Content and times of all files, read without moving their times of access."""
    found = {}
    for path in sorted(folder.rglob("*")):
        before = path.stat()
        found[str(path)] = (path.read_bytes(), before.st_mtime_ns, before.st_atime_ns)
        os.utime(path, ns=(before.st_atime_ns, before.st_mtime_ns))
    return found


def outcomes(work: Path, names: tuple[str, ...]) -> dict[str, tuple[int, str, str]]:
    """Exit code, output and errors of commands, each watched."""
    secret = work.parent / "secret"
    for path in secret.iterdir():
        os.utime(path, ns=(10**18, 2 * 10**18))  # accessed before it was changed: the next access is noted
    before = stamps(secret)
    environment = os.environ | {
        "HOME": str(work / "home"),
        "XDG_CACHE_HOME": str(work / "home/cache"),
        "TMPDIR": str(work / "out"),
        "PYTHONPATH": f"{ROOT}{os.pathsep}{work}",
        "PYTHONDONTWRITEBYTECODE": "1",
    }
    for name in ("EVODESIGN_CACHE", "EVODESIGN_MODULES", "PYTHONPYCACHEPREFIX"):
        environment.pop(name, None)
    command = [*other_user()[0], sys.executable, received.__file__, str(work), *names]
    subprocess.run(command, cwd=work, env=environment, check=True, timeout=600)
    assert stamps(secret) == before, "a file elsewhere was read or written"
    assert not (work / "executed").exists(), "something that came with the run was executed"
    found = {}
    for number, name in enumerate(names):
        code, out, errors = json.loads((work / f"watched/found-{number}.json").read_text())
        assert "Traceback" not in errors, f"{name}: {errors[-3000:]}"
        found[name] = (code, out, errors)
        for line in (work / f"watched/events-{number}.jsonl").read_text().splitlines():
            check_event(work, name, *json.loads(line))
    return found


def check_event(work: Path, name: str, event: str, *arguments: Any) -> None:
    """That an event touches nothing that is not the run's, the output's or the cache's."""
    told = f"{name}: {event} {arguments}"
    assert not event.startswith("socket."), told
    assert event not in ("os.system", "os.exec", "os.posix_spawn"), told
    if event == "os.kill":
        assert name in WITH_WORKERS, told  # ends its own workers that will not begin
        return
    if event == "subprocess.Popen":
        assert Path(arguments[0]).name == "git", told
        return
    if not isinstance(arguments[0], str):
        return  # a descriptor of what was opened before
    path = Path(os.path.abspath(work / "out" / arguments[0]))  # noqa: PTH100 - as it was asked for, links and all
    mode = arguments[1] if event == "open" and len(arguments) > 1 else ""
    flags = arguments[2] if event == "open" and len(arguments) > 2 else 0
    reads = event in READING or (
        event == "open"
        and not set(str(mode)) & set("wax+")
        and not int(flags or 0) & (os.O_WRONLY | os.O_RDWR | os.O_CREAT)
    )
    ours = [work / "out", work / "home/cache", work / "watched"]
    ours += [work / "run-recovered"] if name == "recover beside" else []
    if reads:
        allowed = [*ours, work / "run", work / "sound", *SYSTEM, *PYTHON]
        assert path == work or any(map(path.is_relative_to, allowed)) or path.name == "canary.py", told
    else:
        allowed = [*ours, Path("/dev"), *([work / "run"] if name in IN_THE_RUN else [])]
        assert any(map(path.is_relative_to, allowed)), told


QUICK = ("front", "report in the run", "merge in place", "recover beside", "watch for programs")


@pytest.mark.parametrize(
    "names",
    [QUICK, pytest.param(tuple(name for name in COMMANDS if name not in QUICK), marks=pytest.mark.slow)],
    ids=["quick", "others"],
)
def test_paths_and_links_of_a_received_run_lead_nowhere(names: tuple[str, ...], work: Path) -> None:
    received_run(work, hostile_paths(work))
    found = outcomes(work, names)
    assert {name: code for name, (code, _, _) in found.items() if code and name not in WITH_WORKERS} == {}
    if "report in the run" in names:
        assert not (work / "run/report.html").is_symlink(), "the link gave way to the page"
        assert (work / "run/report.html").stat().st_size > 10**6


SEARCHES = ("resume", "resume with more", "verify", "branch")
ASSESSES = ("resume with more", "polish")
"""Commands that cannot do without the search, and without the problem's objectives."""


@pytest.mark.parametrize(
    ("make", "refusing", "others"),
    [
        (own_search, SEARCHES, ("show", "polish")),
        pytest.param(own_objective, ASSESSES, ("show", "resume", "verify", "branch"), marks=pytest.mark.slow),
    ],
)
def test_code_that_a_received_run_names_is_not_executed(
    make: Callable[..., Any], refusing: tuple[str, ...], others: tuple[str, ...], work: Path
) -> None:
    received_run(work, make(work))
    found = outcomes(work, (*others, *refusing))
    assert {name: found[name][0] for name in refusing} == dict.fromkeys(refusing, 2)
    assert all("EVODESIGN_MODULES=canary" in found[name][2] for name in refusing)


@pytest.mark.slow
def test_commands_that_need_neither_search_nor_objectives_execute_none(work: Path) -> None:
    def both(header: Header) -> None:
        own_search(work)(header)
        own_objective(work)(header)

    received_run(work, both)
    outcomes(work, tuple(name for name in COMMANDS if name not in ("show", *SEARCHES, *ASSESSES)))


def test_code_that_the_user_names_is_executed(work: Path) -> None:
    """So the canary would sing."""
    program = "from evodesign.outside import imported; imported('canary:objective', 'a run', 'objectives')"
    environment = os.environ | {"PYTHONPATH": f"{ROOT}{os.pathsep}{work}", "EVODESIGN_MODULES": "canary"}
    subprocess.run([sys.executable, "-c", program], env=environment, check=True)
    assert (work / "executed").exists()


@pytest.mark.parametrize(
    "event",
    [
        ("open", "../secret/mesh.stl", "r", 0),
        ("open", str(Path.home() / "key"), "r", 0),
        ("open", "../run/000.mcap", "w", os.O_WRONLY),
        ("os.rename", str(Path.home() / "one"), str(Path.home() / "other")),
        ("subprocess.Popen", "/bin/sh", "[]", "None"),
        ("socket.connect", "<socket>", "('10.0.0.1', 80)"),
    ],
    ids=str,
)
def test_what_leads_elsewhere_is_noticed(event: tuple[Any, ...], work: Path) -> None:
    with pytest.raises(AssertionError):
        check_event(work, "front", *event)
