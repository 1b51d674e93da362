"""Tables that cut nothing off: names to the left, numbers to the right."""

from __future__ import annotations

from collections.abc import Iterable

from rich.markup import escape
from rich.table import Column, Table

from evodesign.cli.output import figure, heading, shown
from evodesign.records import Evaluation, RunHeader
from evodesign.violations import bounds_text

__all__ = ["designs_table", "names", "numbers", "titled"]


def titled(title: str, columns: Iterable[Column]) -> Table:
    """A table with columns, under a title unless that is empty; it is shown as it stands."""
    return Table(*columns, title=escape(title) or None, title_justify="left")


def names(*headers: str) -> list[Column]:
    """Columns of text."""
    return [Column(shown(header), overflow="fold") for header in headers]


def numbers(*headers: str) -> list[Column]:
    """Columns of numbers."""
    return [Column(shown(header), overflow="fold", justify="right") for header in headers]


def designs_table(title: str, header: RunHeader, designs: Iterable[Evaluation]) -> Table:
    """Designs with their objectives and the other constrained quantities, in the given order."""
    objectives, others = header.objectives, header.constrained_alone
    headings = [f"{each.name} [{each.unit}], {bounds_text(each)}" for each in others]
    table = titled(title, numbers("design", *map(heading, objectives), *headings))
    for each in designs:
        values, constrained = each.assessment.objectives, each.assessment.constrained
        table.add_row(
            str(each.number),
            *(figure(values[objective.name]) for objective in objectives),
            *(figure(constrained.get(constraint.name)) for constraint in others),
        )
    return table
