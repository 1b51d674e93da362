"""One design as tables for people: what came of it, its hardware, and the limits that hold its postures."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import msgspec

from evodesign.cli.output import heading, interval, printable, rounded
from evodesign.cli.tables.cases import case_tables
from evodesign.cli.tables.people import effort_table, people_table
from evodesign.cli.tables.table import FittedTable, names, numbers, titled
from evodesign.evaluation.bill import bill_of_materials
from evodesign.evaluation.evaluate import detail_of
from evodesign.evaluation.sensitivities import ObjectiveSensitivity
from evodesign.problem.build import DesignProblem
from evodesign.quantities.design_result import DesignResult
from evodesign.quantities.ergonomics import ergonomics
from evodesign.records import Assessment, CaseDetail, Constraint
from evodesign.violations import bounds_text, violations

STRONGEST = 4
"""Parameters shown per objective."""


def design_tables(
    problem: DesignProblem,
    name: str,
    result: DesignResult,
    assessment: Assessment,
    sensitivities: Mapping[str, ObjectiveSensitivity],
    solved: Sequence[CaseDetail],
) -> Iterator[FittedTable]:
    """One design: its results, what they ask of the people, and what would change them.

    Args:
        problem: whose design it is.
        name: of the design.
        result: of its evaluation.
        assessment: the same in short.
        sensitivities: of its objectives and constrained quantities.
        solved: the postures of its solved cases, with the limits that hold them.
    """
    yield from _assessment_tables(problem, name, result, assessment)
    if bill := bill_of_materials(problem, result.tree, solved):
        yield actuators_table(bill)
    if solved and result.scenes[0].people:
        yield from _people_tables(result)
    if any(each.limits for each in solved):
        yield limits_table(solved)
    if sensitivities:
        yield _sensitivity_table(problem, sensitivities)


def _assessment_tables(
    problem: DesignProblem, name: str, result: DesignResult, assessment: Assessment
) -> Iterator[FittedTable]:
    """Its objectives, constraints and postures case by case, with a summary where there are many cases."""
    summary = titled(f"{problem.name}: {name}", [*names("objective"), *numbers("value")])
    for objective in problem.objectives:
        value = assessment.objectives.get(objective.name)
        summary.add_row(heading(objective), value)
    summary.add_row(violation_heading(problem.constraints), assessment.violation)
    reach = result.reach
    summary.add_row("reach [m]", interval(reach.lowest, reach.highest, or_lower=reach.or_lower))
    yield summary
    if problem.constraints:
        yield constraints_table(problem.constraints, ("value", assessment))
    yield from case_tables(assessment)


def _people_tables(result: DesignResult) -> tuple[FittedTable, FittedTable]:
    """What the solved postures of a design ask of the people."""
    solved = [solution for solution in result.cases if solution.solved]
    asked = [
        (
            msgspec.structs.replace(one.case, person=person.label),
            ergonomics(person, detail_of(one).hardest.agents[person.name]),
        )
        for one in solved
        for person in result.scene_of(one.case).people
    ]
    return people_table(asked), effort_table(asked)


def _sensitivity_table(
    problem: DesignProblem, sensitivities: Mapping[str, ObjectiveSensitivity]
) -> FittedTable:
    """The parameters that move each objective or constraint most, for equal shares of their ranges."""
    ranges = {parameter.name: parameter.upper - parameter.lower for parameter in problem.space.free}
    columns = names("objective" if not problem.constraints else "quantity", "strongest parameters")
    table = titled("what 1 % more of a parameter's range changes", columns)
    shown_names = {objective.name: heading(objective) for objective in problem.objectives}
    for constraint in problem.constraints:
        shown_names.setdefault(constraint.name, f"{constraint.name} [{constraint.unit}]")
    for quantity, title in shown_names.items():
        found = sensitivities.get(quantity)
        if found is None:
            continue
        if found.gradient is None:
            shown = next((kink for kink in found.notes if "no gradient" in kink), "no gradient")
        else:
            moves = {name: value * ranges[name] * 0.01 for name, value in found.gradient.items()}
            strongest = sorted(moves, key=lambda name: -abs(moves[name]))[:STRONGEST]
            shown = ", ".join(f"{name} {moves[name]:+.2g}" for name in strongest if moves[name])
        table.add_row(title, shown or "nothing moves it")
    return table


def clearance_in_words(bill: Mapping[str, Any]) -> str:
    """Which parts of a bill have least room; empty where no actuator is a body."""
    if (least := bill.get("least_clearance")) is None:
        return ""
    one, other = least["parts"]
    fit = "" if least["clearance_m"] >= 0.0 else " too little"
    return f"{one} and {other} have least room: {abs(1e3 * least['clearance_m']):.2g} mm{fit}"


def actuators_table(bill: Mapping[str, Any]) -> FittedTable:
    """The masses of a bill of materials, and its actuators, each with the joint that is used most.

    Below it stands what governs walls and actuators, and which parts have least room.
    """
    columns = [
        *names("actuator"),
        *numbers("joints", "rated [N m]", "peak [N m]", "kg each", "used"),
        *names("most by", "joint"),
    ]
    masses = ", ".join(
        f"{part} {rounded(bill['mass_kg'][part])}" for part in ("actuators", "structure", "rest")
    )
    caption = "\n".join(printable(each) for each in (clearance_in_words(bill), *bill["governs"]) if each)
    table = titled(f"hardware ({rounded(bill['mass_kg']['total'])} kg: {masses})", columns, caption=caption)
    groups: dict[str, dict[str, Mapping[str, Any]]] = {}
    for joint, row in bill["joints"].items():
        groups.setdefault(row["actuator"], {})[joint] = row
    for group, rows in groups.items():
        worst = max(rows, key=lambda joint: rows[joint]["share"])
        row = rows[worst]
        model = f" ({row['model']})" if row["model"] else ""
        table.add_row(
            group + model,
            f"{len(rows)}",
            row["rated_torque_n_m"],
            row["peak_torque_n_m"],
            row["mass_kg"],
            f"{row['share']:.0%}",
            row["asked_by"],
            worst,
        )
    return table


def constraints_table(constraints: Sequence[Constraint], *columns: tuple[str, Assessment]) -> FittedTable:
    """Each constraint with its bounds, and its value in some designs and by how much the last violates it.

    Args:
        constraints: of the problem.
        columns: a heading for the value in each design, and the design.
    """
    headings = numbers(*(heading for heading, _ in columns))
    table = titled("constraints", [*names("constraint", "bounds"), *headings, *numbers("violation")])
    found = violations(constraints, columns[-1][1])
    for constraint in constraints:
        values = [assessment.constrained.get(constraint.name) for _, assessment in columns]
        name = f"{constraint.name} [{constraint.unit}]"
        table.add_row(name, bounds_text(constraint), *values, found[constraint.name])
    return table


def violation_heading(constraints: Sequence[Constraint]) -> str:
    """What the row of a design's violation is called: missed metres, to which constraints add no metres."""
    return "violation" if constraints else "violation [m]"


