"""`[design]` and `[[material]]`: what of the robot may change."""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta

from evodesign.problem.table import Name, Positive, Table

__all__ = ["AllocationTable", "DensityTable", "DesignTable", "MaterialTable"]


class LengthTable(Table, frozen=True):
    """`[[design.length]]`: a length multiplier shared by links."""

    name: Name
    links: Annotated[tuple[Name, ...], Meta(min_length=1)]
    lower: Positive
    upper: Positive


class DensityTable(Table, frozen=True):
    """`[[design.density]]`: a density shared by links: within bounds, or that of one of some materials."""

    name: Name
    links: Annotated[tuple[Name, ...], Meta(min_length=1)]
    lower_kg_per_m3: Positive | None = None
    upper_kg_per_m3: Positive | None = None
    materials: tuple[Name, ...] | None = None


class MaterialTable(Table, frozen=True):
    """`[[material]]`: a material beside those of the catalogue, and where its density comes from."""

    name: Name
    density_kg_per_m3: Positive
    source: Name


class AllocationTable(Table, frozen=True):
    """`[[design.allocation]]`: how a design shares the load; see `design.allocation` for the names."""

    name: Name
    lower: float
    upper: float


class DesignTable(Table, frozen=True):
    """`[design]`: what may change."""

    length: tuple[LengthTable, ...] = ()
    density: tuple[DensityTable, ...] = ()
    allocation: tuple[AllocationTable, ...] = ()
