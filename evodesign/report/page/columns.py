"""Designs side by side, for a smaller page: what they have in common is written once.

    [{"form": .., "of": [number, ..], "columns": [[value, ..] or value, ..], "places": [index, ..]}, ..]

Designs whose parts differ in texts and numbers alone have one `form`, in which zero stands for each of these.
`places` says for each zero, in the form's order, which of the columns holds its values: one for each design
of `of`, or a single one for all. An index below zero is that of the column -1 - index with all signs turned:
left and right limbs of symmetric postures. A front's postures take a third of what they take one by one.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import msgspec

Column = tuple[Any, ...]
"""A text or number, or nothing, of each design."""


def side_by_side(parts: Mapping[int, Any]) -> list[dict[str, Any]]:
    """Parts of designs by the design's number, made of dictionaries, lists, texts and numbers."""
    forms: dict[bytes, tuple[Any, list[int], list[list[Any]]]] = {}
    for number, part in parts.items():
        values: list[Any] = []
        form = _form(part, values)
        _, numbers, rows = forms.setdefault(msgspec.json.encode(form), (form, [], []))
        numbers.append(number)
        rows.append(values)
    return [
        {"form": form, "of": numbers, **_columns([*zip(*rows, strict=True)])}
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


def _columns(columns: list[Column]) -> dict[str, list[Any]]:
    """Columns that differ by more than their sign, and where they stand."""
    known: dict[Column, int] = {}
    places = []
    written = []
    for column in columns:
        place = known.get(_with_types(column))
        if place is None and all(isinstance(value, float) for value in column):
            turned = known.get(_with_types(tuple(-value for value in column)))
            place = None if turned is None else -1 - turned
        if place is None:
            place = known.setdefault(_with_types(column), len(known))
            written.append(column[0] if len({*_with_types(column)}) == 1 else column)
        places.append(place)
    return {"columns": written, "places": places}


def _with_types(column: Column) -> Column:
    """A column to look up: true is not one, though Python holds them equal."""
    return tuple((type(value), value) for value in column)
