"""Tables that cut nothing off and break no word: names to the left, numbers to the right.

Where a table is too wide for the terminal, headers get a second line for the unit, text wraps at spaces, and
columns that still find no room follow below, beside the first ones once more.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field

from rich.cells import cell_len
from rich.console import Console, ConsoleOptions, RenderableType
from rich.table import Table
from rich.text import Text

from evodesign.cli.output import heading, printable, rounded
from evodesign.records import Evaluation, RunHeader
from evodesign.violations import bounds_text

COMFORTABLE = 9
"""Cells to which a column of text is narrowed at most, unless a word is longer."""

EDGE, PER_COLUMN = 1, 3
"""Cells of a table's left edge, and of a column's padding with the line to its right."""


Cell = str | float | None
"""A text, a count, a number that is rounded, or none, which is a dash."""


@dataclass(frozen=True, slots=True)
class TableColumn:
    """A column of a table.

    Args:
        header: as text; a unit in brackets at its end may stand in a line of its own.
        of_numbers: aligned to the right, and never wrapped.
    """

    header: str
    of_numbers: bool

    def lines(self, stacked: bool) -> list[str]:
        """The header's lines, of which all but the first stay whole."""
        return self.header.replace(" [", "\n[", 1).split("\n") if stacked else [self.header]

    def most(self, cells: Iterable[str], stacked: bool) -> int:
        """Width with which nothing wraps."""
        return max(map(cell_len, [*self.lines(stacked), *cells]))

    def least(self, cells: Sequence[str]) -> int:
        """Width with which no word breaks, and text stays readable."""
        first, *units = self.lines(stacked=True)
        whole = [*first.split(), *units]
        if self.of_numbers:
            return max(map(cell_len, [*whole, *cells]), default=0)
        words = [word for cell in cells for word in cell.split()]
        comfortable = min(COMFORTABLE, max(map(cell_len, cells), default=0))
        return max(comfortable, *map(cell_len, [*whole, *words, ""]))


@dataclass(slots=True)
class FittedTable:
    """A table that is laid out for the width of the console that prints it.

    Args:
        title: a line above, as text; empty for none.
        columns: from left to right.
        keys: how many columns at the left tell rows apart.
        caption: lines below, as text.
    """

    title: str
    columns: Sequence[TableColumn]
    keys: int = 1
    caption: str = ""
    _rows: list[tuple[list[Text], bool]] = field(default_factory=list)

    def add_row(self, *cells: Cell, end_section: bool = False) -> None:
        """A row of texts, shown as they stand, and numbers; a line follows where a section ends."""
        self._rows.append(([_shown(cell) for cell in cells], end_section))

    def add_section(self) -> None:
        """A line after the last row."""
        if self._rows:
            self._rows[-1] = (self._rows[-1][0], True)

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> Iterator[RenderableType]:
        """The title, one table or several, the caption; in place of a table without rows the word none."""
        if self.title:
            yield Text(self.title, style="table.title")
        if not self._rows:
            yield Text("none")
            return
        room = options.max_width - EDGE
        natural = self._widest(range(len(self.columns)), stacked=False)
        if sum(natural) <= room:
            yield self._part(range(len(self.columns)), natural, stacked=False)
        else:
            for places in self._groups(room):
                yield self._part(places, self._fitted(places, room), stacked=True)
        if self.caption:
            yield Text(self.caption, style="table.caption")

    def _cells(self, place: int) -> list[str]:
        return [cells[place].plain for cells, _ in self._rows]

    def _widest(self, places: Iterable[int], *, stacked: bool) -> list[int]:
        return [self.columns[place].most(self._cells(place), stacked) + PER_COLUMN for place in places]

    def _narrowest(self, places: Iterable[int]) -> list[int]:
        return [self.columns[place].least(self._cells(place)) + PER_COLUMN for place in places]

    def _groups(self, room: int) -> Iterator[list[int]]:
        """Columns that find room side by side, each time with the keys."""
        keys = list(range(self.keys))
        group = [*keys]
        for place in range(self.keys, len(self.columns)):
            if len(group) > len(keys) and sum(self._narrowest([*group, place])) > room:
                yield group
                group = [*keys]
            group.append(place)
        yield group

    def _fitted(self, places: Sequence[int], room: int) -> list[int]:
        """Widths that add up to the room at most: the widest columns of text are narrowed first."""
        widths, least = self._widest(places, stacked=True), self._narrowest(places)
        while sum(widths) > room:
            wide = [i for i in range(len(widths)) if widths[i] > least[i]]
            if not wide:  # a word is longer than there is room: nothing is left but to break it
                wide, least = [i for i in range(len(widths)) if widths[i] > PER_COLUMN + 1], [0] * len(widths)
            widths[max(wide, key=lambda i: widths[i])] -= 1
        return widths

    def _part(self, places: Sequence[int], widths: Sequence[int], *, stacked: bool) -> Table:
        table = Table()
        for place, width in zip(places, widths, strict=True):
            column = self.columns[place]
            table.add_column(
                Text("\n".join(column.lines(stacked))),
                justify="right" if column.of_numbers else "left",
                overflow="fold",
                width=width - PER_COLUMN,
            )
        for cells, end_section in self._rows:
            table.add_row(*(cells[place] for place in places), end_section=end_section)
        return table


def _shown(cell: Cell) -> Text:
    if isinstance(cell, str):
        return Text(printable(cell))
    return Text(str(cell) if isinstance(cell, int) else rounded(cell))


def titled(
    title: str,
    columns: Sequence[TableColumn],
    rows: Iterable[Sequence[Cell]] = (),
    *,
    keys: int = 1,
    caption: str = "",
) -> FittedTable:
    """A table under a title, unless that is empty; both title and caption are shown as they stand."""
    table = FittedTable(title, columns, keys, caption)
    for row in rows:
        table.add_row(*row)
    return table


def names(*headers: str) -> list[TableColumn]:
    """Columns of text."""
    return [TableColumn(printable(header), of_numbers=False) for header in headers]


def numbers(*headers: str) -> list[TableColumn]:
    """Columns of numbers."""
    return [TableColumn(printable(header), of_numbers=True) for header in headers]


def designs_table(title: str, header: RunHeader, designs: Iterable[Evaluation]) -> FittedTable:
    """Designs with their objectives and the other constrained quantities, in the given order."""
    objectives, others = header.objectives, header.constrained_alone
    headings = [f"{each.name} [{each.unit}], {bounds_text(each)}" for each in others]
    table = titled(title, numbers("design", *map(heading, objectives), *headings))
    for each in designs:
        values, constrained = each.assessment.objectives, each.assessment.constrained
        table.add_row(
            each.number,
            *(values[objective.name] for objective in objectives),
            *(constrained.get(constraint.name) for constraint in others),
        )
    return table
