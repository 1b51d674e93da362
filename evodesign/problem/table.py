"""What every table of a user's file is made of: strict, with bounds on its numbers."""

from __future__ import annotations

from typing import Annotated, Any, get_args

import msgspec
from msgspec import Meta

FILL_IN = "FILL IN"
"""Stands in a file that `init` wrote for what could not be guessed; no value of any key."""

Positive = Annotated[float, Meta(gt=0.0)]
NotNegative = Annotated[float, Meta(ge=0.0)]
Share = Annotated[float, Meta(ge=0.0, le=1.0)]
Point = tuple[float, float, float]
Name = Annotated[str, Meta(min_length=1)]


class Table(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Base of all tables."""


def struct_in(kind: Any) -> type[msgspec.Struct] | None:
    """The table type inside an annotation such as `X | None` or `tuple[X, ...]`."""
    if isinstance(kind, type) and issubclass(kind, msgspec.Struct):
        return kind
    return next((found for part in get_args(kind) if (found := struct_in(part))), None)
