"""The catalogue of materials against what its materials are made of."""

from __future__ import annotations

import pytest

from evodesign.body.material import CATALOGUE

EPOXY, CARBON_FIBRE, E_GLASS = 1250.0, 1780.0, 2580.0
"""Densities [kg/m^3] of what composites are made of (Callister and Rethwisch, Table B.1)."""

ELEMENTS = {
    "magnesium_az31b": {1738.0: 0.96, 2699.0: 0.03, 7133.0: 0.01},
    "aluminium_6061": {2699.0: 0.979, 1738.0: 0.01, 2329.0: 0.006, 8960.0: 0.003, 7190.0: 0.002},
    "aluminium_7075": {2699.0: 0.90, 7133.0: 0.056, 1738.0: 0.025, 8960.0: 0.016, 7190.0: 0.003},
    "titanium_6al_4v": {4507.0: 0.90, 2699.0: 0.06, 6110.0: 0.04},
    "steel_4340": {7874.0: 0.967, 8908.0: 0.018, 7190.0: 0.008, 7470.0: 0.007},
    "stainless_304": {7874.0: 0.71, 7190.0: 0.19, 8908.0: 0.10},
}
"""Mass shares of the alloys' elements by their densities [kg/m^3]."""


@pytest.mark.parametrize("name", ELEMENTS)
def test_alloys_weigh_about_what_their_elements_do(name: str) -> None:
    shares = ELEMENTS[name]
    mixed = sum(shares.values()) / sum(share / density for density, share in shares.items())
    assert CATALOGUE[name].density == pytest.approx(mixed, rel=0.03)


@pytest.mark.parametrize(
    ("name", "fibre"), [("carbon_fibre_epoxy", CARBON_FIBRE), ("glass_fibre_epoxy", E_GLASS)]
)
def test_composites_weigh_what_fibre_and_matrix_do(name: str, fibre: float) -> None:
    assert CATALOGUE[name].density == pytest.approx(0.6 * fibre + 0.4 * EPOXY, rel=0.05)


def test_materials_have_names_sources_and_rising_densities() -> None:
    materials = list(CATALOGUE.values())
    assert [material.name for material in materials] == list(CATALOGUE)
    assert all(material.source for material in materials)
    densities = [material.density for material in materials]
    assert densities == sorted(set(densities))
