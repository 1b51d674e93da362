"""The problems that come with evodesign: known by their names, wherever it is installed.

In a checkout they lie in `problems/`, in an installed package in `evodesign/data/problems/`.
"""

from __future__ import annotations

import os
import tomllib
from dataclasses import dataclass
from pathlib import Path

from evodesign.errors import InputError, offered
from evodesign.files import is_there

PACKAGE = Path(__file__).parents[1]
INSTALLED = PACKAGE / "data" / "problems"
SHIPPED = INSTALLED if INSTALLED.is_dir() else PACKAGE.parent / "problems"
"""Folder of the problems, from which they name their robots and starting designs."""


@dataclass(frozen=True, slots=True)
class ShippedProblem:
    """A problem that comes with evodesign.

    Args:
        name: by which every command and `open_problem` know it.
        description: in a sentence.
        path: of its file.
    """

    name: str
    description: str
    path: Path


def shipped_problems() -> tuple[ShippedProblem, ...]:
    """All of them, ordered by name."""
    tables = {path: tomllib.loads(path.read_text(encoding="utf-8")) for path in SHIPPED.glob("*.toml")}
    found = [ShippedProblem(table["name"], table["description"], path) for path, table in tables.items()]
    return tuple(sorted(found, key=lambda problem: problem.name))


def problem_path(problem: str | os.PathLike[str]) -> Path:
    """The file of a problem, given as a path or as a shipped problem's name; a file goes before a name.

    Raises:
        InputError: a word that is neither.
    """
    path = Path(problem)
    if (is_there(path) and path.is_file()) or path.suffix or len(path.parts) != 1:
        return path
    known = {shipped.name: shipped.path for shipped in shipped_problems()}
    if path.name not in known:
        names, found = offered(known, str(problem), path.name)
        raise InputError("PROBLEM", "", f"a problem file, or one of the problems {names}", found)
    return known[path.name]
