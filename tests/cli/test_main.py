"""What every command line has: a version, help in short, completion for the shell, errors in one sentence."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import evodesign
from docs.write_commands import PAGE, page
from evodesign.cli.main import COMMANDS, app, main
from tests.cli.here import evodesign as evodesign_here

COMMAND = [sys.executable, "-c", "from evodesign.__main__ import main; main()"]


def test_the_version_is_the_package_s(capsys: pytest.CaptureFixture[str]) -> None:
    app(["--version"], standalone_mode=False)
    assert capsys.readouterr().out == f"evodesign {evodesign.__version__}\n"


def test_alone_it_shows_its_help() -> None:
    done = subprocess.run(COMMAND, capture_output=True, text=True, check=False)
    shown = done.stdout + done.stderr
    assert "Usage: evodesign [OPTIONS] COMMAND" in shown
    assert [name for name in COMMANDS if f"\n  {name} " not in shown] == []


@pytest.mark.parametrize("command", COMMANDS)
def test_the_synopsis_names_every_command(command: str, repository: Path) -> None:
    text = (repository / "docs" / "commands.md").read_text(encoding="utf-8")
    (commands,) = re.findall(r"## Synopsis\n\n```\n(.*?)```", text, re.DOTALL)
    assert re.search(rf"\b{command}\b", commands)


def test_the_stored_options_are_those_of_the_command_line() -> None:
    assert PAGE.read_text(encoding="utf-8") == page(), "python -m docs.write_commands writes them"


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_commands_are_completed(shell: str) -> None:
    words = {
        "bash": {"COMP_WORDS": "evodesign re", "COMP_CWORD": "1"},
        "zsh": {"_TYPER_COMPLETE_ARGS": "evodesign re"},
        "fish": {"_TYPER_COMPLETE_ARGS": "evodesign re", "_TYPER_COMPLETE_FISH_ACTION": "get-args"},
    }
    environment = {**os.environ, "_EVODESIGN_COMPLETE": f"complete_{shell}", **words[shell]}
    done = subprocess.run(COMMAND, capture_output=True, text=True, check=False, env=environment)
    assert [name for name in COMMANDS if name.startswith("re") and name not in done.stdout] == []
    assert "search" not in done.stdout.split()


@pytest.mark.parametrize(
    ("arguments", "which"),
    [
        (["search", "icub-lifting", "--run", ""], "--run"),
        (["search", "icub-lifting", "--run="], "--run"),
        (["search", ""], "PROBLEM"),
        (["front", ""], "RUN"),
        (["compare", "runs/one", ""], "RUN RUN..."),
        (["export", "runs/one", "3", "--to", ""], "--to"),
        (["evaluate", "icub-lifting", "--design", ""], "--design"),
    ],
    ids=" ".join,
)
def test_an_empty_path_is_not_the_working_directory(arguments: list[str], which: str) -> None:
    done = evodesign_here(*arguments)
    assert done.returncode == 2
    assert f"Invalid value for '{which}': wanted a path or a word, found ''" in " ".join(done.stderr.split())


def test_a_path_that_is_no_text_is_shown_as_it_is(repository: Path, tmp_path: Path) -> None:
    folder = tmp_path / "r\udcff"
    shutil.copytree(repository / "tests" / "golden" / "lifting" / "format-2", folder)
    done = subprocess.run([*COMMAND, "front", folder], capture_output=True, check=False)
    assert (done.returncode, b"Traceback" in done.stderr) == (0, False)


def test_a_path_that_is_no_text_is_refused_where_it_would_be_logged(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys.modules["evodesign.cli.main"], "app", lambda prog_name: "r\udcff".encode())
    done = evodesign_here("search")
    assert done.returncode == 2
    assert done.stderr.startswith("error: a path: wanted names of files that are text in this locale")
    assert done.stderr.count("\n") == 1


@pytest.mark.parametrize("terminal", [False, True])
def test_an_error_is_one_sentence_which_a_terminal_shows_in_whole_words(
    terminal: bool, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    path = "no-such-directory/" * 4
    monkeypatch.setattr(sys, "argv", ["evodesign", "front", path])
    monkeypatch.setattr(sys.stderr, "isatty", lambda: terminal)
    monkeypatch.setenv("COLUMNS", "60")
    with pytest.raises(SystemExit) as stop:
        main()
    shown = capsys.readouterr().err
    assert stop.value.code == 2
    assert shown.split()[:2] == ["error:", f"{path.rstrip('/')}:"]
    assert shown.count("\n") == (3 if terminal else 1)
