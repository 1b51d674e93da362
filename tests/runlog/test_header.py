from __future__ import annotations

from pathlib import Path

import msgspec
import pytest

from evodesign.errors import RunError
from evodesign.records import RunHeader
from evodesign.runlog.header import differences, renewed, version_differences, versions
from tests.runlog.toys import toy_header

HEADER = msgspec.structs.replace(toy_header(), versions=versions(), started="2020-01-01T00:00:00+00:00")

UNVERSIONED = toy_header()


def test_a_later_session_has_its_own_time_and_nothing_to_note() -> None:
    new, notes = renewed(HEADER, Path("run"), accept_versions=False)
    assert notes == ()
    assert new.started > HEADER.started
    assert msgspec.structs.replace(new, started=HEADER.started, git=HEADER.git) == HEADER


def test_a_clock_that_was_set_back_is_noted() -> None:
    ahead = msgspec.structs.replace(HEADER, started="2999-01-01T00:00:00+00:00")
    _, (note,) = renewed(ahead, Path("run"), accept_versions=False)
    assert note.startswith("the clock stands before 2999")


def test_other_versions_are_refused_unless_accepted() -> None:
    other = msgspec.structs.replace(HEADER, versions={**versions(), "numpy": "0.1"})
    with pytest.raises(RunError, match=r"was written with numpy 0\.1 .*--accept-versions"):
        renewed(other, Path("run"), accept_versions=False)
    assert renewed(other, Path("run"), accept_versions=True)[0].versions == versions()


def with_problem(text: str, files: dict[str, str]) -> RunHeader:
    problem = msgspec.structs.replace(UNVERSIONED.problem, text=text, files=files, path="elsewhere.toml")
    return msgspec.structs.replace(UNVERSIONED, problem=problem)


def test_what_may_change_between_sessions_is_no_difference() -> None:
    later = msgspec.structs.replace(
        UNVERSIONED, budget=99, versions={}, git="abc", started="now", hours=1.0, stagnation_generations=3
    )
    moved = with_problem(UNVERSIONED.problem.text, UNVERSIONED.problem.files)
    assert differences(UNVERSIONED, later) == differences(UNVERSIONED, moved) == []


def test_a_changed_problem_is_told_by_line_and_file() -> None:
    first = with_problem("a = 1\nb = 2\nc = 3\n", {"robot.urdf": "x", "human.urdf": "y"})
    second = with_problem("a = 1\nb = 4\nc = 3\n", {"robot.urdf": "z", "search.start": "s"})
    assert differences(first, second) == [
        "the problem file differs in line 2",
        "the file of 'human.urdf' differs",
        "the file of 'robot.urdf' differs",
        "the file of 'search.start' differs",
    ]
    longer = with_problem("a = 1\nb = 2\nc = 3\nd = 4\n", first.problem.files)
    assert differences(first, longer) == ["the problem file differs in line 4"]


def test_a_changed_search_is_told_with_both_values() -> None:
    assert differences(UNVERSIONED, toy_header(seed=2, population=6)) == [
        "the search's population was '4' and is '6'",
        "the search's seed was '1' and is '2'",
    ]


def test_changed_parameters_of_the_same_problem_are_told() -> None:
    (first, *rest) = UNVERSIONED.parameters
    wider = (msgspec.structs.replace(first, upper=3.0), *rest)
    assert differences(UNVERSIONED, msgspec.structs.replace(UNVERSIONED, parameters=wider)) == [
        "its parameters differ"
    ]


def test_only_versions_that_decide_results_count() -> None:
    first = {"python": "3.11.1", "numpy": "2.0", "casadi": "3.7", "joblib": "1.4", "pymoo": "0.6"}
    second = {"python": "3.11.2", "numpy": "2.1", "casadi": "3.7", "joblib": "1.5", "cma": "4"}
    assert version_differences(first, second) == ["numpy 2.0 (now 2.1)"]


def test_another_symmetry_is_told() -> None:
    problem = msgspec.structs.replace(UNVERSIONED.problem, symmetry="off")
    free = msgspec.structs.replace(UNVERSIONED, problem=problem)
    assert differences(UNVERSIONED, free) == ["the symmetry was None and is off"]
