"""Joint torques as box plots by height of the load, and as one row of marks per joint.

Box plots: one panel per height, one box per robot or person. A box spans the quartiles of all joint torques
of a posture, its line is the median, its diamond the mean, its whiskers reach the farthest torque within 1.5
times the box; every joint is a dot beside its box.

Rows: one mark per height. Where a problem has several people or loads, a height has a mark for each of them.

Source: Sartore et al. 2022, box plots of joint torques by load height.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from evodesign.report.figures.paint import INK, clean, color_of, key_below, new_figure
from evodesign.tree.words import in_words

BOX, CLOUD = 0.36, 0.30
"""Width of a box, and distance of its dots."""

MARKS = ("o", "s", "^", "D", "v", "P", "X")
TorquesAt = tuple[float, Mapping[str, float]]
"""A height [m] and torques [N m] by joint."""

ROW = 0.21
"""Height of a joint's row [inches]."""


def torque_boxes(series: Mapping[str, Mapping[float, Sequence[float]]], title: str) -> Figure:
    """A figure of box plots.

    Args:
        series: joint torques [N m] by series (such as `robot` and `human`, or two robots) and height [m]; a
            series without a height leaves its place there empty.
        title: over the figure.
    """
    heights = sorted({height for by_height in series.values() for height in by_height})
    names = list(series)
    panels = max(len(heights), 1)
    figure = new_figure(max(1.0 + panels * (0.7 + 0.85 * len(names)), 5.0), 3.8, title)
    axes = figure.subplots(1, panels, sharey=True, squeeze=False)[0]
    for panel, height in zip(axes, heights, strict=False):
        _box_panel(panel, {name: series[name].get(height, ()) for name in names})
        panel.set_title(f"load at {height:g} m", fontsize=10, color=INK)
    if not heights:
        axes[0].set_axis_off()
        axes[0].text(0.5, 0.5, "no posture", ha="center", color=INK, transform=axes[0].transAxes)
        return figure
    axes[0].set_ylabel("joint torque [N m]", color=INK)
    return figure


def _box_panel(axes: Axes, torques: Mapping[str, Sequence[float]]) -> None:
    clean(axes)
    axes.grid(visible=False, axis="x")
    axes.axhline(0.0, color="#8a9097", linewidth=0.8, zorder=1)
    for position, (name, values) in enumerate(torques.items()):
        if values:
            _box(axes, position, values, color_of(name, position))
    axes.set_xticks(range(len(torques)), list(torques), parse_math=False)
    axes.set_xlim(-0.5, len(torques) - 0.5)


def _box(axes: Axes, position: int, values: Sequence[float], color: str) -> None:
    axes.boxplot(
        [list(values)],
        positions=[position - 0.1],
        widths=BOX,
        showfliers=False,
        showmeans=True,
        patch_artist=True,
        manage_ticks=False,
        boxprops={"facecolor": color, "alpha": 0.35, "edgecolor": color, "linewidth": 1.0},
        medianprops={"color": INK, "linewidth": 1.4},
        whiskerprops={"color": color},
        capprops={"color": color},
        meanprops={"marker": "D", "markerfacecolor": "white", "markeredgecolor": INK, "markersize": 5},
        zorder=2,
    )
    beside = [position - 0.1 + CLOUD] * len(values)
    axes.scatter(beside, list(values), s=9, color=color, alpha=0.75, linewidths=0, zorder=3)


def joint_torques(series: Mapping[str, Sequence[TorquesAt]], title: str) -> Figure:
    """A figure of joint torques, one panel per series.

    Args:
        series: height [m] and torques [N m] by joint of each case, by series (such as `robot` and `human`).
        title: over the figure.
    """
    heights = sorted({height for cases in series.values() for height, _ in cases})
    rows = {
        name: list(dict.fromkeys(joint for _, torques in cases for joint in torques))
        for name, cases in series.items()
    }
    tallest = max((len(joints) for joints in rows.values()), default=0)
    figure = new_figure(max(5.2 * len(series), 5.2), 1.3 + ROW * max(tallest, 8), title)
    axes = figure.subplots(1, max(len(series), 1), squeeze=False)[0]
    for panel, (name, cases) in zip(axes, series.items(), strict=False):
        _row_panel(panel, cases, heights, rows[name])
        panel.set_title(name, fontsize=10, color=INK, parse_math=False)
    if heights:
        key_below(figure, axes[0].get_legend_handles_labels()[0])
    return figure


def _row_panel(
    axes: Axes, cases: Sequence[TorquesAt], heights: Sequence[float], joints: Sequence[str]
) -> None:
    clean(axes)
    axes.axvline(0.0, color="#8a9097", linewidth=0.8, zorder=1)
    shades = mpl.colormaps["viridis"]
    for index, height in enumerate(heights):
        found = [torques for at, torques in cases if at == height]
        shown = [
            (torques[joint], row) for torques in found for row, joint in enumerate(joints) if joint in torques
        ]
        axes.scatter(
            [torque for torque, _ in shown],
            [row for _, row in shown],
            s=24,
            color=shades(0.85 * index / max(len(heights) - 1, 1)),
            marker=MARKS[index % len(MARKS)],
            alpha=0.9,
            linewidths=0,
            label=f"load at {height:g} m",
            zorder=3,
        )
    axes.set_yticks(range(len(joints)), [in_words(joint) for joint in joints], parse_math=False)
    axes.tick_params(axis="y", labelsize=8)
    axes.set_ylim(len(joints) - 0.4, -0.6)
    axes.set_xlabel("joint torque [N m]", color=INK, fontsize=9)
