"""The drawing of a robot on an A3 sheet: two views at joint angles of zero, dimensions, bill of materials.

Coordinates on the sheet are millimetres from its lower left corner. Nothing is placed by what a font needs:
columns of the tables are wide enough for a number of letters, and longer text is cut.
"""

from __future__ import annotations

import io
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Final

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from evodesign.errors import on_one_line
from evodesign.report.cad.listing import LinkRow, MotorRow, link_rows, motor_rows
from evodesign.report.cad.outlines import FRONT, SIDE, Array, Outline, View, link_outlines, motor_outlines
from evodesign.report.cad.parts import Parts
from evodesign.report.cad.tables import draw_tables
from evodesign.report.figures.paint import INK

WIDTH, HEIGHT, MARGIN = 420.0, 297.0, 10.0
"""Of A3 and of its border [mm]."""

TABLES_FROM = 252.0
"""Where the tables begin [mm from the left]; views are left of them."""

REDUCTIONS: Final = (1.0, 2.0, 5.0, 7.5, 10.0, 15.0, 20.0, 50.0, 100.0)
"""Scales 1 : n: those of ISO 5455, and two between them, as humanoids are just too tall for 1 : 5."""

LEVELS, BALLOONS, GAP, FOOT = 38.0, 15.0, 6.0, 22.0
"""Widths of the column of heights, of one of item numbers, between views; height under the views [mm]."""

SMALL: Final = 5.5
"""Letters of dimensions and tables [pt]: 2 mm high."""

LINE = 2.6
"""From a line of text to the next [mm]."""

MOTOR: Final = "#c05a00"
AXIS: Final = "#8a9097"


@dataclass(frozen=True, slots=True)
class Placed:
    """A view on the sheet.

    Args:
        view: its direction.
        outlines: of links, the farthest first.
        motors: outlines of motors.
        low, high: corners of everything [m], shape (2,).
        corner: of `low` on the sheet [mm].
        reduction: n of the scale 1 : n.
    """

    view: View
    outlines: Sequence[Outline]
    motors: Sequence[Outline]
    low: Array
    high: Array
    corner: tuple[float, float]
    reduction: float

    def on_sheet(self, seen: Array) -> Array:
        """Points of the view [m], shape (..., 2), on the sheet [mm]."""
        found: Array = np.array(self.corner) + 1000.0 * (seen - self.low) / self.reduction
        return found

    @property
    def size(self) -> Array:
        """Width and height on the sheet [mm]."""
        found: Array = 1000.0 * (self.high - self.low) / self.reduction
        return found


def drawing_svg(parts: Parts, title: str) -> bytes:
    """The drawing as SVG; equal robots and titles give equal files.

    Args:
        parts: of the robot.
        title: such as a problem's name and a design's number.
    """
    file = io.BytesIO()
    with mpl.rc_context({"svg.fonttype": "path", "svg.hashsalt": "evodesign"}):
        drawing(parts, title).savefig(file, format="svg", metadata={"Date": None})
    return file.getvalue()


def drawing(parts: Parts, title: str) -> Figure:
    """The drawing as a figure of A3 size."""
    figure = Figure(figsize=(WIDTH / 25.4, HEIGHT / 25.4), facecolor="white")
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set(xlim=(0.0, WIDTH), ylim=(0.0, HEIGHT))
    axes.set_axis_off()
    _box(axes, MARGIN, MARGIN, WIDTH - MARGIN, HEIGHT - MARGIN, 0.8)
    links, motors = link_rows(parts), motor_rows(parts)
    front, side = _views(parts)
    for placed in (front, side):
        _draw_view(axes, placed)
        _draw_axes(axes, placed, parts)
        _width(axes, placed)
    _heights(axes, front, parts)
    _height(axes, side)
    _balloons(axes, front, _link_items(front, links))
    _balloons(axes, side, _motor_items(side, motors), MOTOR)
    draw_tables(axes, links, motors, TABLES_FROM, WIDTH - MARGIN, HEIGHT - MARGIN)
    _title_block(axes, title, front.reduction, parts)
    return figure


