"""A run from Python: the log's numbers, and the same choices as on the command line."""

from __future__ import annotations

import math
from pathlib import Path

import msgspec
import pandas as pd
import pytest

import evodesign
from evodesign.analysis.decision_making import knees
from evodesign.analysis.front import front
from evodesign.api.design import Design
from evodesign.api.run import Run
from evodesign.errors import InputError, RunError
from evodesign.records import Evaluation
from evodesign.runlog.writer import RunWriter
from tests.runlog.toys import lost, toy_detail, toy_evaluations, toy_header

HEADER = toy_header(budget=30)
RUN = toy_evaluations(HEADER, 30)
FRONT = front(HEADER.objectives, RUN)


@pytest.fixture
def run(tmp_path: Path) -> Run:
    with RunWriter(tmp_path / "run", HEADER) as writer:
        for evaluation in RUN:
            if evaluation in FRONT:
                writer.write(toy_detail(evaluation))
            writer.write(evaluation)
    return evodesign.open_run(str(tmp_path / "run"))


def test_table_is_a_data_frame_of_the_log(run: Run) -> None:
    table = pd.DataFrame(run.table())
    assert len(table) == len(run) == len(RUN)
    for row, evaluation in zip(table.to_dict("records"), RUN, strict=True):
        assert row["number"] == evaluation.number
        assert row["feasible"] == evaluation.feasible
        for name, value in {**evaluation.assessment.design, **evaluation.assessment.objectives}.items():
            assert row[name] == value
        if not evaluation.feasible:
            assert math.isnan(row["robot_torque"])
        assert row["robot_torque@1"] == evaluation.assessment.cases[0].robot_torque_norm or math.isnan(
            row["robot_torque@1"]
        )


def test_table_of_some_designs_keeps_their_order(run: Run) -> None:
    designs = run.choose(different=True, limit=3)
    assert run.table(designs)["number"].tolist() == [design.number for design in designs]


def test_front_and_choices_are_those_of_the_command_line(run: Run) -> None:
    assert sorted(design.number or 0 for design in run.front) == [each.number for each in FRONT]
    expected = [each.number for each in knees(HEADER.objectives, FRONT)[:2]]
    assert [design.number for design in run.choose(knee=True, limit=2)] == expected
    assert run.choose(near={"reach_height": 1.5}, limit=1)[0].feasible
    assert all(design.parameters["arm.0"] > 1.0 for design in run.choose(where="arm.0 > 1"))


def test_a_list_of_conditions_chooses_what_meets_all_of_them(run: Run) -> None:
    both = run.choose(where=["arm.0 > 1", "reach_height < 1.9"])
    assert both == run.choose(where="arm.0 > 1 and reach_height < 1.9")
    assert len(both) > 0
    assert run.choose(where=[]) == run.choose(where="") == run.front
    with pytest.raises(InputError, match=r"where: wanted NAME < \| <= \| > \| >= NUMBER"):
        run.choose(where=["arm.0 > 1", ""])


def test_a_design_shows_what_it_is_good_for_or_why_not(run: Run) -> None:
    best = run.front[0]
    values = (best.objectives["robot_torque"], best.objectives["reach_height"])
    assert repr(best) == "<design {}: reach_height {:.4g}, robot_torque {:.4g}>".format(
        best.number, *reversed(values)
    )
    bad = next(each for each in run.designs if not each.feasible)
    assert repr(bad) == f"<design {bad.number}: not feasible, violation {bad.violation:.4g}>"
    assert repr(Design(None, lost(RUN[0]).assessment)) == "<design: worker lost>"
    many = msgspec.structs.replace(best.assessment, objectives=dict.fromkeys("abcde", 1.0))
    assert repr(Design(3, many)) == "<design 3: a 1, b 1, c 1, ..>"


def test_designs_carry_what_the_log_holds_of_them(run: Run) -> None:
    for design, evaluation in zip(run.designs, RUN, strict=True):
        assert design.assessment == evaluation.assessment
        assert design.parameters == evaluation.assessment.design
        assert design.objectives == evaluation.assessment.objectives
        assert (design.status, design.reason) == (evaluation.assessment.status, evaluation.assessment.reason)
        assert (design.violation, design.feasible) == (evaluation.assessment.violation, evaluation.feasible)
        assert (design.reach, design.cases) == (evaluation.assessment.reach, evaluation.assessment.cases)


