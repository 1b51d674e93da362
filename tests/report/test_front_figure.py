"""The figure of a front shows every design of it, and names as they are written."""

from __future__ import annotations

import pytest

from evodesign.errors import InputError
from evodesign.records import (
    FORMAT_VERSION,
    Assessment,
    Evaluation,
    Objective,
    ProblemSource,
    RunHeader,
    SearchSettings,
    Sense,
    Status,
)
from evodesign.report.front_figure import front_html


def header(*names: str, title: str = "toy") -> RunHeader:
    return RunHeader(
        format_version=FORMAT_VERSION,
        problem=ProblemSource(path="toy.toml", text="", files={}),
        problem_name=title,
        parameters=(),
        objectives=tuple(Objective(name=name, sense=Sense.MINIMISE, unit="N m") for name in names),
        search=SearchSettings(
            algorithm="random", dimension=1, objectives=len(names), population=2, seed=1, start=((0.5,),)
        ),
        budget=10,
        versions={},
        git=None,
        started="",
    )


def evaluation(number: int, *values: float, violation: float = 0.0) -> Evaluation:
    return Evaluation(
        number=number,
        generation=0,
        genome=(0.5,),
        assessment=Assessment(
            design={"length.<b>arm</b>": 1.0},
            objectives=dict(zip(("first", "second", "third"), values, strict=False)),
            violation=violation,
            status=Status.SOLVED,
            reason="solved",
        ),
        seconds=0.1,
        worker="w",
    )


DESIGNS = (evaluation(0, 4.0, 4.0, 1.0), evaluation(1, 1.0, 3.0, 2.0), evaluation(2, 3.0, 1.0, 3.0))


@pytest.mark.parametrize("names", [("first", "second"), ("first", "second", "third")])
def test_page_holds_every_design_of_the_front(names: tuple[str, ...]) -> None:
    page = front_html(header(*names), DESIGNS)
    assert "design 1" in page
    assert "design 2" in page
    assert "first design of the run" in page
    assert "<script src=" not in page, "the page must work without a network"


def test_names_are_shown_as_text() -> None:
    page = front_html(header("first", "second", title="<script>alert(1)</script>"), DESIGNS)
    assert "<script>alert" not in page
    assert "<b>arm</b>" not in page


@pytest.mark.parametrize("names", [("first",), ("first", "second", "third", "fourth")])
def test_other_numbers_of_objectives_are_refused(names: tuple[str, ...]) -> None:
    with pytest.raises(InputError, match="two or three objectives"):
        front_html(header(*names), DESIGNS)


def test_run_without_feasible_design_is_refused() -> None:
    with pytest.raises(InputError, match="a feasible design"):
        front_html(header("first", "second"), (evaluation(0, 1.0, 2.0, violation=0.1),))
