"""The published strengths behind a generated person, as `data/strength.toml` holds them.

What each key means and where each figure comes from is said in that file; here is its form, read strictly.
"""

from __future__ import annotations

import tomllib
from enum import StrEnum
from functools import cache
from importlib import resources
from typing import Any

import msgspec

from evodesign.human.anthropometry_tables import Sex

__all__ = ["Direction", "Row", "Scale", "Source", "StrengthTables", "strength_tables"]


class Scale(StrEnum):
    """What a figure is multiplied by to give a moment [N m]."""

    N_M = "n_m"
    PER_MASS = "per_mass"
    PER_WEIGHT_AND_STATURE = "per_weight_and_stature"


class Table(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Base of the tables in `data/strength.toml`; what each key means is said there."""


class Source(Table, frozen=True):
    """Where figures come from, what they are multiplied by, and how far they could be checked."""

    citation: str
    scale: Scale
    checked: str


class Direction(Table, frozen=True):
    """The muscles' moment of one sign about a joint: what it does, and its figure for each sex."""

    movement: str
    source: str
    male: float
    female: float

    def of(self, sex: Sex) -> float:
        """The figure of a sex."""
        return {Sex.MALE: self.male, Sex.FEMALE: self.female}[sex]


class Row(Table, frozen=True):
    """Strengths of joints that share them; a direction for which nothing is published is left out."""

    joints: tuple[str, ...]
    negative: Direction | None = None
    positive: Direction | None = None


class StrengthTables(Table, frozen=True):
    """The whole data file."""

    sources: dict[str, Source]
    rows: tuple[Row, ...]


@cache
def strength_tables() -> StrengthTables:
    """The figures of `data/strength.toml`."""
    text = resources.files("evodesign.human").joinpath("data/strength.toml").read_text("utf-8")
    read: dict[str, Any] = tomllib.loads(text)
    return msgspec.convert(read, StrengthTables)
