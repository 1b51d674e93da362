"""Families: of every kind the best design, by whatever quantities tell kinds apart."""

from __future__ import annotations

import math

import msgspec
import pytest

from evodesign.analysis.conditions import quantities, total
from evodesign.analysis.families import families, families_json
from evodesign.errors import InputError
from evodesign.records import Descriptor
from tests.runlog.toys import toy_evaluations, toy_header

HEADER = toy_header(budget=200)
RUN = toy_evaluations(HEADER, 200)
TORQUE = "robot_torque"


def test_every_elite_is_the_best_of_its_cell_and_every_design_has_one() -> None:
    found = families(HEADER, RUN, by=("arm.0", "reach_height"), cells=6)
    assert [(each.name, each.cells) for each in found.descriptors] == [("arm.0", 6), ("reach_height", 6)]
    elites = {kind.cell: kind.elite for kind in found.kinds}
    seen = set()
    for each in (one for one in RUN if one.feasible and TORQUE in one.assessment.objectives):
        values = (each.assessment.design["arm.0"], each.assessment.objectives["reach_height"])
        cell = tuple(
            min(math.floor((value - axis.lower) / (axis.upper - axis.lower) * 6), 5)
            for axis, value in zip(found.descriptors, values, strict=True)
            if axis.lower is not None and axis.upper is not None
        )
        seen.add(cell)
        assert elites[cell].assessment.objectives[TORQUE] <= each.assessment.objectives[TORQUE]
    assert seen == set(elites)
    assert found.cells == 36


def test_the_score_counts_from_the_worst() -> None:
    told = families_json(families(HEADER, RUN, by=("arm.0",), cells=4))
    worst = max(each.assessment.objectives[TORQUE] for each in RUN if each.feasible)
    assert told["worst"] == worst
    assert told["qd_score"] == pytest.approx(
        sum(worst - kind["objectives"][TORQUE] for kind in told["kinds"])
    )
    assert told["filled"] == len(told["kinds"]) == 4
    assert told["coverage"] == 1.0


def test_a_maximised_objective_has_its_greatest_values() -> None:
    found = families(HEADER, RUN, by=("arm.1",), objective="reach_height", cells=1)
    greatest = max(each.assessment.objectives["reach_height"] for each in RUN if each.feasible)
    (kind,) = found.kinds
    assert kind.elite.assessment.objectives["reach_height"] == greatest


def test_quantities_are_added_up_and_beyond_bounds_are_the_cells_at_the_edge() -> None:
    both = Descriptor("arm.0 + arm.1", 2.0, 3.0, 4)
    search = msgspec.structs.replace(HEADER.search, descriptors=(both,))
    found = families(msgspec.structs.replace(HEADER, search=search), RUN)
    assert found.descriptors == (both,)
    for kind in found.kinds:
        length = sum(kind.elite.assessment.design.values())
        assert kind.values == (pytest.approx(length),)
        assert kind.cell == (min(max(math.floor((length - 2.0) * 4), 0), 3),)


def test_nothing_named_means_the_first_two_parameters() -> None:
    assert [each.name for each in families(HEADER, RUN).descriptors] == ["arm.0", "arm.1"]


def test_without_a_feasible_design_there_are_no_families() -> None:
    found = families(HEADER, [each for each in RUN if not each.feasible])
    assert (found.kinds, found.worst, found.score) == ((), None, 0.0)


def test_unknown_names_are_refused_with_the_nearest() -> None:
    with pytest.raises(InputError, match=r"'arm\.3'"):
        families(HEADER, RUN, by=("arm.0 + arm.3",))
    with pytest.raises(InputError, match="wanted one of robot_torque, reach_height, found 'reach'"):
        families(HEADER, RUN, objective="reach")


def test_values_of_any_size_have_a_cell() -> None:
    huge = [
        msgspec.structs.replace(
            each, assessment=msgspec.structs.replace(each.assessment, design={"arm.0": size, "arm.1": 0.0})
        )
        for each, size in zip([one for one in RUN if one.feasible], (-1.7e308, 1.7e308, 0.0), strict=False)
    ]
    found = families(HEADER, huge, by=("arm.0",), cells=5)
    assert sorted(kind.cell for kind in found.kinds) == [(0,), (2,), (4,)]


def test_a_sum_of_something_that_does_not_exist_is_none() -> None:
    lost = next(each for each in RUN if not each.feasible)
    known = quantities(HEADER, lost)
    assert total(known, "arm.0 + robot_torque", lost) is None
    assert total(known, "arm.0 + arm.1", lost) == pytest.approx(sum(lost.assessment.design.values()))
