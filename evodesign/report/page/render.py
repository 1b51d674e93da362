"""One file of a page: template, style, scripts, plotly and the content, with nothing left to fetch.

Whatever comes from the log stands in a JSON block, in which the signs that HTML could read as markup are
written as escapes; scripts put it into the page as text.
"""

from __future__ import annotations

from functools import cache
from importlib.resources import files

import msgspec
from plotly.offline import get_plotlyjs

from evodesign.report.page.content import Content

__all__ = ["page_html"]

TEMPLATE = files("evodesign.report.page").joinpath("template")

STYLES = ("palette.css", "layout.css", "parts.css")

SCRIPTS = (
    "numbers.js",
    "store.js",
    "theme.js",
    "front.js",
    "parallel.js",
    "progress.js",
    "failures.js",
    "table.js",
    "matrices.js",
    "kinematics.js",
    "meshes.js",
    "shaders.js",
    "viewer.js",
    "steering.js",
    "scene.js",
    "stage.js",
    "torques.js",
    "ingredients.js",
    "reach.js",
    "card.js",
    "head.js",
    "main.js",
)
"""In the order in which they stand in the page; all share one scope."""

ESCAPES = {"<": "\\u003c", ">": "\\u003e", "&": "\\u0026", "\u2028": "\\u2028", "\u2029": "\\u2029"}


def page_html(content: Content) -> str:
    """The page as one HTML document."""
    parts = {
        "{{style}}": "\n".join(_text(name) for name in STYLES),
        "{{plotly}}": get_plotlyjs(),
        "{{content}}": _json(content),
        "{{scripts}}": "\n".join(_text(name) for name in SCRIPTS),
    }
    page = _text("page.html")
    pieces = []
    for mark, part in parts.items():
        before, _, page = page.partition(mark)
        pieces += [before, part]
    return "".join([*pieces, page])


def _json(content: Content) -> str:
    """JSON that HTML reads as nothing but text."""
    text = msgspec.json.encode(content).decode()
    for sign, escape in ESCAPES.items():
        text = text.replace(sign, escape)
    return text


@cache
def _text(name: str) -> str:
    return TEMPLATE.joinpath(name).read_text(encoding="utf-8")
