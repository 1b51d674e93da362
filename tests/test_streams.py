"""Commands whose standard streams are closed, unread, full, or of an encoding that lacks what is written."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

import pytest

from evodesign.streams import ASCII, UNREAD

ROOT = Path(__file__).parents[1]
RUN = ROOT / "tests" / "golden" / "lifting" / "format-2"
COMMAND = [sys.executable, "-c", "from evodesign.__main__ import main; main()"]

C_LOCALE = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
NARROW = (C_LOCALE, {"PYTHONIOENCODING": "iso-8859-1"})


def command(
    *arguments: object, environment: Mapping[str, str] | None = None, **streams: int
) -> subprocess.CompletedProcess[bytes]:
    """A command as a process of its own; streams that are not given are captured."""
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE} | streams
    line = [*COMMAND, *map(str, arguments)]
    return subprocess.run(line, check=False, env={**os.environ, **(environment or {})}, **pipes)


def in_shell(redirections: str, code: Sequence[str]) -> subprocess.CompletedProcess[bytes]:
    """A process some of whose streams a shell has closed."""
    return subprocess.run(["sh", "-c", f'"$@" {redirections}', "sh", *code], capture_output=True, check=False)


def unread() -> int:
    """The end of a pipe whose reader has gone."""
    reader, writer = os.pipe()
    os.close(reader)
    return writer


@pytest.mark.parametrize("environment", NARROW, ids=str)
def test_an_encoding_without_arrows_and_lines_shows_their_likes(environment: Mapping[str, str]) -> None:
    done = command("show", RUN, 1, environment=environment)
    shown = done.stdout.decode("ascii")
    assert (done.returncode, b"Traceback" in done.stderr) == (0, False)
    assert "| robot_torque [N m] v " in shown
    assert "| reach_height [m] ^ " in shown
    assert re.search(r"length\.forearm .* \| -+\*-+ +\|", shown)
    assert "\\u" not in shown
    assert "?" not in shown


def test_every_sign_that_the_command_line_writes_has_its_like() -> None:
    texts = [path.read_text("utf-8") for path in (ROOT / "evodesign" / "cli").rglob("*.py")]
    signs = {letter for text in texts for letter in text if not letter.isascii()}
    assert signs
    assert signs <= set(ASCII)
    assert all(like.isascii() and len(like) == 1 for like in ASCII.values())


WRITING = "from evodesign.streams import adapt_streams; import sys; adapt_streams(); "


@pytest.mark.parametrize("stream", ["stdout", "stderr"])
def test_other_letters_become_escapes_and_bytes_of_a_path_stay(stream: str) -> None:
    code = f"{WRITING} sys.{stream}.write('\\u2193 \\xfc \\u20ac \\udcff')"
    found = []
    for encoding in ("iso-8859-1", "utf-8"):
        environment = {**os.environ, "PYTHONIOENCODING": encoding}
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, env=environment, check=True)
        found.append(getattr(done, stream))
    assert found == [b"v \xfc \\u20ac \xff", "↓ ü €".encode() + b" \xff"]


@pytest.mark.parametrize(
    ("redirections", "arguments", "code"),
    [("<&- >&- 2>&-", ["problems"], 0), (">&-", ["--version"], 0), ("2>&-", ["front", "gone"], 2)],
)
def test_closed_streams_change_no_exit_code(redirections: str, arguments: Sequence[str], code: int) -> None:
    done = in_shell(redirections, [*COMMAND, *arguments])
    assert done.returncode == code
    assert b"Traceback" not in done.stderr + done.stdout


def test_no_file_is_opened_in_the_place_of_a_closed_stream(tmp_path: Path) -> None:
    file = tmp_path / "log"
    code = (
        f"{WRITING} log = open({str(file)!r}, 'w'); print('out'); print('error', file=sys.stderr); "
        "import subprocess; subprocess.run(['sh', '-c', 'echo child; echo child >&2'], check=True); "
        "log.write(str(log.fileno() > 2))"
    )
    in_shell("<&- >&- 2>&-", [sys.executable, "-c", code])
    assert file.read_text() == "True"


@pytest.mark.parametrize("arguments", [["--version"], ["show", RUN, 1, "--json"]])
def test_a_reader_that_has_gone_ends_a_command_as_sigpipe_does(arguments: Sequence[object]) -> None:
    done = command(*arguments, stdout=unread())
    assert done.returncode == UNREAD
    assert b"Traceback" not in done.stderr
    assert b"BrokenPipe" not in done.stderr


@pytest.mark.slow
def test_standard_error_that_cannot_be_written_stops_nothing() -> None:
    with Path("/dev/full").open("wb") as full:
        for stream in (unread(), full.fileno()):
            done = command("show", RUN, 1, stderr=stream)
            assert done.returncode == 0
            assert b"golden-lifting: design 1" in done.stdout
