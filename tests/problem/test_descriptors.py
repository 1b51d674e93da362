"""Descriptors in a problem file: names, bounds of parameters, and what is refused."""

from __future__ import annotations

from dataclasses import replace

import msgspec
import pytest

from evodesign.errors import InputError
from evodesign.problem.build import DesignProblem
from evodesign.problem.file import DescriptorTable
from evodesign.records import Descriptor
from evodesign.runlog.header import header_of
from evodesign.session import search_outcome
from tests.runlog.toys import toy_evaluations, toy_header


def settings(problem: DesignProblem, *tables: DescriptorTable) -> tuple[Descriptor, ...]:
    search = msgspec.structs.replace(problem.search, descriptor=tables)
    return replace(problem, search=search).settings("map-elites").described


def test_parameters_have_their_bounds_and_sums_the_sums(problem: DesignProblem) -> None:
    found = settings(
        problem,
        DescriptorTable(name="length.thigh + length.shank"),
        DescriptorTable(name="reach_height", lower=1.2, cells=7),
    )
    assert found == (
        Descriptor("length.thigh + length.shank", 1.2, 3.6, 20),
        Descriptor("reach_height", 1.2, None, 7),
    )
    assert settings(problem) == ()


@pytest.mark.parametrize(
    ("table", "words"),
    [
        (DescriptorTable(name="length.thig"), r"search\.descriptor\[0\]\.name: wanted a sum .* did you mean"),
        (DescriptorTable(name="length.thigh", lower=2.0), r"descriptor\[0\]\.upper: wanted more than .* 2"),
        (DescriptorTable(name="robot_torque@3.3"), r"found 'robot_torque@3\.3'"),
    ],
)
def test_what_makes_no_sense_is_refused(problem: DesignProblem, table: DescriptorTable, words: str) -> None:
    with pytest.raises(InputError, match=words):
        settings(problem, table)


def test_the_same_twice_is_refused(problem: DesignProblem) -> None:
    with pytest.raises(InputError, match="every descriptor once"):
        settings(problem, *(DescriptorTable(name="length.thigh") for _ in range(2)))


def test_a_search_is_told_the_values_of_its_descriptors() -> None:
    header = toy_header()
    named = (Descriptor("arm.0 + arm.1", None, None, 5), Descriptor("robot_torque", None, None, 5))
    header = msgspec.structs.replace(header, search=msgspec.structs.replace(header.search, descriptors=named))
    for each in toy_evaluations(header, 12):
        told = search_outcome(header, each).descriptors
        assert told[0] == pytest.approx(sum(each.assessment.design.values()))
        assert told[1] == each.assessment.objectives.get("robot_torque")


def test_they_stand_in_the_header_and_only_where_they_are_named(problem: DesignProblem) -> None:
    tables = (DescriptorTable(name="length.thigh"),)
    named = replace(problem, search=msgspec.structs.replace(problem.search, descriptor=tables))
    for asked, present in ((named, True), (problem, False)):
        header = header_of(asked, asked.settings("map-elites"), 10)
        assert (b"descriptors" in msgspec.json.encode(header.search)) is present
        assert msgspec.json.decode(msgspec.json.encode(header), type=type(header)) == header
