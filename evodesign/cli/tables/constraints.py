"""Constraints of a problem and what a design makes of them, as tables."""

from __future__ import annotations

from collections.abc import Sequence

from evodesign.cli.tables.table import FittedTable, names, numbers, titled
from evodesign.records import Assessment, Constraint
from evodesign.violations import bounds_text, violations


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
