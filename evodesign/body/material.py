"""Materials by name: what a density may be when a link is made of something that can be bought.

A link is a solid of one density. Where the real part is hollow, or holds motors, its density is an effective
one: mass over the volume of the shape. That is nobody's material, so such densities are a problem's own
materials, and their source says how they came about.

Source: W. D. Callister and D. G. Rethwisch, Materials Science and Engineering: An Introduction, Table B.1
(densities at room temperature), where a material names no other.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

_TABLE = "Callister and Rethwisch, Materials Science and Engineering, Table B.1"


@dataclass(frozen=True, slots=True)
class Material:
    """What a link can be made of.

    Args:
        name: such as `aluminium_6061`.
        density: [kg/m^3].
        source: where the density stands.
    """

    name: str
    density: float
    source: str


_MATERIALS = (
    Material("abs", 1050.0, "Engineers Edge, Properties of Plastic Materials: ABS, extrusion grade"),
    Material("nylon_66", 1140.0, _TABLE),
    Material("polycarbonate", 1200.0, _TABLE),
    Material("peek", 1310.0, _TABLE),
    Material(
        "carbon_fibre_epoxy",
        1600.0,
        "Hull, An Introduction to Composite Materials, 1992: carbon fibres in epoxy, 60 % by volume",
    ),
    Material("magnesium_az31b", 1770.0, _TABLE),
    Material("glass_fibre_epoxy", 2100.0, f"{_TABLE}: E-glass fibres in epoxy, 60 % by volume"),
    Material("aluminium_6061", 2700.0, _TABLE),
    Material("aluminium_7075", 2800.0, _TABLE),
    Material("titanium_6al_4v", 4430.0, _TABLE),
    Material("steel_4340", 7850.0, _TABLE),
    Material("stainless_304", 8000.0, _TABLE),
)

CATALOGUE: Final[Mapping[str, Material]] = {material.name: material for material in _MATERIALS}
"""The materials that every problem knows, by name, the lightest first."""
