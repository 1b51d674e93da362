"""The licence notes say what the installed wheels say, and leave out nothing that evodesign depends on."""

from __future__ import annotations

import re
import tomllib
from importlib.metadata import distribution
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).parents[2]
NOTES = (REPOSITORY / "THIRD_PARTY_LICENSES.md").read_text(encoding="utf-8")
ROW = re.compile(r"^\| ([\w-]+) \| (.+?) \| (.+?) \| `(.+?)` \| (.+?) \|$", re.MULTILINE)
ROWS = ROW.findall(NOTES)
EXTRAS = ("cad", "control", "dask", "drake", "measured", "mjcf", "notebook", "simulate")


def test_every_dependency_has_a_row() -> None:
    project = tomllib.loads((REPOSITORY / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = project["optional-dependencies"]
    wanted = [*project["dependencies"], *(each for name in EXTRAS for each in extras[name])]
    names = {re.split(r"[><=~\[;]", each)[0] for each in wanted} - {"evodesign"}
    assert names - {wheel for wheel, *_ in ROWS} == set()


@pytest.mark.parametrize(("wheel", "file", "words"), [(row[0], row[3], row[4]) for row in ROWS])
def test_the_file_named_has_these_words(wheel: str, file: str, words: str) -> None:
    installed = distribution(wheel)
    text = installed.read_text(file) or Path(str(installed.locate_file(file))).read_text(encoding="utf-8")
    assert words in re.sub(r"\s+", " ", text)


@pytest.mark.slow
def test_libraries_named_are_in_the_wheels() -> None:
    files = {row[0]: {path.name for path in distribution(row[0]).files or ()} for row in ROWS}
    library = re.compile(r"`(lib[\w.-]*\.so[\w.]*)`")
    named = [(wheel, name) for wheel, part, *_ in ROWS for name in library.findall(part)]
    assert len(named) > 8
    assert [each for each in named if each[1] not in files[each[0]]] == []
