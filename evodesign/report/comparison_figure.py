"""Several runs side by side as one HTML page that needs no network."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from html import escape

import numpy as np
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from evodesign.analysis.comparison import Attainment, Compared, Comparison
from evodesign.analysis.seed_statistics import AttainmentSurface
from evodesign.records import Objective, Sense

COLOURS = ("#1f4e79", "#d1661c", "#2e8b57", "#8e4a9e", "#b22d3b", "#6b7280", "#b8860b", "#0f8b8d")
"""One per search; from the ninth on they come again, with other dashes."""

DASHES = ("solid", "dash", "dot")

COLUMNS, ROW_HEIGHT, HEADROOM = 2, 400, 130
"""Of the figure; sizes in pixels."""

MOST_PAIRS = 4
"""Pairs of objectives that are drawn; there are more from four objectives on, and the page says so."""


def comparison_html(comparisons: Sequence[Comparison]) -> str:
    """A page with a figure per comparison: hypervolumes on the way and at the end, attainment surfaces."""
    figures = []
    for number, comparison in enumerate(comparisons):
        figure = _figure(comparison)
        figures.append(
            figure.to_html(include_plotlyjs=number == 0, full_html=False, div_id=f"figure{number}")
        )
    body = "\n".join(figures)
    return (
        '<!doctype html>\n<html lang="en">\n'
        '<head><meta charset="utf-8"><title>evodesign compare</title></head>\n'
        f'<body style="margin: 0; background: white">\n{body}\n</body></html>\n'
    )


def _figure(comparison: Comparison) -> go.Figure:
    pairs = list(dict.fromkeys(each.objectives for each in comparison.attainments))
    shown = pairs[:MOST_PAIRS]
    rows = 1 + -(-len(shown) // COLUMNS)
    figure = make_subplots(
        rows=rows,
        cols=COLUMNS,
        vertical_spacing=0.28 / rows,
        subplot_titles=[
            "Hypervolume so far (thick: median)",
            f"Hypervolume after {comparison.evaluations} evaluations",
            *("Attained by half of the runs (thick), one, all (thin)" for _ in shown),
        ],
    )
    looks = ({"color": colour, "dash": dash} for dash, colour in itertools.product(DASHES, COLOURS))
    styles = dict(zip(comparison.searches, itertools.cycle(looks), strict=False))
    for name, members in comparison.searches.items():
        _add_curves(figure, name, members, styles[name])
        _add_ends(figure, name, members, styles[name])
    for place, pair in enumerate(shown):
        row, column = 2 + place // COLUMNS, 1 + place % COLUMNS
        for attainment in comparison.attainments:
            if attainment.objectives == pair:
                _add_surfaces(figure, (row, column), attainment, styles[attainment.search])
        figure.update_xaxes(title_text=axis_title(pair[0]), row=row, col=column)
        figure.update_yaxes(title_text=axis_title(pair[1]), row=row, col=column)
    figure.update_xaxes(title_text="evaluations", row=1, col=1)
    left_out = f" ({len(pairs) - len(shown)} of {len(pairs)} pairs of objectives left out)"
    figure.update_layout(
        template="plotly_white",
        title={
            "text": f"{len(comparison.runs)} runs{left_out if len(shown) < len(pairs) else ''}",
            "yref": "container",
            "y": 0.99,
            "yanchor": "top",
        },
        height=HEADROOM + ROW_HEIGHT * rows,
        margin={"t": HEADROOM, "b": 70},
        font={"size": 14},
        legend={"orientation": "h", "x": 0.0, "y": 1.0 + 50 / (ROW_HEIGHT * rows), "yanchor": "bottom"},
    )
    return figure


def _add_curves(figure: go.Figure, name: str, members: Sequence[Compared], style: Mapping[str, str]) -> None:
    """A thin line per run, and a thick one for the median where all of the search's runs still go."""
    curves = [each.curve for each in members if each.curve is not None and each.curve.evaluations]
    for line in curves:
        figure.add_trace(
            go.Scatter(
                x=line.evaluations,
                y=line.hypervolume,
                mode="lines",
                line={**style, "width": 1},
                opacity=0.45,
                legendgroup=name,
                showlegend=False,
                hoverinfo="skip",
            ),
            row=1,
            col=1,
        )
    if not curves:
        return
    end = min(line.evaluations[-1] for line in curves)
    places = [place for place in curves[0].evaluations if place < end] + [end]
    heights = [np.interp(places, line.evaluations, line.hypervolume) for line in curves]
    figure.add_trace(
        go.Scatter(
            x=places,
            y=np.median(heights, axis=0).tolist(),
            mode="lines",
            line={**style, "width": 3},
            name=f"{escape(name, quote=False)}, median of {len(curves)}",
            legendgroup=name,
        ),
        row=1,
        col=1,
    )


def _add_ends(figure: go.Figure, name: str, members: Sequence[Compared], style: Mapping[str, str]) -> None:
    counted = [each for each in members if each.hypervolume is not None]
    figure.add_trace(
        go.Box(
            y=[each.hypervolume for each in counted],
            text=[escape(f"{each.run.directory}", quote=False) for each in counted],
            name=escape(name, quote=False),
            boxpoints="all",
            pointpos=0.0,
            jitter=0.3,
            marker={"color": style["color"], "size": 8},
            legendgroup=name,
            showlegend=False,
        ),
        row=1,
        col=2,
    )


def _add_surfaces(
    figure: go.Figure, place: tuple[int, int], attainment: Attainment, style: Mapping[str, str]
) -> None:
    """Staircases: the middle one thick, those of one run and of all runs thin."""
    surfaces = attainment.surfaces
    for number, surface in enumerate(surfaces):
        middle = number == len(surfaces) // 2
        xs, ys = _staircase(attainment.objectives, surface)
        share = f"attained by {surface.share:.0%} of the runs"
        figure.add_trace(
            go.Scatter(
                x=xs,
                y=ys,
                mode="lines",
                line={**style, "width": 3 if middle else 1},
                opacity=1.0 if middle else 0.6,
                name=f"{escape(attainment.search, quote=False)}: {share}",
                legendgroup=attainment.search,
                showlegend=False,
            ),
            row=place[0],
            col=place[1],
        )


def _staircase(
    pair: tuple[Objective, Objective], surface: AttainmentSurface
) -> tuple[list[float], list[float]]:
    """The border of what the corners attain: from corner to corner by way of the worse of both values."""
    worse_first = max if pair[0].sense is Sense.MINIMISE else min
    worse_second = max if pair[1].sense is Sense.MINIMISE else min
    xs, ys = [surface.corners[0][0]], [surface.corners[0][1]]
    for (x, y), (next_x, next_y) in zip(surface.corners, surface.corners[1:], strict=False):
        xs += [worse_first(x, next_x), next_x]
        ys += [worse_second(y, next_y), next_y]
    return xs, ys


def axis_title(objective: Objective) -> str:
    """Its name and unit as HTML shows them."""
    return f"{escape(objective.name.replace('_', ' '), quote=False)} [{objective.unit}]"
