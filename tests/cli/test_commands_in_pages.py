"""Every command that README and docs show exists, with every option that they name.

That each command runs is seen in `test_columns.py`.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest
import typer

from evodesign.cli.main import COMMANDS, app

REPOSITORY = Path(__file__).parents[2]
PAGES = sorted(
    path
    for path in (*REPOSITORY.glob("*.md"), *REPOSITORY.glob("docs/*.md"), *REPOSITORY.glob("examples/*.md"))
    if path.name != "CHANGELOG.md"  # which tells of what there was, too
)
FENCE = re.compile(r"^```\w*\n(.*?)^```$", re.MULTILINE | re.DOTALL)
INLINE = re.compile(r"`evodesign ([a-z]+)([^`]*)`")
LINE = re.compile(r"(?:^|\$ )evodesign ([a-z]+)(.*)")


def commands(page: Path) -> Iterator[tuple[str, str]]:
    """The name of each command on a page, and what follows it, in the next lines too if they are indented."""
    text = page.read_text(encoding="utf-8")
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
    yield from INLINE.findall(FENCE.sub("", text))


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_commands_and_their_options_exist(page: Path) -> None:
    known = typer.main.get_command(app).commands  # type: ignore[attr-defined]
    for name, rest in commands(page):
        assert name in known, f"evodesign {name}"
        options = {option for each in known[name].params for option in (*each.opts, *each.secondary_opts)}
        named = set(re.findall(r"(?<![\w-])--[a-z][a-z-]*", rest.split("#")[0]))
        assert named <= options, f"evodesign {name}"


def test_the_pages_show_every_command_and_most_options() -> None:
    shown = [(name, rest) for page in PAGES for name, rest in commands(page)]
    assert {name for name, _ in shown} == set(COMMANDS)
    assert sum(rest.count("--") for _, rest in shown) > 60