def _views(parts: Parts) -> tuple[Placed, Placed]:
    """Front and side at the largest scale that fits, both on the same ground."""
    shown = [(view, link_outlines(parts, view), motor_outlines(parts, view)) for view in (FRONT, SIDE)]
    ends = []
    for _, outlines, motors in shown:
        corners = np.concatenate([each.corners for each in (*outlines, *motors)] or [np.zeros((1, 2))])
        ends.append((corners.min(axis=0), corners.max(axis=0)))
    wide = 1000.0 * sum(float(high[0] - low[0]) for low, high in ends)
    high = 1000.0 * float(ends[0][1][1] - ends[0][0][1])
    room = TABLES_FROM - MARGIN - LEVELS - 2.0 * BALLOONS - 2.0 * GAP
    tall = HEIGHT - 2.0 * MARGIN - FOOT - GAP
    fitting = (n for n in REDUCTIONS if wide <= n * room and high <= n * tall)
    reduction = next(fitting, REDUCTIONS[-1])
    y = MARGIN + FOOT + (tall - high / reduction) / 2.0
    x = MARGIN + LEVELS
    spare = (room - wide / reduction) / 3.0
    found = []
    for (view, outlines, motors), (low, top) in zip(shown, ends, strict=True):
        x += spare
        found.append(Placed(view, outlines, motors, low, top, (x, y), reduction))
        x += 1000.0 * float(top[0] - low[0]) / reduction + BALLOONS + GAP
    return found[0], found[1]


def _draw_view(axes: Axes, placed: Placed) -> None:
    for number, outline in enumerate(placed.outlines):
        x, y = placed.on_sheet(outline.corners).T
        axes.fill(x, y, facecolor="#f4f5f6", edgecolor=INK, linewidth=0.7, zorder=2.0 + 1e-3 * number)
    for outline in placed.motors:
        x, y = placed.on_sheet(outline.corners).T
        axes.fill(x, y, fill=False, edgecolor=MOTOR, linewidth=0.5, linestyle=(0, (3, 1.5)), zorder=4.0)
    x, y = placed.corner
    middle = x + placed.size[0] / 2.0
    _text(axes, middle, y - 17.0, f"{placed.view.title}, 1 : {placed.reduction:g}", 7.0, ha="center")


def _draw_axes(axes: Axes, placed: Placed, parts: Parts) -> None:
    """Axes of joints: a chain line, or a cross where one is seen end on."""
    for part in parts.axes:
        place = part.root_from_axis
        middle = np.array(place.translation, float)
        half = 0.035 * np.array([row[2] for row in place.rotation], float)
        ends = placed.on_sheet(placed.view.seen(np.array([middle - half, middle + half])))
        style: dict[str, Any] = {
            "color": MOTOR if part.joint.actuator else AXIS,
            "linewidth": 0.5,
            "zorder": 5.0,
        }
        if np.linalg.norm(ends[1] - ends[0]) > 2.0:
            axes.plot(*ends.T, linestyle=(0, (6, 1.5, 1, 1.5)), **style)
        else:
            axes.plot(*ends.mean(axis=0), marker="+", markersize=4.0, markeredgewidth=0.5, **style)


def _width(axes: Axes, placed: Placed) -> None:
    """The whole width of a view, under it."""
    (x, y), (wide, _) = placed.corner, placed.size
    _dimension(axes, (x, y - 7.0), (x + wide, y - 7.0))
    for end in (x, x + wide):
        axes.plot([end, end], [y - 1.0, y - 8.5], color=INK, linewidth=0.3)
    _text(axes, x + wide / 2.0, y - 6.2, f"{wide * placed.reduction:.0f}", SMALL, ha="center", va="bottom")


def _height(axes: Axes, placed: Placed) -> None:
    """The whole height, left of the side view."""
    (x, y), (_, tall) = placed.corner, placed.size
    _dimension(axes, (x - 5.0, y), (x - 5.0, y + tall))
    for end in (y, y + tall):
        axes.plot([x - 1.0, x - 6.5], [end, end], color=INK, linewidth=0.3)
    text = f"{tall * placed.reduction:.0f}"
    _text(axes, x - 5.6, y + tall / 2.0, text, SMALL, ha="right", va="center", rotation=90.0)


def _dimension(axes: Axes, start: tuple[float, float], end: tuple[float, float]) -> None:
    style = {"arrowstyle": "<|-|>,head_width=0.12,head_length=0.3", "color": INK, "linewidth": 0.4}
    axes.annotate("", start, end, arrowprops={**style, "shrinkA": 0.0, "shrinkB": 0.0})


