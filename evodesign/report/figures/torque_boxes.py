"""Joint torques as box plots, one panel per height of the load, one box per robot or person.

A box spans the quartiles of all joint torques of a posture, its line is the median, its diamond the mean, its
whiskers reach the farthest torque within 1.5 times the box; every joint is a dot beside its box.

Source: Sartore et al. 2022, box plots of joint torques by load height.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from evodesign.report.figures.paint import INK, clean, color_of, new_figure

__all__ = ["torque_boxes"]

BOX, CLOUD = 0.36, 0.30
"""Width of a box, and distance of its dots."""


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
        _panel(panel, {name: series[name].get(height, ()) for name in names})
        panel.set_title(f"load at {height:g} m", fontsize=10, color=INK)
    if not heights:
        axes[0].set_axis_off()
        axes[0].text(0.5, 0.5, "no posture", ha="center", color=INK, transform=axes[0].transAxes)
        return figure
    axes[0].set_ylabel("joint torque [N m]", color=INK)
    return figure


def _panel(axes: Axes, torques: Mapping[str, Sequence[float]]) -> None:
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
