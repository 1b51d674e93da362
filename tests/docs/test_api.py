"""The reference of the Python interface is what the docstrings say, and their examples work as they stand."""

from __future__ import annotations

import doctest
import inspect
import re
import shutil
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest

import evodesign
from docs.write_api import PAGE, RECORDS, Documented, documented, page

ALL = documented()
LIFTING = Path(__file__).parents[1] / "golden" / "lifting"
OPTIONS = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE


@pytest.fixture(scope="module")
def names(
    repository: Path, run_with_people: Path, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[dict[str, Any]]:
    """What examples may name, in a directory that holds `runs/first`, `runs/people` and `problem.toml`."""
    place = tmp_path_factory.mktemp("examples")
    shutil.copytree(LIFTING / "format-2", place / "runs" / "first")
    shutil.copytree(run_with_people, place / "runs" / "people")
    (place / "problems").symlink_to(repository / "problems")
    (place / "populations").symlink_to(repository / "populations")
    text = (LIFTING / "problem.toml").read_text(encoding="utf-8").replace("../../../problems/", "problems/")
    (place / "problem.toml").write_text(text, encoding="utf-8")
    shutil.copy(LIFTING / "start.toml", place)
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(place)
        run = evodesign.open_run("runs/first")
        problem = evodesign.open_problem("problem.toml")
        yield {"evodesign": evodesign, "np": np, "run": run, "design": run.design(4), "problem": problem}


def test_the_stored_page_is_what_the_docstrings_say() -> None:
    assert PAGE.read_text(encoding="utf-8") == page(), "write it anew: make api"


def test_everything_public_is_on_the_page() -> None:
    shown = {each.name for each in ALL}
    assert {name for name in evodesign.__all__ if not name.startswith("_")} <= shown
    assert {"Run", "Run.choose", "Design", "Design.reach", "Problem", "Problem.evaluate"} <= shown


@pytest.mark.parametrize("each", ALL, ids=lambda each: each.name)
def test_every_public_name_has_a_docstring(each: Documented) -> None:
    assert each.text


def examples(each: Documented) -> list[doctest.Example]:
    return doctest.DocTestParser().get_examples(each.text, each.name)


@pytest.mark.parametrize("each", [each for each in ALL if each.depth == 2], ids=lambda each: each.name)
def test_what_is_imported_or_given_has_an_example(each: Documented) -> None:
    assert examples(each)


@pytest.mark.slow
@pytest.mark.parametrize("each", [each for each in ALL if examples(each)], ids=lambda each: each.name)
def test_examples_work_as_they_stand(each: Documented, names: dict[str, Any]) -> None:
    test = doctest.DocTestParser().get_doctest(each.text, dict(names), each.name, None, None)
    told: list[str] = []
    result = doctest.DocTestRunner(optionflags=OPTIONS).run(test, out=told.append)
    assert result.failed == 0, "".join(told)
    assert result.attempted > 0


@pytest.mark.parametrize("record", RECORDS[:4], ids=lambda record: record.__name__)
def test_every_field_of_a_posture_is_documented(record: type[msgspec.Struct]) -> None:
    section = re.search(r"Attributes:\n((?: {4}.*\n?)*)", inspect.getdoc(record) or "")
    assert section is not None
    assert tuple(re.findall(r"^ {4}(\w+): ", section[1], re.MULTILINE)) == record.__struct_fields__


def reachable(thing: Any, depth: int = 5) -> Iterator[Any]:
    """An object of this package and everything that its public attributes and containers lead to."""
    if isinstance(thing, dict | Mapping):
        thing = [*thing.values()]
    if isinstance(thing, tuple | list):
        for each in thing[:3]:
            yield from reachable(each, depth)
    elif type(thing).__module__.startswith(("evodesign.api", "evodesign.records", "evodesign.runlog")):
        yield thing
        names = [name for name in dir(thing) if not name.startswith("_")] if depth else []
        for name in names:
            try:
                found = getattr(thing, name)
            except ValueError:  # the only instant, of many
                continue
            if not callable(found):
                yield from reachable(found, depth - 1)


def test_whatever_a_user_holds_shows_itself_in_one_short_line(names: dict[str, Any]) -> None:
    seen = {type(each): repr(each) for start in names.values() for each in reachable(start)}
    assert {"Run", "Design", "Problem", "CaseDetail", "AgentDetail", "RunLog", "ProblemSource"} <= {
        kind.__name__ for kind in seen
    }
    for kind, shown in seen.items():
        assert "\n" not in shown, kind
        assert len(shown) < 200, kind


def test_attributes_of_objects_are_documented(names: dict[str, Any]) -> None:
    for name in ("run", "problem"):
        value = names[name]
        section = re.search(r"Attributes:\n((?: {4}.*\n?)*)", inspect.getdoc(type(value)) or "")
        assert section is not None
        told = set(re.findall(r"^ {4}(\w+): ", section[1], re.MULTILINE))
        assert told == {attribute for attribute in vars(value) if not attribute.startswith("_")}


UNIT = re.compile(r"\[[^\]]+\]|\bunit\b|\bunits\b")
QUANTITIES = re.compile(r"\b(torques?|densit(y|ies)|heights?|reach|violations?|forces|moments)\b")


@pytest.mark.parametrize("each", ALL, ids=lambda each: each.name)
def test_a_docstring_that_speaks_of_quantities_names_units(each: Documented) -> None:
    prose = re.split(r"\n\s*(?:Raises|Example):", re.sub(r"`[^`]*`", "", each.text))[0]
    assert not QUANTITIES.search(prose) or UNIT.search(each.text)


def test_a_change_of_a_docstring_changes_the_page(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(evodesign.open_run, "__doc__", "Another sentence.")
    assert "Another sentence." in page()
    assert page() != PAGE.read_text(encoding="utf-8")


def test_the_page_has_the_form_of_its_sections() -> None:
    def example(size: float) -> float:
        """Twice the size.

        Args:
            size: of it [m];
                a number.
        Returns:
            Twice that [m].
        Example:
            >>> example(1.0)
            2.0
        """
        return 2.0 * size

    from docs.write_api import _parts

    shown = "\n".join(_parts(Documented("example", example, 2)))
    assert "example(size: float) -> float" in shown
    assert "- `size`: of it [m];\n  a number." in shown
    assert "Gives:\n\nTwice that [m]." in shown
    assert "```pycon\n>>> example(1.0)\n2.0\n```" in shown
