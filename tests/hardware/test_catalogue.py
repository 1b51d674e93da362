"""Rows of the catalogue: sources, quoted figures, orders of torques, how many there are of which kinds."""

from __future__ import annotations

import re

import pytest

from evodesign.body.material import CATALOGUE
from evodesign.hardware.catalogue import CatalogueRow, Gear, catalogue, catalogue_sources
from evodesign.hardware.structure import STRENGTHS

ROWS = list(catalogue().values())
"""Figures are positive, as `Figure` has it, or the file could not be read."""


def test_every_row_has_a_maker_a_source_that_is_explained_and_its_words() -> None:
    for row in ROWS:
        assert catalogue_sources()[row.source]
        assert row.maker, row.model
        assert 0 < len(row.words) <= 200, row.model
    assert set(STRENGTHS) <= set(CATALOGUE)


def test_no_source_is_left_that_no_row_has() -> None:
    assert set(catalogue_sources()) == {row.source for row in ROWS} | {"gearheads"}


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row.model)
def test_words_quote_the_figures_of_the_row(row: CatalogueRow) -> None:
    """In the source's units: g or kg, mm, kg cm^2, kg mm^2 or kg m^2, ohms of a phase or of two."""
    quoted = {float(text) for text in re.findall(r"\d*\.?\d+(?:e-?\d+)?", row.words)}
    given = [
        (row.peak_torque_n_m, [1.0]),
        (row.rated_torque_n_m, [1.0]),
        (row.repeated_peak_torque_n_m, [1.0]),
        (row.momentary_peak_torque_n_m, [1.0]),
        (row.ratcheting_torque_n_m, [1.0]),
        (row.no_load_speed_rpm, [1.0]),
        (row.friction_torque_n_m, [1.0]),
        (row.load_friction or None, [1.0]),
        (row.viscous_friction_n_m_s_per_rad or None, [1.0]),
        (row.mass_kg, [1.0, 1e3]),
        (row.diameter_m, [1e3]),
        (row.length_m, [1e3]),
        (row.phase_resistance_ohm, [1.0, 2.0]),
        (row.rotor_inertia_kg_cm2, [1.0, 1e2, 1e-4]),
        (row.output_inertia_kg_m2, [1.0, 1e4]),
        (row.ratio, [1.0]),
    ]
    for figure, units in given:
        wanted = [figure * unit for unit in units if figure is not None]
        near = [pytest.approx(each, rel=1e-9) for each in wanted]
        assert figure is None or any(each == one for each in quoted for one in near), figure


def test_torques_rise_from_rated_to_ratcheting() -> None:
    for row in ROWS:
        assert list(row.torques) == sorted(row.torques), row.model


def test_figures_of_a_row_agree_with_each_other() -> None:
    """Torque per mass, density of the housing and loss at rated torque are those of machines."""
    for row in ROWS:
        assert 2.0 < row.peak_torque_n_m / row.mass_kg < 190.0, row.model
        if row.housing is not None:
            diameter, length = row.housing
            assert 1000.0 < row.mass_kg / (0.7854 * diameter**2 * length) < 6000.0, row.model
        if row.motor_constant is not None and row.rated_torque_n_m is not None:
            assert 0.1 < (row.rated_torque_n_m / row.motor_constant) ** 2 < 300.0, row.model


def test_the_catalogue_has_strain_wave_drives_many_makers_and_sizes_to_400_newton_metres() -> None:
    assert len(ROWS) >= 40
    assert len({row.maker for row in ROWS}) >= 8
    for gear, least in ((Gear.PLANETARY, 80), (Gear.STRAIN_WAVE, 40)):
        rows = [row for row in ROWS if row.gear is gear]
        assert len(rows) >= least
        assert len({row.maker for row in rows}) >= 6
        assert min(row.peak_torque_n_m for row in rows) < 5.0
        assert max(row.peak_torque_n_m for row in rows) >= 400.0


def test_inertia_given_at_the_output_is_taken_as_it_is() -> None:
    row = catalogue()["FHA-14C-100"]
    assert row.reflected_inertia == row.output_inertia_kg_m2 == 0.215
    assert catalogue()["PND-80-20-50-S"].reflected_inertia == pytest.approx(51.0**2 * 2.93e-4)


def test_the_motor_constant_of_a_strain_wave_drive_by_hand() -> None:
    """RH-25: 10.1 N m/A (rms) and 0.16 ohm: 108 N m take 10.7 A, as the maker says (10.6), and 55 W."""
    row = catalogue()["RH-25"]
    current = 108.0 / 10.1
    assert current == pytest.approx(10.6, rel=0.02)
    assert row.motor_constant is not None
    assert (108.0 / row.motor_constant) ** 2 == pytest.approx(3.0 * 0.16 * current**2, rel=1e-12)


def test_amperes_of_peak_are_converted() -> None:
    """DM-J4310 V1.1: 0.945 N m per ampere of peak is 1.336 per ampere (rms)."""
    row = catalogue()["DM-J4310 V1.1"]
    assert row.torque_constant_n_m_per_a == pytest.approx(0.945 * 2.0**0.5, rel=1e-4)
