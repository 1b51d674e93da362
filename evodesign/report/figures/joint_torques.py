"""The torque of each joint: one row per joint, one mark per height of the load.

Where a problem has several people or loads, a height has a mark for each of them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from evodesign.report.figures.paint import INK, clean, new_figure

__all__ = ["joint_torques"]

MARKS = ("o", "s", "^", "D", "v", "P", "X")
TorquesAt = tuple[float, Mapping[str, float]]
"""A height [m] and torques [N m] by joint."""

ROW = 0.21
"""Height of a joint's row [inches]."""


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
        _panel(panel, cases, heights, rows[name])
        panel.set_title(name, fontsize=10, color=INK, parse_math=False)
    if heights:
        handles, labels = axes[0].get_legend_handles_labels()
        figure.legend(
            handles, labels, loc="outside lower center", ncols=len(labels), frameon=False, fontsize=9
        )
    return figure


def _panel(axes: Axes, cases: Sequence[TorquesAt], heights: Sequence[float], joints: Sequence[str]) -> None:
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
    axes.set_yticks(range(len(joints)), list(joints), parse_math=False)
    axes.tick_params(axis="y", labelsize=8)
    axes.set_ylim(len(joints) - 0.4, -0.6)
    axes.set_xlabel("joint torque [N m]", color=INK, fontsize=9)
