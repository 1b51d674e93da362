"""`[design]` and `[[material]]`: what of the robot may change."""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta

from evodesign.problem.table import Name, Positive, Share, Table

__all__ = [
    "ActuatorTable",
    "AllocationTable",
    "DensityTable",
    "DesignTable",
    "HardwareTable",
    "MaterialTable",
    "WallTable",
]


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


class WallTable(Table, frozen=True):
    """`[[design.wall]]`: links that are hollow: a fixed thickness or bounds of it, and what they are made of.

    Without `material`, a `[[design.density]]` of the same links chooses it.
    """

    name: Name
    links: Annotated[tuple[Name, ...], Meta(min_length=1)]
    thickness_m: (
        float | tuple[float, float]
    )  # bounds in such a union end msgspec 0.20 with a segmentation fault
    material: Name | None = None


class ActuatorTable(Table, frozen=True):
    """`[[design.actuator]]`: what drives a group of joints: any rated torque within bounds, or a model."""

    name: Name
    joints: Annotated[tuple[Name, ...], Meta(min_length=1)]
    rated_torque_n_m: tuple[Positive, Positive] | None = None
    models: tuple[Name, ...] | None = None


class HardwareTable(Table, frozen=True):
    """`[hardware]`: the share of a hollow link's mass in the file that stays beside its wall."""

    non_structural_share: Share = 0.3


class AllocationTable(Table, frozen=True):
    """`[[design.allocation]]`: how a design shares the load; see `design.allocation` for the names."""

    name: Name
    lower: float
    upper: float


class DesignTable(Table, frozen=True):
    """`[design]`: what may change."""

    length: tuple[LengthTable, ...] = ()
    density: tuple[DensityTable, ...] = ()
    wall: tuple[WallTable, ...] = ()
    actuator: tuple[ActuatorTable, ...] = ()
    allocation: tuple[AllocationTable, ...] = ()
