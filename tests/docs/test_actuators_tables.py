"""The tables of docs/hardware.md and docs/actuators.md are those of the catalogue."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import pytest

from docs.write_actuators import PUBLISHED, TABLES, parts
from evodesign.hardware.catalogue import Gear, catalogue


@pytest.mark.parametrize("name", TABLES)
def test_the_pages_show_the_tables_of_today(name: str) -> None:
    assert parts(name)[1] == TABLES[name](), "python -m docs.write_actuators writes them"


def test_the_text_counts_the_rows_as_they_are(repository: Path) -> None:
    text = " ".join((repository / "docs" / "hardware.md").read_text(encoding="utf-8").split())
    rows = list(catalogue().values())
    gears = Counter(row.gear for row in rows)
    peaks = [row.peak_torque_n_m for row in rows]
    for words in (
        f"has {len(rows)} models of {len({row.maker for row in rows})} makers",
        f"peak torques from {min(peaks):g} to {max(peaks):g} N m",
        f"{gears[Gear.PLANETARY]} with planetary gears, {gears[Gear.STRAIN_WAVE]} with strain wave gears",
        f"{gears[None]} whose source does not name the kind",
        f"{sum(row.rated_torque_n_m is not None for row in rows)} a rated torque",
        f"{sum(row.speed is not None for row in rows)} a speed",
        f"{sum(row.housing is not None for row in rows)} the housing's",
        f"{sum(row.reflected_inertia is not None for row in rows)} the rotor's inertia",
        f"{sum(row.motor_constant is not None for row in rows)} torque constant and resistance",
        f"turns the output without current ({sum(row.friction_torque_n_m is not None for row in rows)} rows",
    ):
        assert words in text, words


def test_published_masses_are_those_of_the_catalogue() -> None:
    """But for H1's, which is a density, and DM-J4340P's, of another revision."""
    masses = {row.mass_kg for row in catalogue().values()}
    given = [joint for joint in PUBLISHED if joint.mass is not None]
    assert len({joint.robot for joint in PUBLISHED}) >= 5
    assert {joint.actuator for joint in given if joint.mass not in masses} == {
        "M107, 189 N m/kg",
        "Damiao DM-J4340P",
    }
