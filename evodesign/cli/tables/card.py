"""One design of a run as a card for people: what it is worth, what it is made of, how it stands."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from rich.console import Group, RenderableType
from rich.markup import escape
from rich.table import Table
from rich.text import Text

from evodesign.cli.output import figure, heading
from evodesign.cli.tables.cases import cases_table, heights_table, summary_table
from evodesign.cli.tables.people import TITLE, TITLE_OF_SEVERAL, people_table
from evodesign.cli.tables.worst_cases import JOINTS_SHOWN, worst_forces, worst_torques
from evodesign.errors import on_one_line
from evodesign.records import Assessment, CaseDetail, Parameter, materials_of
from evodesign.report.opened_design import OpenedDesign
from evodesign.report.subset import ranked_joints

if TYPE_CHECKING:
    from evodesign.problem.ergonomics import Ergonomics

__all__ = ["card"]

BAR = 16
"""Columns of a parameter's bar."""


def card(opened: OpenedDesign, asked: Sequence[Ergonomics]) -> Group:
    """The card.

    Args:
        opened: the design.
        asked: of the people by each of its postures; none to leave it out.
    """
    assessment = opened.evaluation.assessment
    several = any(outcome.case.label for outcome in assessment.cases)
    reach = f"reach: {_reach(assessment)}"
    sections: dict[str, Table] = {"objectives": _objectives(opened), "parameters": _parameters(opened)}
    if several:
        sections["torque norms |tau| over the cases [N m]"] = summary_table(assessment, "")
        sections[f"the load in each case, torques in N m ({reach})"] = cases_table(assessment, "")
    else:
        sections[f"the load at each height ({reach})"] = heights_table(assessment, "")
    if opened.cases and several:
        sections["largest joint torques [N m]"] = worst_torques(opened.cases)
        sections["contact forces [N]"] = worst_forces(opened.cases)
    elif opened.cases:
        sections["largest joint torques [N m]"] = _torques(opened.cases)
        sections["contact forces [N]"] = _contacts(opened.cases)
    if asked:
        cases = [*zip((detail.case for detail in opened.cases), asked, strict=True)]
        sections[TITLE_OF_SEVERAL if several else TITLE] = people_table(cases, titled=False)
    parts: list[RenderableType] = [_title(opened)]
    for title, table in sections.items():
        parts += [Text(f"\n{title}", style="italic"), table]
    return Group(*parts)


def _reach(assessment: Assessment) -> str:
    reach = assessment.reach
    return f"{figure(reach.lowest_m)} to {figure(reach.highest_m)} m" if reach else "unknown"


def _title(opened: OpenedDesign) -> Text:
    evaluation = opened.evaluation
    standing = "on the front" if opened.on_front else "not on the front"
    outcome = f"feasible, {standing}" if evaluation.feasible else "not feasible"
    title = Text()
    title.append(f"{on_one_line(opened.run.header.problem_name)}: design {evaluation.number}", style="bold")
    title.append(f"\ngeneration {evaluation.generation}, {outcome}")
    if not evaluation.feasible:
        title.append(f": {on_one_line(evaluation.assessment.reason)}")
    return title


def _objectives(opened: OpenedDesign) -> Table:
    table = _table("objective")
    table.add_column("value", justify="right")
    table.add_column("best of the run", justify="right")
    assessment = opened.evaluation.assessment
    for objective in opened.run.header.objectives:
        best = max if objective.sense == "maximise" else min
        found = [e.assessment.objectives.get(objective.name) for e in opened.run.evaluations if e.feasible]
        values = [value for value in found if value is not None]
        own = assessment.objectives.get(objective.name)
        table.add_row(
            escape(on_one_line(heading(objective))), figure(own), figure(best(values, default=None))
        )
    table.add_row(escape("violation [m]"), figure(assessment.violation), "")
    return table


def _parameters(opened: OpenedDesign) -> Table:
    table = _table("parameter")
    for column in ("value", "unit", "lower", "within its bounds", "upper"):
        table.add_column(column, justify="right" if column in ("value", "lower") else "left")
    made_of = materials_of(opened.run.header.parameters, opened.evaluation.assessment.design)
    if made_of:
        table.add_column("material", overflow="fold")
    for parameter in opened.run.header.parameters:
        value = opened.evaluation.assessment.design[parameter.name]
        unit = "" if parameter.unit == "1" else parameter.unit
        bar = _bar(parameter, value)
        ends = (f"{parameter.lower:g}", f"{parameter.upper:g}")
        table.add_row(
            escape(on_one_line(parameter.name)),
            figure(value),
            escape(on_one_line(unit)),
            ends[0],
            bar,
            ends[1],
            *([escape(on_one_line(made_of.get(parameter.name, "")))] if made_of else []),
        )
    return table


def _bar(parameter: Parameter, value: float) -> str:
    share = (value - parameter.lower) / (parameter.upper - parameter.lower)
    place = round(min(max(share, 0.0), 1.0) * (BAR - 1))
    return "─" * place + "●" + "─" * (BAR - 1 - place)


def _torques(cases: Sequence[CaseDetail]) -> Table:
    table = _height_table(("agent", "joint"), cases)
    for agent in cases[0].agents:
        by_height = [detail.agents[agent].torques_n_m for detail in cases]
        shown = ranked_joints(by_height)[:JOINTS_SHOWN]
        for joint in shown:
            row = [figure(torques.get(joint)) for torques in by_height]
            table.add_row(agent, escape(on_one_line(joint)), *row, end_section=joint == shown[-1])
    return table


def _contacts(cases: Sequence[CaseDetail]) -> Table:
    table = _height_table(("agent", "contact"), cases)
    for agent in cases[0].agents:
        rows = list(_forces(cases, agent))
        for position, (contact, forces) in enumerate(rows):
            last = position == len(rows) - 1
            table.add_row(agent, escape(contact), *map(figure, forces), end_section=last)
    return table


def _forces(cases: Sequence[CaseDetail], agent: str) -> Iterator[tuple[str, list[float]]]:
    """Size of the force on each hand and foot, by height."""
    postures = [detail.agents[agent] for detail in cases]
    for part, wrenches in (
        ("hand", [posture.hand_wrenches for posture in postures]),
        ("foot", [posture.foot_wrenches for posture in postures]),
    ):
        for side in wrenches[0]:
            yield f"{side} {part}", [math.hypot(*wrench[side][:3]) for wrench in wrenches]


def _height_table(columns: Sequence[str], cases: Sequence[CaseDetail]) -> Table:
    table = _table(*columns)
    for detail in cases:
        table.add_column(str(detail.case.task), justify="right")
    return table


def _table(*columns: str) -> Table:
    """A table whose first columns hold names."""
    table = Table()
    for column in columns:
        table.add_column(column, overflow="fold")
    return table
