"""Every command that README and docs show exists and is run by a test, or says here why not."""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import typer

from evodesign.cli.main import COMMANDS, app
from tests.cli.test_columns import LINES

REPOSITORY = Path(__file__).parents[2]
PAGES = sorted(
    path
    for path in (
        *REPOSITORY.glob("*.md"),
        *REPOSITORY.glob("docs/**/*.md"),
        *REPOSITORY.glob("examples/*.md"),
    )
    if path.name != "CHANGELOG.md"  # which tells of what there was, too
)
FENCE = re.compile(r"^```\w*\n(.*?)^```$", re.MULTILINE | re.DOTALL)
INLINE = re.compile(r"`evodesign ([a-z]+)([^`]*)`")
LINE = re.compile(r"(?:^|\$ )evodesign ([a-z]+)(.*)")
OTHER = re.compile(r"^(?:\$ )?(make [a-z-]+|python -m [\w.]+)", re.MULTILINE)
OTHER_INLINE = re.compile(r"`(make [a-z-]+|python -m [\w.]+)[^`]*`")
PLACES = {
    "RUN": "run",
    "NEW": "new",
    "PROBLEM": "problem.toml",
    "DESIGN": "3",
    "GENERATION": "3",
    "DIR": "place",
    "FILE": "file",
}
"""What stands for a name on a page."""

NOT_RUN = {
    "make search": "searches for minutes; `evodesign search` is run, and .ci/run searches from the wheel",
    "make test": "runs this test",
    "make test-quick": "runs tests that `make test-all` runs too",
    "make faults": "takes hours; its campaign is run with few kills in tests/faults/test_faults.py",
    "make fuzz": "takes as long as one likes; its fuzzer is run in tests/fuzz/test_fuzzer.py",
    "make api": "writes the page that tests/docs/test_api.py compares",
    "make help": "prints the Makefile's own comments",
    "python -m benchmarks": "measures for minutes or hours; its figures are in docs/benchmarks.md",
    "python -m docs.write_gallery": "searches for a quarter of an hour",
    "python -m docs.write_pushes": "draws a search of minutes",
    "python -m docs.write_assembly": "draws a design of a search of minutes",
    "python -m docs.write_actuators": "writes the tables that tests/docs/test_actuators_tables.py compares",
    "python -m docs.write_problem_file": "writes tables that tests/docs/test_quantities_table.py compares",
    "python -m docs.write_commands": "writes the tables that tests/cli/test_main.py compares",
    "python -m docs.write_floors": "writes the picture that tests/docs/test_layout.py compares",
    "python -m docs.write_trust": "writes the tables that tests/cli/test_validate.py compares",
    "python -m tests.docs.notebooks": "stores what tests/docs/test_notebooks.py compares",
    "python -m tests.faults.campaign": "takes hours; run with few kills in tests/faults/test_faults.py",
    "python -m tests.fuzz.fuzzer": "takes hours; run for seconds in tests/fuzz/test_fuzzer.py",
    "evodesign search --scheduler": "needs machines; see tests/conformance/test_pools.py",
    "evodesign report --sensitivities": "tests/report/page/test_gradients.py makes that page",
    "evodesign reproduce": "takes minutes; tests/cli/test_reproduce.py runs it with small budgets",
}
"""Commands that no test runs as they stand, and why; a module's name stands for all in it."""


@cache
def known_commands() -> dict[str, Any]:
    """The commands by name, as click has them."""
    return dict(typer.main.get_command(app).commands)  # type: ignore[attr-defined]


def commands(page: Path) -> Iterator[tuple[str, str]]:
    """The name of each command on a page, and what follows it."""
    text = page.read_text(encoding="utf-8")
    yield from in_blocks(text)
    yield from INLINE.findall(FENCE.sub("", text))


def in_blocks(text: str) -> Iterator[tuple[str, str]]:
    """Those in blocks, with what follows in the next lines too if they are indented."""
    for block in FENCE.findall(text):
        name, rest = "", ""
        for line in block.splitlines():
            begun = LINE.search(line)
            if begun:
                if name:
                    yield name, rest
                name, rest = begun[1], begun[2]
            elif line.startswith("  "):
                rest += line
            elif name:
                yield name, rest
                name = ""
        if name:
            yield name, rest


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_commands_and_their_options_exist(page: Path) -> None:
    known = known_commands()
    for name, rest in commands(page):
        assert name in known, f"evodesign {name}"
        options = {option for each in known[name].params for option in (*each.opts, *each.secondary_opts)}
        named = set(re.findall(r"(?<![\w-])--[a-z][a-z-]*", rest.split("#")[0]))
        assert named <= options, f"evodesign {name}"