def _heights(axes: Axes, placed: Placed, parts: Parts) -> None:
    """Heights of joints over the lowest point, one line per height, left of the front view."""
    levels: dict[int, list[str]] = {}
    for part in parts.axes:
        height = 1000.0 * (float(part.root_from_axis.translation[2]) - placed.low[1])
        levels.setdefault(round(height), []).append(part.joint.name)
    levels.setdefault(round(1000.0 * float(placed.high[1] - placed.low[1])), []).append("top")
    ordered = sorted(levels)
    wanted = [placed.corner[1] + level / placed.reduction for level in ordered]
    x = MARGIN + 3.0
    for level, at, y in zip(ordered, wanted, spread(wanted, LINE), strict=True):
        names = levels[level]
        more = f" +{len(names) - 1}" if len(names) > 1 else ""
        _text(axes, x, y, f"{level}  {cut(names[0], 17)}{more}", SMALL, va="center")
        line = ([x + 30.0, x + 33.0, placed.corner[0]], [y, at, at])
        axes.plot(*line, color=AXIS, linewidth=0.3, zorder=1.0)
    _text(axes, x, max(spread(wanted, LINE)[-1], wanted[-1]) + LINE + 0.9, "height of joints", SMALL)


def spread(wanted: Sequence[float], least: float) -> list[float]:
    """Places in the same order at least so far apart, each near where it is wanted.

    Runs that are too tight grow about the mean of what they want, and join their neighbours.

    Args:
        wanted: rising.
        least: distance of neighbours.
    """
    runs: list[list[float]] = []
    for place in wanted:
        runs.append([place])
        while len(runs) > 1 and _first(runs[-1], least) - _last(runs[-2], least) < least:
            runs[-2:] = [runs[-2] + runs[-1]]
    return [_first(run, least) + number * least for run in runs for number in range(len(run))]


def _first(run: Sequence[float], least: float) -> float:
    return float(np.mean(run)) - (len(run) - 1) * least / 2.0


def _last(run: Sequence[float], least: float) -> float:
    return float(np.mean(run)) + (len(run) - 1) * least / 2.0


def _link_items(placed: Placed, rows: Sequence[LinkRow]) -> Iterator[tuple[str, Array]]:
    """Numbers of links, each at the one of its row that is farthest to the right."""
    for row in rows:
        found = [outline for outline in placed.outlines if outline.name in row.names]
        if found:  # a flat mesh has none
            yield str(row.item), max(found, key=lambda outline: float(outline.middle[0])).middle


def _motor_items(placed: Placed, rows: Sequence[MotorRow]) -> Iterator[tuple[str, Array]]:
    for row in rows:
        yield row.item, next(each.middle for each in placed.motors if each.name == row.joints[0])


def _balloons(axes: Axes, placed: Placed, items: Iterator[tuple[str, Array]], color: str = INK) -> None:
    """Item numbers in a column right of a view, with lines to what they name."""
    pointed = sorted(((placed.on_sheet(at), item) for item, at in items), key=lambda each: float(each[0][1]))
    x = placed.corner[0] + placed.size[0] + 8.0
    least = min(1.25 * LINE, (HEIGHT - 3.0 * MARGIN) / max(1, len(pointed)))
    places = spread([float(at[1]) for at, _ in pointed], least)
    for (at, item), y in zip(pointed, places, strict=True):
        axes.plot([at[0], x - 3.0, x], [at[1], y, y], color=color, linewidth=0.3, zorder=6.0)
        axes.plot(*at, marker=".", markersize=1.5, color=color, zorder=6.0)
        _text(axes, x + 0.6, y, item, SMALL, va="center", color=color)


def _title_block(axes: Axes, title: str, reduction: float, parts: Parts) -> None:
    left, low, top = TABLES_FROM, MARGIN, MARGIN + 24.0
    _box(axes, left, low, WIDTH - MARGIN, top, 0.8)
    _text(axes, left + 2.0, top - 6.0, cut(on_one_line(title), 70), 9.0)
    mass = float(parts.tree.mass)
    lines = (
        f"{cut(on_one_line(parts.tree.name), 40)}, {mass:.2f} kg with motors; joint angles zero",
        f"lengths in mm, scale 1 : {reduction:g} on A3; outlines of the mass model's bodies, motors dashed",
        "walls as thick at the ends as at the sides; masses of links without motors; written by evodesign",
    )
    for number, line in enumerate(lines):
        _text(axes, left + 2.0, top - 11.5 - 4.0 * number, line, 6.0)


def _box(axes: Axes, left: float, low: float, right: float, top: float, line: float) -> None:
    axes.plot([left, right, right, left, left], [low, low, top, top, low], color=INK, linewidth=line)


def cut(text: str, letters: int) -> str:
    """A text of at most so many letters."""
    return text if len(text) <= letters else f"{text[: letters - 1]}…"


def _text(axes: Axes, x: float, y: float, text: str, size: float, **style: Any) -> None:
    axes.text(x, y, text, fontsize=size, parse_math=False, zorder=7.0, **{"color": INK, **style})
