"""Designs side by side, for a smaller page: what they have in common is written once.

    [{"form": .., "of": [number, ..], "columns": [[value, ..] or value, ..], "places": [index, ..]}, ..]
    with numbers that may lose digits, a column is {"per": steps in a unit, "times": [integer, ..]}

Designs whose parts differ in texts and numbers alone have one `form`, in which zero stands for each of these.
`places` says for each zero, in the form's order, which of the columns holds its values: one for each design
of `of`, or a single one for all. An index below zero is that of the column -1 - index with all signs turned:
left and right limbs of symmetric postures. A front's postures take a fifth of what they take one by one.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import msgspec

Column = tuple[Any, ...]
"""A text or number, or nothing, of each design."""


def side_by_side(parts: Mapping[int, Any], least: int = 0, finest: float = math.inf) -> list[dict[str, Any]]:
    """Parts of designs side by side.

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