def test_postures_come_from_the_log(run: Run) -> None:
    for each in FRONT:
        assert run.postures(each.number) == toy_detail(each).cases


def test_run_shows_itself_and_its_problem(run: Run) -> None:
    assert f"30 evaluations, {len(FRONT)} on the front" in repr(run)
    assert (run.parameters, run.objectives, run.notes) == (HEADER.parameters, HEADER.objectives, ())


def test_wrong_wishes_are_refused_in_one_sentence(run: Run, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"number: wanted a design of .* which has 30, found 99"):
        run.design(99)
    with pytest.raises(InputError, match="one of knee, near and different"):
        run.choose(knee=True, different=True)
    with pytest.raises(InputError, match="where: wanted one of"):
        run.choose(where="reach > 1")
    with pytest.raises(InputError, match="aspiration: wanted objectives among"):
        run.choose(near={"reach": 1.0})
    with pytest.raises(RunError, match="there is no such run directory"):
        evodesign.open_run(tmp_path / "none")


def test_empty_run_has_an_empty_table(tmp_path: Path) -> None:
    RunWriter(tmp_path, msgspec.structs.replace(HEADER, budget=1)).close()
    empty = evodesign.open_run(tmp_path)
    assert empty.front == ()
    assert pd.DataFrame(empty.table()).empty


KINDS = {"number": "int64", "generation": "int64", "feasible": "bool", "status": "str", "height": "float64"}
TEXTS = {"human", "payload", "task", "status", "reason"}


def dtypes_are_right(frame: pd.DataFrame) -> None:
    for name, dtype in frame.dtypes.items():
        if name in TEXTS:
            assert pd.api.types.is_string_dtype(dtype), name
        else:
            assert str(dtype) == KINDS.get(str(name), "float64"), name


def written(directory: Path, evaluations: list[Evaluation]) -> Run:
    with RunWriter(directory, HEADER) as writer:
        for evaluation in evaluations:
            writer.write(evaluation)
    return evodesign.open_run(directory)


@pytest.mark.parametrize("kind", ["of all kinds", "all infeasible", "one that failed", "empty", "damaged"])
def test_frames_have_numbers_where_numbers_belong(tmp_path: Path, kind: str) -> None:
    """Also where none exists: a column of nothing is one of numbers, not of objects."""
    evaluations = {
        "of all kinds": [*RUN[:20], lost(RUN[20])],
        "all infeasible": [each for each in RUN if not each.feasible],
        "one that failed": [lost(RUN[0])],
        "empty": [],
        "damaged": RUN,
    }[kind]
    run = written(tmp_path / "run", evaluations)
    if kind == "damaged":
        (segment,) = (tmp_path / "run").glob("*.mcap")
        segment.write_bytes(segment.read_bytes()[: segment.stat().st_size // 3])
        run = evodesign.open_run(tmp_path / "run")
        assert run.notes
        assert 0 < len(run) < len(RUN)
    else:
        assert len(run) == len(evaluations)
    for columns in (run.table(), run.cases(), run.table(()), run.cases(())):
        dtypes_are_right(pd.DataFrame(columns))
    table = pd.DataFrame(run.table())
    missing = [math.nan if each.violation is None else each.violation for each in run.designs]
    assert table["violation"].equals(pd.Series(missing, dtype="float64"))
    assert table["robot_torque"].notna().tolist() == [
        "robot_torque" in each.objectives for each in run.designs
    ]


def test_designs_of_another_run_are_refused(run: Run, tmp_path: Path) -> None:
    short = written(tmp_path / "short", RUN[:3])
    for ask in (short.table, short.cases):
        with pytest.raises(InputError, match=r"wanted designs of .*short, found 29"):
            ask(run.designs[29:])
        with pytest.raises(InputError, match="found one that was evaluated outside of it"):
            ask([Design(None, RUN[0].assessment)])
