"""Colours and type of the printed figures, and writing them as SVG and PNG.

Figures are built without pyplot: no global state, no window. Names come from users' files, so nothing is read
as formula markup (`parse_math=False`).
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from textwrap import wrap
from typing import Final

import matplotlib as mpl
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from evodesign.errors import InputError
from evodesign.files import replacing

INK: Final = "#24292f"
PALE: Final = "#d8dce1"
GROUND_FORCE: Final = "#e07b00"
"""Orange, as the ground wrenches in the paper's figures."""
HAND_FORCE: Final = "#7b2d8b"

AGENTS: Final[Mapping[str, str]] = {"robot": "#3b6ea5", "human": "#c98b63", "load": "#8d7355"}
SEQUENCE: Final = ("#3b6ea5", "#c0504d", "#5a9367", "#8064a2", "#b08d28", "#4b9cb8")
"""Colours that stay apart in print and for colour-blind eyes, for what has no colour of its own."""

DOTS_PER_INCH: Final = 160

LETTERS_PER_INCH: Final = 10
"""Of a title that stays within its figure."""


def color_of(name: str, position: int) -> str:
    """An agent's colour, or the colour of a position in a series."""
    return AGENTS.get(name, SEQUENCE[position % len(SEQUENCE)])


def new_figure(width: float, height: float, title: str) -> Figure:
    """An empty figure of a size [inches] with its title, whose parts make room for each other."""
    figure = Figure(figsize=(width, height), layout="constrained", facecolor="white")
    lines = wrap(title, int(width * LETTERS_PER_INCH), break_on_hyphens=False)
    figure.suptitle("\n".join(lines), color=INK, fontsize=12, parse_math=False)
    return figure


def key_below(figure: Figure, entries: Sequence[Artist]) -> None:
    """Name entries by their labels below what a figure shows, in as many columns as it has room for."""
    for columns in range(max(len(entries), 1), 0, -1):
        legend = figure.legend(
            handles=entries, ncols=columns, loc="outside lower center", frameon=False, fontsize=9
        )
        if columns == 1 or legend.get_window_extent().width <= figure.bbox.width:
            break
        legend.remove()


def clean(axes: Axes) -> None:
    """Axes without a box: a pale grid behind the data, two spines."""
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    for side in ("left", "bottom"):
        axes.spines[side].set_color("#8a9097")
    axes.grid(visible=True, color=PALE, linewidth=0.6)
    axes.set_axisbelow(True)
    axes.tick_params(colors=INK, labelsize=9, length=3)


def write_figure(figure: Figure, directory: Path, stem: str) -> tuple[Path, Path]:
    """Write a figure as STEM.svg and STEM.png; equal figures give equal files.

    Args:
        figure: what to write.
        directory: an existing one.
        stem: of the files, made of letters and underscores.
    Raises:
        InputError: a file cannot be written.
    """
    svg, png = directory / f"{stem}.svg", directory / f"{stem}.png"
    try:
        with mpl.rc_context({"svg.fonttype": "none", "svg.hashsalt": "evodesign"}), warnings.catch_warnings():
            warnings.filterwarnings(
                "ignore", message="Glyph", category=UserWarning
            )  # a name in other letters
            with replacing(svg) as file:
                figure.savefig(file, format="svg", dpi=DOTS_PER_INCH, metadata={"Date": None})
            with replacing(png) as file:
                figure.savefig(file, format="png", dpi=DOTS_PER_INCH)
    except OSError as error:
        wanted = "a directory that can be written"
        raise InputError(str(directory), "", wanted, f"{error.strerror}") from error
    return svg, png
