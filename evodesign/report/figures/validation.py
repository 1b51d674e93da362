"""People who were measured beside predicted ones: stick figures from the side, and L5/S1 over height."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from evodesign.human.measured_posture import HumanPosture
from evodesign.report.figures.paint import INK, clean, key_below, new_figure, write_figure
from evodesign.validation.compare import POSTURES, ComparedCase
from evodesign.validation.measured import EMPTY, HANGING, HOLDING
from evodesign.validation.posed import CHAIN, Places

COLORS = {HumanPosture.MEASURED: "#c0504d", HumanPosture.LEAST_TORQUE: "#8fa9c4"}
LABELS = {HumanPosture.MEASURED: "predicted", HumanPosture.LEAST_TORQUE: "least torque"}
STATICS = "#5a9367"


def write_validation_figures(compared: Sequence[ComparedCase], directory: Path) -> list[Path]:
    """Write both figures to an existing directory.

    Raises:
        InputError: a file cannot be written.
    """
    figures = {"postures_side": stick_figures(compared), "l5s1_moment": moment_figure(compared)}
    return [path for stem, figure in figures.items() for path in write_figure(figure, directory, stem)]


def stick_figures(compared: Sequence[ComparedCase]) -> Figure:
    """A row for each lift, a panel for each range of height in which the load is held."""
    held = [each for each in compared if each.case.hands == HOLDING]
    lifts = [*dict.fromkeys(each.case.lift for each in held)]
    ranges = sorted({(each.case.bin, each.case.range) for each in held})
    rows, columns = max(len(lifts), 1), max(len(ranges), 1)
    title = "Postures measured and predicted, with the wrists at a height [m]"
    figure = new_figure(max(1.9 * columns, 5.0), 2.5 * rows + 0.9, title)
    axes = figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=True)
    for lift, of_row in zip(lifts, axes, strict=False):
        for (number, heights), panel in zip(ranges, of_row, strict=True):
            own = [e for e in held if (e.case.lift, e.case.bin) == (lift, number)]
            for each in own:
                _sticks(panel, each)
            panel.set_title(heights, fontsize=9, color=INK)
        of_row[0].set_ylabel(lift, color=INK, parse_math=False)
    for panel in axes.flat:
        clean(panel)
        panel.set(aspect="equal", xlim=(-0.75, 0.95), ylim=(-0.05, 1.95))
    _legend(figure, axes[0][0], ("measured", INK), *((LABELS[kind], COLORS[kind]) for kind in POSTURES))
    return figure


def _sticks(panel: Axes, each: ComparedCase) -> None:
    """Of one case; where the legs were not measured, predictions are moved until the hips coincide."""
    for kind in reversed(POSTURES):
        posed = each.predicted.get(kind)
        if posed is not None:
            off = 0.0 if each.case.has_legs else each.ours.places["hip"][0] - posed.places["hip"][0]
            _stick(panel, posed.places, COLORS[kind], off)
    _stick(panel, each.ours.places, INK, 0.0)


def _stick(panel: Axes, places: Places, color: str, off: float) -> None:
    points = [(places[name][0] + off, places[name][1]) for name in CHAIN if name in places]
    panel.plot(*zip(*points, strict=True), color=color, linewidth=1.3, alpha=0.8, solid_joinstyle="round")
    panel.plot(*points[-1], marker="s", color=color, markersize=3.5, alpha=0.8)


def moment_figure(compared: Sequence[ComparedCase]) -> Figure:
    """A panel for each lift: moments over the height of the palms; hollow marks are of empty hands."""
    lifts = [*dict.fromkeys(each.case.lift for each in compared)]
    figure = new_figure(4.6 * max(len(lifts), 1), 4.2, "Moment at L5/S1 by height of the palms")
    axes = figure.subplots(1, max(len(lifts), 1), squeeze=False, sharex=True, sharey=True)[0]
    for lift, panel in zip(lifts, axes, strict=False):
        own = [each for each in compared if each.case.lift == lift and each.case.hands != HANGING]
        for each in own:
            hollow = each.case.hands == EMPTY
            if "l5s1" in each.moments:
                _mark(panel, "o", INK, hollow, each.moments["l5s1"], each.palms)
            _mark(panel, "x", STATICS, False, each.ours.moments["l5s1"], each.palms)
            for kind in POSTURES:
                posed = each.predicted.get(kind)
                if posed is not None:
                    _mark(panel, "D", COLORS[kind], hollow, posed.moments["l5s1"], each.palms)
        clean(panel)
        panel.set_title(lift, fontsize=10, color=INK, parse_math=False)
        panel.set_xlabel("moment at L5/S1 [N m]", color=INK)
    axes[0].set_ylabel("height of the palms [m]", color=INK)
    words = (LABELS[kind] for kind in POSTURES)
    colors = (COLORS[kind] for kind in POSTURES)
    _legend(figure, axes[0], ("measured", INK), ("statics", STATICS), *zip(words, colors, strict=True))
    return figure


def _mark(panel: Axes, marker: str, color: str, hollow: bool, moment: float, height: float) -> None:
    face = "none" if hollow else color
    panel.plot(moment, height, marker=marker, color=color, markerfacecolor=face, markersize=5, alpha=0.85)


def _legend(figure: Figure, axes: Axes, *entries: tuple[str, str]) -> None:
    lines = [axes.plot([], [], color=color, linewidth=2.2, label=label)[0] for label, color in entries]
    key_below(figure, lines)
