"""Names are the field's: no module, class or function has a word that only this project would understand.

Each word was a private one, or named two things; what to say instead stands beside it.
"""

from __future__ import annotations

import ast
import re
from collections import defaultdict
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).parents[1]
PACKAGE = REPOSITORY / "evodesign"

INSTEAD = {
    "answer": "result",
    "arrival": "outcome",
    "bear": "carry, support, transmit",
    "bearing": "load case",
    "borne": "carried; load case",
    "branched": "restarted",
    "bridge": "api",
    "calm": "undisturbed",
    "cast": "scene models",
    "comfort": "regularisation",
    "company": "scene set",
    "conquer": "dominate",
    "crew": "worker group",
    "door": "prefetch",
    "gate": "stoppable",
    "house": "project",
    "kink": "derivative notes; where no derivative exists",
    "luck": "dependence on the starting point",
    "policy": "allocation",
    "quiet": "undisturbed",
    "retold": "warm start",
    "room": "package",
    "shelf": "solver cache",
    "squeeze": "internal force",
    "steady": "asynchronous",
    "strain": "torque",
    "thinning": "subsample",
    "told": "reported",
    "uncrowded": "hypervolume improvement",
    "watched": "live state",
    "witness": "reference implementation",
    "worth": "value, results",
}
"""Words for no module, class or function, each with what to say instead."""

MODULES = {
    "enforced": "limit groups",
    "memory": "session log",
    "published": "paper setting",
    "remember": "evaluation cache",
    "statics": "mechanics",
    "tangent": "solution derivative",
}
"""Words that say something else in the name of a class or function."""

CLASSES = {"standing": "run state"}
"""Words for no class; a function may be about a standing robot."""

PLACES = {"pool": {"cell": "worker process"}, "posture": {"stretch": "reach"}}
"""Words that mean something else in other packages: a cell of a table, a link that is stretched."""

ONCE = ("outcome_of", "over_cases", "value_of")
"""Functions whose names meant two things."""

ENDINGS = {"": "", "s": "", "es": "", "ies": "y", "ed": "", "ing": ""}
"""Endings of words with what they stand for."""


@dataclass(frozen=True)
class Named:
    """A module, class or function."""

    kind: str
    name: str
    place: str
    package: str

    @property
    def words(self) -> list[str]:
        """Parts of the name, in lower case: `_PostureTerm` and `posture_term` have two."""
        return [part.lower() for part in re.findall(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+", self.name)]

    @property
    def forbidden(self) -> dict[str, str]:
        """Words that it may not have."""
        own = {"module": MODULES, "class": CLASSES}.get(self.kind, {})
        return {**INSTEAD, **own, **PLACES.get(self.package, {})}


KINDS = {ast.ClassDef: "class", ast.FunctionDef: "function", ast.AsyncFunctionDef: "function"}


@cache
def read_package() -> tuple[list[Named], list[str]]:
    """All that has a name, and the modules with a docstring that cites DESIGN, from one look at each file."""
    named, citing = [], []
    for path in sorted(PACKAGE.rglob("*.py")):
        place = str(path.relative_to(REPOSITORY))
        package = path.relative_to(PACKAGE).parts[0]
        stem = path.parent.name if path.stem == "__init__" else path.stem
        named.append(Named("module", stem, place, package))
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if kind := KINDS.get(type(node)):
                named.append(Named(kind, node.name, f"{place}:{node.lineno}", package))
            if isinstance(node, (ast.Module, *KINDS)) and cites(ast.get_docstring(node) or ""):
                citing.append(place)
    return named, citing


def cites(docstring: str) -> bool:
    return re.search(r"\bDESIGN\b(?!\.md)", docstring) is not None


def stems(word: str) -> set[str]:
    """A word and what it may be a form of: `strains`, `policies`, `conquered`."""
    ended = [(ending, stem) for ending, stem in ENDINGS.items() if word.endswith(ending)]
    return {word[: len(word) - len(ending)] + stem for ending, stem in ended}


def faults(found: Named) -> list[str]:
    forbidden = found.forbidden
    parts = [(word, stem) for word in found.words for stem in stems(word) if stem in forbidden]
    return [f"{found.place}: {found.name}: say {forbidden[stem]} instead of {word}" for word, stem in parts]


def test_names_are_words_of_the_field() -> None:
    assert [fault for found in read_package()[0] for fault in faults(found)] == []


@pytest.mark.parametrize(
    ("kind", "name", "package", "wrong"),
    [
        ("class", "RobotStrains", "report", True),
        ("function", "_policies", "problem", True),
        ("function", "conquered_by", "search", True),
        ("function", "set_constraint", "nlp", False),
        ("module", "memory", "runlog", True),
        ("function", "out_of_memory", "pool", False),
        ("function", "_cell", "report", False),
        ("class", "Cell", "pool", True),
    ],
)
def test_words_are_parts_of_names(kind: str, name: str, package: str, wrong: bool) -> None:
    assert bool(faults(Named(kind, name, "", package))) is wrong


def test_no_class_is_defined_twice() -> None:
    places: defaultdict[str, list[str]] = defaultdict(list)
    for found in read_package()[0]:
        if found.kind == "class":
            places[found.name].append(found.place)
    assert {name: where for name, where in places.items() if len(where) > 1} == {}


@pytest.mark.parametrize("name", ONCE)
def test_functions_that_had_two_meanings_have_one(name: str) -> None:
    named, _ = read_package()
    assert len([found for found in named if found.kind == "function" and found.name == name]) <= 1


def test_docstrings_cite_only_what_is_in_the_repository() -> None:
    assert read_package()[1] == []
    assert cites("as DESIGN 3 has it")
