"""The front of a run as one HTML page that needs no network."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape

import numpy as np
import plotly.graph_objects as go

from evodesign.analysis.front import front
from evodesign.errors import InputError
from evodesign.records import Evaluation, Objective, RunHeader, Sense
from evodesign.report.comparison_figure import axis_title
from evodesign.report.subset import subsample

MOST_POINTS = 10_000
"""Dominated evaluations beyond this number are thinned out evenly, and the figure says so."""


def front_html(header: RunHeader, evaluations: Sequence[Evaluation]) -> str:
    """A page with the front: two objectives as axes, a third as colour.

    The two objectives that differ most among the front's designs become the axes, which begin zoomed on the
    front.

    Args:
        header: of the run.
        evaluations: all of the run.
    Raises:
        InputError: the run has one objective or more than three, or no feasible design.
    """
    if not 2 <= len(header.objectives) <= 3:
        found = f"{len(header.objectives)} in {header.problem_name}"
        raise InputError("--plot", "", "a run with two or three objectives", found)
    best = front(header.objectives, evaluations)
    if not best:
        raise InputError("--plot", "", "a run with a feasible design", "none")
    objectives = sorted(header.objectives, key=lambda objective: -_spread(objective, best))
    numbers = {evaluation.number for evaluation in best}
    others = [e for e in evaluations if e.feasible and e.number not in numbers]
    shown = subsample(others, MOST_POINTS)
    note = "" if len(shown) == len(others) else f" ({len(shown)} of {len(others)} shown)"
    figure = go.Figure()
    figure.add_trace(_points(objectives, shown, f"dominated{note}", {"size": 5, "color": "#c0c4c9"}))
    figure.add_trace(_points(objectives, best, "front", _front_marker(objectives, best)))
    first = [e for e in evaluations[:1] if e.feasible and header.search.start]
    for evaluation in first:
        star = {"size": 16, "symbol": "star", "color": "#c0392b", "line": {"width": 1, "color": "#333333"}}
        figure.add_trace(_points(objectives, [evaluation], "first design of the run", star))
    name = escape(header.problem_name, quote=False)
    figure.update_layout(
        template="plotly_white",
        title=f"{name}: {len(best)} of {len(evaluations)} designs are on the front",
        xaxis={"title": axis_title(objectives[0]), "range": _range(objectives[0], best, first)},
        yaxis={"title": axis_title(objectives[1]), "range": _range(objectives[1], best, first)},
        legend={"orientation": "h", "y": 1.12, "x": 1.0, "xanchor": "right"},
        font={"size": 15},
    )
    page: str = figure.to_html(include_plotlyjs=True, full_html=True, div_id="front")
    return page


def _spread(objective: Objective, evaluations: Sequence[Evaluation]) -> float:
    """Interquartile range over the median's size: how much the designs differ in an objective."""
    low, middle, high = np.quantile(_values(objective, evaluations), [0.25, 0.5, 0.75])
    return float((high - low) / abs(middle)) if middle else float(high - low)


def _range(
    objective: Objective, best: Sequence[Evaluation], marked: Sequence[Evaluation] = ()
) -> list[float]:
    """An axis from the front's best value to its worst but 5 %, with the marked designs, 5 % wider."""
    ends = [0.0, 0.95] if objective.sense is Sense.MINIMISE else [0.05, 1.0]
    low, high = np.quantile(_values(objective, best), ends)
    low, high = min([low, *_values(objective, marked)]), max([high, *_values(objective, marked)])
    margin = 0.05 * (high - low) or 1.0
    return [float(low - margin), float(high + margin)]


def _values(objective: Objective, evaluations: Sequence[Evaluation]) -> list[float]:
    return [evaluation.assessment.objectives[objective.name] for evaluation in evaluations]


def _front_marker(objectives: Sequence[Objective], best: Sequence[Evaluation]) -> dict[str, object]:
    marker: dict[str, object] = {"size": 11, "color": "#1f4e79"}
    if len(objectives) == 3:
        low, high = _range(objectives[2], best)
        marker.update(
            color=_values(objectives[2], best),
            colorscale="Viridis",
            cmin=low,
            cmax=high,
            colorbar={"title": {"text": axis_title(objectives[2]), "side": "right"}},
            line={"width": 1, "color": "#333333"},
        )
    return marker


def _points(
    objectives: Sequence[Objective],
    evaluations: Sequence[Evaluation],
    name: str,
    marker: Mapping[str, object],
) -> go.Scatter:
    return go.Scatter(
        x=_values(objectives[0], evaluations),
        y=_values(objectives[1], evaluations),
        text=[_hover(objectives, e) for e in evaluations],
        hoverinfo="text",
        mode="markers",
        name=name,
        marker=marker,
    )


def _hover(objectives: Sequence[Objective], evaluation: Evaluation) -> str:
    values = evaluation.assessment.objectives
    lines = [f"design {evaluation.number}"]
    lines += [f"{axis_title(objective)}: {values[objective.name]:.4g}" for objective in objectives]
    lines += [
        f"{escape(name, quote=False)}: {value:.4g}" for name, value in evaluation.assessment.design.items()
    ]
    return "<br>".join(lines)
