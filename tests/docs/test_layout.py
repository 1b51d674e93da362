"""The table of the packages and the picture of docs/architecture.md against the import contract."""

from __future__ import annotations

import ast
import re
from itertools import pairwise
from pathlib import Path

from docs.write_floors import PICTURE, floors, picture


def test_the_table_lists_every_package_in_the_order_of_its_floor(repository: Path) -> None:
    packages = [name for floor in floors() for name in floor]
    text = (repository / "docs" / "architecture.md").read_text(encoding="utf-8")
    rows = re.findall(r"(?m)^\| (`evodesign/[^|]*)\|", text)
    names = [name for row in rows for name in re.findall("`(.*?)`", row)]
    listed = [re.sub(r"^evodesign/|/$|\.py$", "", name) for name in names]
    assert listed == [name for name in packages if name != "__main__"]


def test_the_picture_of_the_floors_is_that_of_the_contract() -> None:
    assert PICTURE.read_text(encoding="utf-8") == picture()


def test_neighbouring_floors_have_no_modules_of_one_name(repository: Path) -> None:
    """But for the command line, whose modules have the names of commands."""
    modules = [
        {path.name for name in floor for path in (repository / "evodesign" / name).rglob("*.py")}
        for floor in floors()
        if "cli" not in floor
    ]
    shared = [upper & lower - {"__init__.py"} for upper, lower in pairwise(modules)]
    assert [names for names in shared if names] == []


def test_modules_past_300_lines_say_why(repository: Path) -> None:
    texts = {path: path.read_text(encoding="utf-8") for path in (repository / "evodesign").rglob("*.py")}
    long = {path for path, text in texts.items() if len(text.splitlines()) > 300}
    why = {
        path
        for path, text in texts.items()
        if "Beyond 300 lines: " in (ast.get_docstring(ast.parse(text)) or "")
    }
    assert sorted(long - why) == []
    assert len(texts) > len(long) > 0
