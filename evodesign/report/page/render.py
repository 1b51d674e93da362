"""One file of a page: template, style, scripts, plotly and the content, with nothing left to fetch.

Plotly and what comes from the log stand in packed blocks, which the browser unpacks: less than half the size,
and nothing in them that HTML could read as markup. Scripts put what the log says into the page as text.
"""

from __future__ import annotations

import base64
import gzip
from functools import cache
from importlib.resources import files
from typing import Any

import msgspec
from plotly.offline import get_plotlyjs

from evodesign.report.page.columns import side_by_side
from evodesign.report.page.content import Content, DesignContent

TEMPLATE = files("evodesign.report.page").joinpath("template")

STYLES = ("palette.css", "layout.css", "parts.css")

SCRIPTS = (
    "numbers.js",
    "store.js",
    "theme.js",
    "front.js",
    "front_axes.js",
    "front_pointer.js",
    "parallel.js",
    "progress.js",
    "failures.js",
    "importance.js",
    "families.js",
    "table.js",
    "matrices.js",
    "kinematics.js",
    "meshes.js",
    "surfaces.js",
    "shaders.js",
    "viewer.js",
    "steering.js",
    "scene.js",
    "cases.js",
    "stage.js",
    "torques.js",
    "motion.js",
    "ingredients.js",
    "hardware.js",
    "limits.js",
    "effort.js",
    "people.js",
    "reach.js",
    "downloads.js",
    "card.js",
    "beside.js",
    "link.js",
    "head.js",
    "main.js",
)
"""In the order in which they stand in the page; all share one scope."""


def page_html(content: Content) -> str:
    """The page as one HTML document."""
    parts = {
        "{{style}}": "\n".join(_text(name) for name in STYLES),
        "{{plotly}}": _plotly(),
        "{{content}}": _packed(msgspec.json.encode(_in_columns(content))),
        "{{scripts}}": "\n".join(_text(name) for name in SCRIPTS),
    }
    page = _text("page.html")
    pieces = []
    for mark, part in parts.items():
        before, _, page = page.partition(mark)
        pieces += [before, part]
    return "".join([*pieces, page])


def _in_columns(content: Content) -> dict[str, Any]:
    """The content with designs by field, side by side: gzip finds what is alike only where it is near."""
    told: dict[str, Any] = msgspec.to_builtins(content)
    fields = DesignContent.__struct_fields__
    designs = told["designs"].items()
    columns = {field: {number: design[field] for number, design in designs} for field in fields}
    told["designs"] = {field: side_by_side(column) for field, column in columns.items()}
    return told


@cache
def _plotly() -> str:
    return _packed(get_plotlyjs().encode())


def _packed(data: bytes) -> str:
    """Bytes compressed with gzip, in the letters of base64; the same for the same bytes."""
    return base64.b64encode(gzip.compress(data, mtime=0)).decode()


@cache
def _text(name: str) -> str:
    return TEMPLATE.joinpath(name).read_text(encoding="utf-8")
