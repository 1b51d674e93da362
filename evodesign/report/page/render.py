"""One file of a page: template, style, scripts, plotly and the content, with nothing left to fetch.

Plotly and what comes from the log stand in packed blocks, which the browser unpacks: less than half the size,
and nothing in them that HTML could read as markup. Scripts put what the log says into the page as text.
"""

from __future__ import annotations

import base64
import gzip
import math
from collections.abc import Mapping
from functools import cache
from importlib.resources import files
from typing import Any

import msgspec
from plotly.offline import get_plotlyjs

from evodesign.report.page.content import Content, DesignContent
from evodesign.report.page.downloads import DIGITS

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
    "remarks.js",
    "downloads.js",
    "card.js",
    "beside.js",
    "link.js",
    "head.js",
    "main.js",
)
"""In the order in which they stand in the page; all share one scope."""


STEPS: Mapping[str, tuple[int, float]] = {
    "postures": (4_000, 1e6),
    "static_torques": (2_000, 1e6),
    "slices": (2_000, math.inf),
    "hardware": (4_000, math.inf),
    "links": (40_000, math.inf),
    "joints": (40_000, math.inf),
    "urdf": (40_000, math.inf),
}
"""Into how many steps the numbers of designs are parted at least, by field, and how many a unit has at most.

Of a joint that turns by 1 rad a step is at most 0.014 degrees; below a micrometre or a millionth of a newton
metre stands what a solver leaves."""


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
    designs = told["designs"]
    for group in ("objectives", "constraints", "parameters"):
        columns = told["points"][group]
        told["points"][group] = {name: [_rounded(one, DIGITS) for one in columns[name]] for name in columns}
    for design in designs.values():
        for case in design["cases"]:
            case["residual"] = _rounded(case["residual"], 2)
    told["limit_kinds"], told["limits"] = _limits(designs)
    fields = DesignContent.__struct_fields__
    by_field = {field: {number: design[field] for number, design in designs.items()} for field in fields}
    told["designs"] = {field: side_by_side(parts, *STEPS.get(field, ())) for field, parts in by_field.items()}
    return told


def _limits(designs: Mapping[int, Any]) -> tuple[list[dict[str, Any]], dict[int, list[list[float]]]]:
    """Active limits, which are taken out of postures, for no two designs have the same ones.

    Returns:
        Limits that differ by more than their price, and of each design by posture, one after the other, which
        of them are active and their prices, all with the three digits that the page shows.
    """
    kinds: dict[bytes, tuple[int, dict[str, Any]]] = {}
    found: dict[int, list[list[float]]] = {}
    for number, design in designs.items():
        found[number] = []
        for posture in design["postures"]:
            found[number].append([])
            for limit in posture.pop("limits", ()):
                price, limit["value"] = (_rounded(limit.pop(key), 3) for key in ("price_n_m", "value"))
                place, _ = kinds.setdefault(msgspec.json.encode(limit), (len(kinds), limit))
                found[number][-1] += (place, price)
    return [limit for _, limit in kinds.values()], found


def _rounded(value: Any, digits: int) -> Any:
    """A number with so many digits; what does not exist stays None."""
    return None if value is None else float(f"{value:.{digits}g}")


@cache
def _plotly() -> str:
    return _packed(get_plotlyjs().encode())


def _packed(data: bytes) -> str:
    """Bytes compressed with gzip, in the letters of base85; the same for the same bytes.

    Base85 has no slash, so that nothing in it ends a script, and takes 15/16 of the letters of base64.
    """
    return base64.b85encode(gzip.compress(data, mtime=0)).decode()


@cache
def _text(name: str) -> str:
    return TEMPLATE.joinpath(name).read_text(encoding="utf-8")


Column = tuple[Any, ...]
"""A text or number, or nothing, of each design."""


def side_by_side(parts: Mapping[int, Any], least: int = 0, finest: float = math.inf) -> list[dict[str, Any]]:
    """Parts of designs side by side, for a smaller page: what they have in common is written once.

        [{"form": .., "of": [number, ..], "columns": [[value, ..] or value, ..], "places": [index, ..]}, ..]
        with numbers that may lose digits, a column is {"per": steps in a unit, "times": [integer, ..]}

    Designs whose parts differ in texts and numbers alone have one `form`, in which zero stands for each of
    these. `places` says for each zero, in the form's order, which of the columns holds its values: one for
    each design of `of`, or a single one for all. An index below zero is that of the column -1 - index with
    all signs turned: left and right limbs of symmetric postures. A front's postures take a fifth of what they
    take one by one.

    Args:
        parts: by the design's number, made of dictionaries, lists, texts and numbers.
        least: steps that the largest number of a column has at least; digits stay where it is zero.
        finest: how many a unit has at most.
    """
    forms: dict[bytes, tuple[Any, list[int], list[list[Any]]]] = {}
    for number, part in parts.items():
        values: list[Any] = []
        form = _form(part, values)
        _, numbers, rows = forms.setdefault(msgspec.json.encode(form), (form, [], []))
        numbers.append(number)
        rows.append(values)
    return [
        {"form": form, "of": numbers, **_columns([*zip(*rows, strict=True)], least, finest)}
        for form, numbers, rows in forms.values()
    ]


def _form(part: Any, values: list[Any]) -> Any:
    """A part with zero for its texts and numbers, which are appended to the values."""
    if isinstance(part, dict):
        return {key: _form(value, values) for key, value in part.items()}
    if isinstance(part, list | tuple):
        return [_form(value, values) for value in part]
    values.append(part)
    return 0


def _columns(columns: list[Column], least: int, finest: float) -> dict[str, list[Any]]:
    """Columns that differ by more than their sign, and where they stand."""
    known: dict[Column, int] = {}
    places = []
    written: list[Any] = []
    for column in columns:
        numbers = all(isinstance(value, float) for value in column)
        in_steps = numbers and least and len({*column}) > 1
        per = _per_unit(max(map(abs, column)), least, finest) if in_steps else 0.0
        kept = tuple(round(value * per) for value in column) if per else column
        place = known.get(_with_types((per, *kept)))
        if place is None and numbers:
            turned = known.get(_with_types((per, *(-value for value in kept))))
            place = None if turned is None else -1 - turned
        if place is None:
            place = known.setdefault(_with_types((per, *kept)), len(known))
            if len({*_with_types(kept)}) == 1:
                written.append(kept[0] / per if per else kept[0])
            else:
                written.append({"per": per, "times": kept} if per else kept)
        places.append(place)
    return {"columns": written, "places": places}


def _per_unit(largest: float, least: int, finest: float) -> float:
    """How many steps a unit has, 1, 2 or 5 times a power of ten, so that the largest number has enough."""
    if largest == 0.0 or largest * finest <= least:
        return finest if finest < math.inf else 0.0
    power = 10.0 ** math.floor(math.log10(least / largest))
    return next(factor * power for factor in (1.0, 2.0, 5.0, 10.0) if factor * power * largest >= least)


def _with_types(column: Column) -> Column:
    """A column to look up: true is not one, though Python holds them equal."""
    return tuple((type(value), value) for value in column)
