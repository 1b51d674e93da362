"""The front of a run as one HTML page that needs no network."""

from __future__ import annotations

from collections.abc import Sequence

import plotly.graph_objects as go

from evodesign.analysis.front import front
from evodesign.errors import InputError
from evodesign.records import Evaluation, Objective, RunHeader

__all__ = ["front_html"]

MOST_POINTS = 10_000
"""Dominated evaluations beyond this number are thinned out evenly, and the figure says so."""


def front_html(header: RunHeader, evaluations: Sequence[Evaluation]) -> str:
    """A page with the front over the first two objectives, coloured by the third.

    Args:
        header: of the run.
        evaluations: all of the run.
    Raises:
        InputError: the run has one objective or more than three.
    """
    if not 2 <= len(header.objectives) <= 3:
        found = f"{len(header.objectives)} in {header.problem_name}"
        raise InputError("--plot", "", "a run with two or three objectives", found)
    best = front(header.objectives, evaluations)
    others = [e for e in evaluations if e.feasible and e not in best]
    shown = others[:: 1 + len(others) // MOST_POINTS]
    figure = go.Figure()
    note = "" if len(shown) == len(others) else f" (1 in {len(others) // len(shown)} shown)"
    figure.add_trace(_points(header.objectives, shown, f"dominated{note}", on_front=False))
    figure.add_trace(_points(header.objectives, best, "front", on_front=True))
    if header.search.start and evaluations and evaluations[0].feasible:
        figure.add_trace(_marked(header.objectives, evaluations[0]))
    first, second = (_label(objective) for objective in header.objectives[:2])
    figure.update_layout(
        template="plotly_white",
        title=f"{_safe(header.problem_name)}: {len(best)} designs on the front of {len(evaluations)}",
        xaxis_title=first,
        yaxis_title=second,
        legend={"orientation": "h", "y": 1.06, "x": 1.0, "xanchor": "right"},
        font={"size": 15},
    )
    page: str = figure.to_html(include_plotlyjs=True, full_html=True)
    return page


def _points(
    objectives: Sequence[Objective], evaluations: Sequence[Evaluation], name: str, *, on_front: bool
) -> go.Scatter:
    marker: dict[str, object] = {"size": 11 if on_front else 5, "color": "#1f4e79" if on_front else "#c0c4c9"}
    if on_front and len(objectives) == 3:
        marker.update(
            color=[e.assessment.objectives[objectives[2].name] for e in evaluations],
            colorscale="Viridis",
            colorbar={"title": {"text": _label(objectives[2]), "side": "right"}},
            line={"width": 1, "color": "#333333"},
        )
    return go.Scatter(
        x=[e.assessment.objectives[objectives[0].name] for e in evaluations],
        y=[e.assessment.objectives[objectives[1].name] for e in evaluations],
        text=[_hover(objectives, e) for e in evaluations],
        hoverinfo="text",
        mode="markers",
        name=name,
        marker=marker,
    )


def _marked(objectives: Sequence[Objective], evaluation: Evaluation) -> go.Scatter:
    return go.Scatter(
        x=[evaluation.assessment.objectives[objectives[0].name]],
        y=[evaluation.assessment.objectives[objectives[1].name]],
        text=[_hover(objectives, evaluation)],
        hoverinfo="text",
        mode="markers",
        name="first design of the run",
        marker={"size": 16, "symbol": "star", "color": "#c0392b", "line": {"width": 1, "color": "#333333"}},
    )


def _label(objective: Objective) -> str:
    return f"{_safe(objective.name.replace('_', ' '))} [{objective.unit}]"


def _hover(objectives: Sequence[Objective], evaluation: Evaluation) -> str:
    values = evaluation.assessment.objectives
    lines = [f"design {evaluation.number}"]
    lines += [f"{_label(objective)}: {values[objective.name]:.4g}" for objective in objectives]
    lines += [f"{_safe(name)}: {value:.4g}" for name, value in evaluation.assessment.design.items()]
    return "<br>".join(lines)


def _safe(text: str) -> str:
    """Text that a browser shows as it stands."""
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