def test_the_pages_show_every_command_and_most_options() -> None:
    shown = [(name, rest) for page in PAGES for name, rest in commands(page)]
    assert {name for name, _ in shown} == set(COMMANDS)
    assert sum(rest.count("--") for _, rest in shown) > 60


def whole_lines(page: Path) -> Iterator[tuple[str, list[str]]]:
    """Each command that can be typed as it stands, with its arguments; what is prose or a choice is not."""
    for name, rest in in_blocks(page.read_text(encoding="utf-8")):
        typed = re.split(r"\s#|\s>\s|\s{3,}", rest.rstrip())[0]
        if not re.search(r"[\[\]|]|\.\.", typed):
            yield name, [PLACES.get(each, each) for each in shlex.split(typed)]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_the_command_line_understands_what_can_be_typed(page: Path) -> None:
    known = known_commands()
    for name, arguments in whole_lines(page):
        known[name].make_context(name, arguments)


def test_lines_that_can_be_typed_are_found() -> None:
    found = [(page.name, name, arguments) for page in PAGES for name, arguments in whole_lines(page)]
    assert ("README.md", "search", ["icub-lifting", "--run", "runs/first"]) in found
    assert len(found) > 50


@cache
def modules_of_tests() -> list[tuple[str, str]]:
    """The names and texts of test modules, but for this one."""
    modules = (REPOSITORY / "tests").rglob("*.py")
    return [(each.stem, each.read_text(encoding="utf-8")) for each in modules if each != Path(__file__)]


@cache
def options_in_tests(name: str) -> set[str]:
    """The options of a command that test modules about it give, as words or as arguments of its function."""
    found: set[str] = set()
    for module, text in modules_of_tests():
        if name not in text and name not in module:
            continue
        about = re.search(rf'"{name}"|\bimport .*\b{name}\b', text) or name in module.split("_")
        for each in known_commands()[name].params if about else ():
            given = rf"\b{each.name}=|" + "|".join(rf"(?<![\w-]){option}\b" for option in each.opts)
            found |= set(each.opts) if re.search(given, text) else set()
    return found


@pytest.mark.slow
@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_command_shown_is_run_with_its_options_or_says_why_not(page: Path) -> None:
    for name, rest in commands(page):
        assert name in LINES or f"evodesign {name}" in NOT_RUN, (
            f"evodesign {name} is not run by test_columns.py"
        )
        named = set(re.findall(r"(?<![\w-])--[a-z][a-z-]*", rest.split("#")[0]))
        excused = {each for each in named if f"evodesign {name} {each}" in NOT_RUN}
        assert named - excused <= options_in_tests(name), f"evodesign {name}"


def other_commands() -> set[str]:
    """What pages show of make and Python."""
    found = set()
    for page in PAGES:
        text = page.read_text(encoding="utf-8")
        found |= {each for block in FENCE.findall(text) for each in OTHER.findall(block)}
        found |= set(OTHER_INLINE.findall(FENCE.sub("", text)))
    return found


def excuse(command: str) -> str | None:
    """Why no test runs a command of make or Python."""
    return NOT_RUN.get(command) or NOT_RUN.get(command.rpartition(".")[0])


def test_every_other_command_shown_is_run_by_the_checks_or_says_why_not() -> None:
    checks = "".join(
        (REPOSITORY / ".ci" / name).read_text(encoding="utf-8") for name in ("run", "bare-machine")
    )
    checks = checks.replace(".ci/bare-machine", "make test-bare")
    run = set(re.findall(r"make [a-z-]+", checks))
    assert {each for each in other_commands() if each not in run and not excuse(each)} == set()


def test_no_excuse_is_left_of_a_command_that_is_run_or_no_longer_shown() -> None:
    shown = {each for command in other_commands() for each in (command, command.rpartition(".")[0])}
    for name, rest in (each for page in PAGES for each in commands(page)):
        given = set() if name in LINES else {f"evodesign {name}"}
        options = set(re.findall(r"--[a-z][a-z-]*", rest)) - options_in_tests(name)
        shown |= given | {f"evodesign {name} {option}" for option in options}
    assert set(NOT_RUN) <= shown


def test_tests_named_in_excuses_exist() -> None:
    named = [path for reason in NOT_RUN.values() for path in re.findall(r"[\w/]+\.(?:py|md)", reason)]
    assert named
    assert [path for path in named if not (REPOSITORY / path).exists()] == []