TITLE = "limits that are active, and by how many N m each step more changes the effort"

MOST_COLUMNS = 6
"""Cases that have a column each."""

CAPTION = (
    "effort: root of the least weighted sum of squared torques (docs/model.md)\n"
    "negative: a larger value saves; of a pair of joints, the price of both"
)


def limits_table(cases: Sequence[CaseDetail]) -> FittedTable:
    """A row for each limit that is active in some of the cases, those of the largest price first."""
    known = {limit.identity: limit for case in cases for limit in case.limits}
    prices = [{limit.identity: limit.change_n_m for limit in case.limits} for case in cases]
    changes = {identity: [of_case.get(identity) for of_case in prices] for identity in known}
    few = len(cases) <= MOST_COLUMNS
    measured = (
        numbers(*(case.case.name for case in cases)) if few else numbers("active in", "mean", "largest")
    )
    table = titled(TITLE, [*names("agent", "limit", "step"), *measured], keys=3, caption=CAPTION)
    for agent in dict.fromkeys(limit.agent for limit in known.values()):
        own = [identity for identity in known if identity[0] == agent]
        own.sort(key=lambda identity: -max(abs(change or 0.0) for change in changes[identity]))
        for identity in own:
            limit, found = known[identity], changes[identity]
            cells = [_text(change) for change in found] if few else _summary(found)
            table.add_row(agent or "both", limit.words, limit.step[1], *cells)
        table.add_section()
    return table


def _summary(changes: Sequence[float | None]) -> list[str]:
    """In how many cases, and the mean and largest change of these."""
    found = [change for change in changes if change is not None]
    mean = sum(found) / len(found)
    return [f"{len(found)} of {len(changes)}", _text(mean), _text(max(found, key=abs))]


def _text(change: float | None) -> str:
    return "-" if change is None else f"{change:+.2g}"
