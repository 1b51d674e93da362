"""One design as tables for people."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import msgspec

from evodesign.cli.output import heading, interval
from evodesign.cli.tables.bill import actuators_table
from evodesign.cli.tables.cases import case_tables
from evodesign.cli.tables.constraints import constraints_table, violation_heading
from evodesign.cli.tables.limits import limits_table
from evodesign.cli.tables.people import effort_table, people_table
from evodesign.cli.tables.table import FittedTable, names, numbers, titled
from evodesign.evaluation.bill import bill_of_materials
from evodesign.evaluation.evaluate import detail_of
from evodesign.evaluation.sensitivities import ObjectiveSensitivity
from evodesign.problem.build import DesignProblem
from evodesign.quantities.design_result import DesignResult
from evodesign.quantities.ergonomics import ergonomics
from evodesign.records import Assessment, CaseDetail

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
