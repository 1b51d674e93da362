"""The population file: named designs, exactly as a user writes them."""

from __future__ import annotations

from typing import Annotated

import msgspec
from msgspec import Meta

from evodesign.problem.table import Name, Positive, Table

__all__ = ["DesignEntry", "PopulationFile"]


class DesignEntry(Table, frozen=True):
    """`[[design]]` of a population file: values by group; what is left out stays unscaled.

    `material` names the material of a density that has materials, in place of `density_kg_per_m3`.
    """

    name: Name
    length: dict[str, Positive] = msgspec.field(default_factory=dict)
    density_kg_per_m3: dict[str, Positive] = msgspec.field(default_factory=dict)
    allocation: dict[str, float] = msgspec.field(default_factory=dict)
    material: dict[str, Name] = msgspec.field(default_factory=dict)


class PopulationFile(Table, frozen=True):
    """A whole population file."""

    name: Name
    design: Annotated[tuple[DesignEntry, ...], Meta(min_length=1)]
