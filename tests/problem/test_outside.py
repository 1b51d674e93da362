"""Objectives and searches that stand in modules outside of the package, under names such as `module:name`."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any, cast

import msgspec
import pytest

from evodesign.errors import InputError
from evodesign.evaluation.evaluate import AssessmentFactory
from evodesign.evaluation.factory import Remembering
from evodesign.posture.precompute.precomputed import NOTHING_PRECOMPUTED
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.quantities.design_result import DesignResult, ObjectiveKind
from evodesign.quantities.objectives import objective_kind, objective_kinds, objective_value
from evodesign.records import SearchSettings

MODULE = """
from evodesign.quantities.objectives import CaseQuantity, ObjectiveKind

load = CaseQuantity("kg", lambda scene, postures: scene.payload.mass)
joints = ObjectiveKind("1", lambda result: float(len(result.robot.joints)))
mistaken = ObjectiveKind("1", lambda result: 1 / 0)
number = 3
words = ObjectiveKind("1", lambda result: "heavy")
endless = ObjectiveKind("1", lambda result: float("nan"))
several = CaseQuantity("kg", lambda scene, postures: [1.0, 2.0])
missing = CaseQuantity("kg", lambda scene, postures: None)

class Middle:
    def __init__(self, settings):
        self.settings = settings

    def ask(self):
        return [(0.5,) * self.settings.dimension]
"""


@pytest.fixture(autouse=True)
def module(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    (tmp_path / "of_mine.py").write_text(MODULE)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setenv("EVODESIGN_MODULES", "of_mine, of_nobody")
    yield
    sys.modules.pop("of_mine", None)


def asking(problem: DesignProblem, name: str) -> DesignProblem:
    text = problem.source.text.replace('"human_torque"', f'"{name}"')
    return build_problem(msgspec.structs.replace(problem.source, text=text))


def test_problem_has_objectives_from_outside_with_their_units(problem: DesignProblem) -> None:
    for name, unit in (("of_mine:load", "kg"), ("q90_of_mine:load", "kg"), ("of_mine:joints", "1")):
        assert (name, unit) in [(each.name, each.unit) for each in asking(problem, name).objectives]


def test_ways_over_the_cases_apply_to_quantities_alone() -> None:
    assert isinstance(objective_kind("worst_of_mine:load"), ObjectiveKind)
    with pytest.raises(InputError, match="wanted a CaseQuantity, found 'of_mine:joints', which is Objective"):
        objective_kind("worst_of_mine:joints")


def test_names_of_the_package_mean_what_they_did() -> None:
    for name, kind in objective_kinds().items():
        found = objective_kind(name)
        assert found is not None
        assert found.unit == kind.unit
    assert objective_kind("q90_robot_torque") is not None
    assert objective_kind("q90_reach_height") is None
    assert objective_kind("worst_") is None


@pytest.mark.parametrize(
    ("name", "words"),
    [
        (
            "of_nobody:load",
            "wanted MODULE:NAME of something that Python can import, found 'of_nobody:load' (No",
        ),
        ("of_mine:weight", "found 'of_mine:weight' (module 'of_mine' has no attribute 'weight')"),
        ("of_mine:number", "wanted a CaseQuantity or an ObjectiveKind, found 'of_mine:number', which is int"),
        (":", "wanted a module that the environment variable EVODESIGN_MODULES names, found ':'"),
    ],
)
def test_wrong_places_are_refused_in_one_sentence(problem: DesignProblem, name: str, words: str) -> None:
    with pytest.raises(InputError) as refused:
        asking(problem, name)
    assert words in str(refused.value)


@pytest.mark.parametrize(
    ("text", "words"),
    [("def load(:", "(SyntaxError: invalid syntax"), ("load = nothing", "(NameError: name 'nothing' is not")],
)
def test_modules_that_cannot_be_imported_are_refused_in_one_sentence(
    problem: DesignProblem, tmp_path: Path, text: str, words: str
) -> None:
    (tmp_path / "of_mine.py").write_text(text)
    with pytest.raises(InputError, match="wanted MODULE:NAME of something that Python can import") as refused:
        asking(problem, "of_mine:load")
    assert words in str(refused.value)


def test_evaluations_with_code_from_outside_are_not_kept(
    problem: DesignProblem, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A changed function of one's own must not find what it gave before."""
    monkeypatch.setenv("EVODESIGN_CACHE", str(tmp_path / "cache"))
    seen: list[Any] = []
    monkeypatch.setattr(AssessmentFactory, "__call__", lambda factory: seen.append)
    factory = AssessmentFactory("digest", asking(problem, "of_mine:load"), NOTHING_PRECOMPUTED)
    for _ in range(2):
        Remembering(factory)()((0.5,))
    assert seen == [(0.5,), (0.5,)]
    assert not list((tmp_path / "cache").rglob("evaluations*"))


@pytest.mark.parametrize("asynchronous", [False, True])
def test_searches_from_outside(asynchronous: bool) -> None:
    from evodesign.searches.registry import make_asynchronous_search, make_search

    make: Any = make_asynchronous_search if asynchronous else make_search
    settings = SearchSettings(algorithm="of_mine:Middle", dimension=2, objectives=1, population=4, seed=1)
    assert make(settings).ask() == [(0.5, 0.5)]
    for wrong in ("of_nobody:Middle", "of_mine:Centre"):
        with pytest.raises(InputError, match=f"algorithm: wanted MODULE:NAME .*, found '{wrong}'"):
            make(msgspec.structs.replace(settings, algorithm=wrong))


def test_nothing_is_imported_that_the_user_has_not_named(
    problem: DesignProblem, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A name may stand in a run that somebody has sent."""
    from evodesign.searches.registry import make_search

    settings = SearchSettings(algorithm="of_mine:Middle", dimension=2, objectives=1, population=4, seed=1)
    for allowed in (None, "", "of_min", "of_mine.more", "of_mine:load"):
        if allowed is None:
            monkeypatch.delenv("EVODESIGN_MODULES")
        else:
            monkeypatch.setenv("EVODESIGN_MODULES", allowed)
        for ask in (lambda: asking(problem, "of_mine:load"), lambda: make_search(settings)):
            with pytest.raises(InputError, match=r"to let its code run, set EVODESIGN_MODULES=of_mine$"):
                ask()
    assert "of_mine" not in sys.modules
    with pytest.raises(InputError, match="wanted a module that the environment variable"):
        make_search(msgspec.structs.replace(settings, algorithm="subprocess:Popen"))


def test_a_function_that_fails_is_told_in_a_sentence_with_its_line() -> None:
    fails = r"found 'of_mine:mistaken', which fails: ZeroDivisionError: division by zero \(of_mine.py:6 in <"
    with pytest.raises(
        InputError, match=f"^objectives: wanted a function that gives a value, or None, {fails}"
    ):
        objective_value("of_mine:mistaken", cast("DesignResult", None))


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("words", "could not convert string to float: 'heavy'"),
        ("endless", "it gives nan, which is no finite number"),
        ("several", "not 'list'"),
        ("missing", "not 'NoneType'"),
    ],
)
def test_what_is_no_finite_number_is_no_value(name: str, words: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a list the mean was taken, and text failed where gradients are differenced."""
    once = "evodesign.quantities.design_result.values_over_cases"
    monkeypatch.setattr(once, lambda value, result: [value(None, None)])
    with pytest.raises(InputError, match=f"'of_mine:{name}', which fails: .*{words}"):
        objective_value(f"of_mine:{name}", cast("DesignResult", None))
