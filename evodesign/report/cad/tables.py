"""The bill of materials on the sheet of a drawing: a table of links and one of motors."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from matplotlib.axes import Axes
from matplotlib.textpath import TextPath

from evodesign.errors import on_one_line
from evodesign.report.cad.listing import LinkRow, MotorRow
from evodesign.report.figures.paint import INK

LINK_COLUMNS: Final = (
    *(("", 6.0), ("link", 43.0), ("each", 8.0), ("outside [mm]", 30.0), ("wall", 9.0)),
    *(("material", 29.0), ("to joint", 14.0), ("mass [kg]", 0.0)),
)
"""Headings with the widths of their columns [mm]; the last takes what is left."""

MOTOR_COLUMNS: Final = (
    *(("", 8.0), ("motor of joint", 54.0), ("each", 8.0), ("model", 24.0), ("rated, peak [N m]", 22.0)),
    *(("housing [mm]", 24.0), ("mass [kg]", 0.0)),
)

SMALL, LEAST = 5.5, 3.0
"""Letters [pt] of a table with room, and of one with many rows."""

MOST_LINE, TITLE_BLOCK = 4.0, 40.0
"""Height of a row where there is room; what stays free at the bottom of the sheet [mm]."""


FILLED = 0.95
"""Share of a column's width that text takes at most, as programs differ in how wide they draw a font."""


def draw_tables(
    axes: Axes, links: Sequence[LinkRow], motors: Sequence[MotorRow], left: float, right: float, top: float
) -> None:
    """Both tables in a column of the sheet, with rows as high as there is room for.

    Args:
        axes: in millimetres of the sheet.
        links: of one table.
        motors: of the other; none, and there is no other.
        left: end of the column [mm].
        right: its other end [mm].
        top: its upper end [mm].
    """
    count = len(links) + len(motors) + (4 if motors else 2)
    line = min(MOST_LINE, (top - TITLE_BLOCK) / count)
    size = max(LEAST, min(SMALL, SMALL * line / 3.2))
    rows = [_link_cells(row) for row in links]
    y = _table(axes, LINK_COLUMNS, rows, (left, right, top - 1.0), line, size)
    if motors:
        cells = [_motor_cells(row) for row in motors]
        _table(axes, MOTOR_COLUMNS, cells, (left, right, y - line), line, size)


def _link_cells(row: LinkRow) -> tuple[str, ...]:
    length = "-" if row.length is None else f"{row.length:g}"
    return (
        *(str(row.item), ", ".join(row.names), f"{len(row.names)} x", row.section, row.wall, row.material),
        *(length, f"{row.mass:.3f}"),
    )


def _motor_cells(row: MotorRow) -> tuple[str, ...]:
    return (
        *(row.item, ", ".join(row.joints), f"{len(row.joints)} x", row.model),
        *(f"{row.rated:.4g}, {row.peak:.4g}", row.housing, f"{row.mass:.3f}"),
    )


def _table(
    axes: Axes,
    columns: Sequence[tuple[str, float]],
    rows: Sequence[Sequence[str]],
    place: tuple[float, float, float],
    line: float,
    size: float,
) -> float:
    """Draw a table downwards from a place (left, right, top), and say where it ends [mm]."""
    left, right, y = place
    starts = [left + 1.0]
    for _, width in columns[:-1]:
        starts.append(starts[-1] + width)
    widths = [end - start - 1.0 for start, end in zip(starts, [*starts[1:], right], strict=True)]
    heads = [head for head, _ in columns]
    for number, cells in enumerate((heads, *rows)):
        y -= line
        for x, width, cell in zip(starts, widths, cells, strict=True):
            text = _fitted(on_one_line(cell), width, size)
            axes.text(x, y + 0.3 * line, text, fontsize=size, color=INK, parse_math=False)
        weight = 0.6 if number == 0 else 0.15
        axes.plot([left, right], [y, y], color=INK, linewidth=weight)
    return y


def _fitted(text: str, width: float, size: float) -> str:
    """A text cut to a width [mm]."""
    while len(text) > 1 and _width(text, size) > FILLED * width:
        text = f"{text[:-2].rstrip('…')}…"
    return text


def _width(text: str, size: float) -> float:
    """Width of a text [mm] in letters of a size [pt]."""
    return TextPath((0.0, 0.0), text, size=size, usetex=False).get_extents().width * 25.4 / 72.0
