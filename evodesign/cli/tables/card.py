"""One design of a run as a card for people: what it is worth, what it is made of, how it stands."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from rich.console import Group
from rich.text import Text

from evodesign.analysis.people_spread import PeopleSpread
from evodesign.cli.output import heading, interval
from evodesign.cli.tables.cases import case_tables
from evodesign.cli.tables.design import actuators_table, constraints_table, limits_table, violation_heading
from evodesign.cli.tables.people import effort_table, people_table
from evodesign.cli.tables.spread import quantities_table
from evodesign.cli.tables.table import FittedTable, names, numbers, titled
from evodesign.cli.tables.worst_cases import moment_tables
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
    header, assessment, spread = opened.run.header, opened.evaluation.assessment, opened.spread()
    tables = [_objectives(opened)]
    if header.constrained:
        tables.append(constraints_table(header.constrained, ("value", assessment)))
    if spread is not None:
        tables.append(_people(opened, spread))
    tables.append(_parameters(opened))
    if made_of := materials_of(header.parameters, assessment.design):
        tables.append(titled("materials", names("parameter", "material"), made_of.items()))
    if bill:
        tables.append(actuators_table(bill))
    tables += case_tables(assessment, f" (reach: {_reach(assessment)})")
    if moments := [moment for detail in opened.cases for moment in detail.few_moments]:
        tables += moment_tables(moments)
    if any(detail.limits for detail in opened.cases):
        tables.append(limits_table(opened.cases))
    if asked:
        cases = [*zip((detail.case for detail in opened.cases), asked, strict=True)]
        tables += [people_table(cases), effort_table(cases)]
    return Group(_title(opened), *(part for table in tables for part in (Text(), table)))


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
    table = titled("objectives", [*names("objective"), *numbers("value", "best of the run")])
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


def _people(opened: OpenedDesign, spread: PeopleSpread) -> FittedTable:
    """How its results spread over samples of people, and on how many fronts it is."""
    header, assessment, number = opened.run.header, opened.evaluation.assessment, opened.evaluation.number
    own, samples = spread.designs[number], spread.samples
    means = {**assessment.objectives, **assessment.constrained}
    reference = f"design {spread.reference}"
    table = quantities_table(spread, number, header.objectives, header.constrained, means, reference)
    lost = "" if own.feasible == own.samples else f", feasible in {own.feasible}"
    on_front = f"on the front in {own.on_front} of {samples}{lost}"
    table.title = f"beside {own.samples} samples of people: {on_front}"
    return table


def _parameters(opened: OpenedDesign) -> FittedTable:
    within = names("within its bounds", "upper")
    columns = [*names("parameter"), *numbers("value"), *names("unit"), *numbers("lower"), *within]
    table = titled("parameters", columns)
    for parameter in opened.run.header.parameters:
        value = opened.evaluation.assessment.design[parameter.name]
        unit = "" if parameter.unit == "1" else parameter.unit
        bar = _bar(parameter, value)
        ends = (f"{parameter.lower:g}", f"{parameter.upper:g}")
        table.add_row(parameter.name, value, unit, ends[0], bar, ends[1])
    return table


def _bar(parameter: Parameter, value: float) -> str:
    share = parameter.share_of(value)
    place = round(min(max(share, 0.0), 1.0) * (BAR - 1))
    return "─" * place + "●" + "─" * (BAR - 1 - place)
