"""One design of a run as a card for people: what it is worth, what it is made of, how it stands."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from rich.console import Group, RenderableType
from rich.text import Text

from evodesign.analysis.people_spread import PeopleSpread
from evodesign.cli.output import heading, interval
from evodesign.cli.tables.bill import actuators_table, mass_title
from evodesign.cli.tables.cases import cases_table, summary_table
from evodesign.cli.tables.constraints import constraints_table, violation_heading
from evodesign.cli.tables.effort import TITLE as TITLE_OF_EFFORT
from evodesign.cli.tables.effort import TITLE_OF_SEVERAL as TITLE_OF_SEVERAL_EFFORTS
from evodesign.cli.tables.effort import effort_table
from evodesign.cli.tables.limits import TITLE as TITLE_OF_LIMITS
from evodesign.cli.tables.limits import limits_table
from evodesign.cli.tables.people import TITLE, TITLE_OF_SEVERAL, people_table
from evodesign.cli.tables.spread import quantities_table
from evodesign.cli.tables.table import FittedTable, names, numbers, titled
from evodesign.cli.tables.worst_cases import forces_by_height, torques_by_height, worst_forces, worst_torques
from evodesign.errors import on_one_line
from evodesign.records import Assessment, Parameter, materials_of
from evodesign.report.opened_design import OpenedDesign
from evodesign.violations import reason_of_infeasibility

if TYPE_CHECKING:
    from evodesign.quantities.ergonomics import Ergonomics

BAR = 16
"""Columns of a parameter's bar."""


def card(opened: OpenedDesign, asked: Sequence[Ergonomics], bill: Mapping[str, Any]) -> Group:
    """The card.

    Args:
        opened: the design.
        asked: of the people by each of its postures; none to leave it out.
        bill: of materials; empty to leave it out.
    """
    assessment = opened.evaluation.assessment
    spread = opened.spread()
    several = any(outcome.case.label for outcome in assessment.cases)
    reach = f"reach: {_reach(assessment)}"
    made_of = materials_of(opened.run.header.parameters, assessment.design)
    sections = {"objectives": _objectives(opened)}
    if constraints := opened.run.header.constrained:
        sections["constraints"] = constraints_table(constraints, "", ("value", assessment))
    if spread is not None:
        title, table = _people(opened, spread)
        sections[title] = table
    sections["parameters"] = _parameters(opened)
    if made_of:
        sections["materials"] = _materials(made_of)
    if bill:
        sections[mass_title(bill)] = actuators_table(bill)
    if several:
        sections["torque norms |tau| over the cases [N m]"] = summary_table(assessment, "")
        sections[f"the load in each case, torques in N m ({reach})"] = cases_table(assessment, "")
    else:
        sections[f"the load at each height ({reach})"] = cases_table(assessment, "")
    moments = [moment for detail in opened.cases for moment in detail.few_moments]
    if moments and several:
        sections["largest joint torques [N m]"] = worst_torques(moments)
        sections["contact forces [N]"] = worst_forces(moments)
    elif moments:
        sections["largest joint torques [N m]"] = torques_by_height(moments)
        sections["contact forces [N]"] = forces_by_height(moments)
    if any(detail.limits for detail in opened.cases):
        sections[TITLE_OF_LIMITS] = limits_table(opened.cases, "")
    if asked:
        cases = [*zip((detail.case for detail in opened.cases), asked, strict=True)]
        sections[TITLE_OF_SEVERAL if several else TITLE] = people_table(cases, titled=False)
        sections[TITLE_OF_SEVERAL_EFFORTS if several else TITLE_OF_EFFORT] = effort_table(
            cases, titled_too=False
        )
    parts: list[RenderableType] = [_title(opened)]
    for title, table in sections.items():
        parts += [Text(f"\n{title}", style="italic"), table]
    return Group(*parts)


def _reach(assessment: Assessment) -> str:
    reach = assessment.reach
    if reach is None:
        return "unknown"
    return f"{interval(reach.lowest_m, reach.highest_m, or_lower=reach.or_lower)} m"


def _title(opened: OpenedDesign) -> Text:
    evaluation = opened.evaluation
    standing = "on the front" if opened.on_front else "not on the front"
    outcome = f"feasible, {standing}" if evaluation.feasible else "not feasible"
    title = Text()
    title.append(f"{on_one_line(opened.run.header.problem_name)}: design {evaluation.number}", style="bold")
    title.append(f"\ngeneration {evaluation.generation}, {outcome}")
    if not evaluation.feasible:
        why = reason_of_infeasibility(opened.run.header.constrained, evaluation.assessment)
        title.append(f": {on_one_line(why)}")
    return title


def _objectives(opened: OpenedDesign) -> FittedTable:
    table = titled("", [*names("objective"), *numbers("value", "best of the run")])
    assessment = opened.evaluation.assessment
    for objective in opened.run.header.objectives:
        best = max if objective.sense == "maximise" else min
        found = [e.assessment.objectives.get(objective.name) for e in opened.run.evaluations if e.feasible]
        values = [value for value in found if value is not None]
        own = assessment.objectives.get(objective.name)
        table.add_row(heading(objective), own, best(values, default=None))
    label = violation_heading(opened.run.header.constrained)
    table.add_row(label, assessment.violation, "")
    return table


def _people(opened: OpenedDesign, spread: PeopleSpread) -> tuple[str, FittedTable]:
    """How its results spread over samples of people, and on how many fronts it is."""
    header, assessment, number = opened.run.header, opened.evaluation.assessment, opened.evaluation.number
    own, samples = spread.designs[number], spread.samples
    means = {**assessment.objectives, **assessment.constrained}
    reference = f"design {spread.reference}"
    table = quantities_table(spread, number, header.objectives, header.constrained, means, reference)
    lost = "" if own.feasible == own.samples else f", feasible in {own.feasible}"
    return f"beside {own.samples} samples of people: on the front in {own.on_front} of {samples}{lost}", table


def _parameters(opened: OpenedDesign) -> FittedTable:
    within = names("within its bounds", "upper")
    columns = [*names("parameter"), *numbers("value"), *names("unit"), *numbers("lower"), *within]
    table = titled("", columns)
    for parameter in opened.run.header.parameters:
        value = opened.evaluation.assessment.design[parameter.name]
        unit = "" if parameter.unit == "1" else parameter.unit
        bar = _bar(parameter, value)
        ends = (f"{parameter.lower:g}", f"{parameter.upper:g}")
        table.add_row(parameter.name, value, unit, ends[0], bar, ends[1])
    return table


def _materials(made_of: Mapping[str, str]) -> FittedTable:
    table = titled("", names("parameter", "material"))
    for parameter, material in made_of.items():
        table.add_row(parameter, material)
    return table


def _bar(parameter: Parameter, value: float) -> str:
    share = parameter.share_of(value)
    place = round(min(max(share, 0.0), 1.0) * (BAR - 1))
    return "─" * place + "●" + "─" * (BAR - 1 - place)
