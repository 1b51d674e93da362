"""Values beyond the bounds of their parameters are told, and no others."""

from __future__ import annotations

import pytest

from evodesign.problem.designs import beyond_bounds
from evodesign.records import Parameter

LENGTH = Parameter(name="length.shank", lower=0.6, upper=1.8, unit="1")
DENSITY = Parameter(
    name="density.shank",
    lower=1000.0,
    upper=3000.0,
    unit="kg/m^3",
    choices=(1000.0, 3000.0),
    materials=("a", "b"),
)


@pytest.mark.parametrize("coordinate", [0.0, 1e-17, 0.3, 1.0 - 1e-16, 1.0])
def test_what_a_genome_stands_for_is_within_bounds(coordinate: float) -> None:
    logarithmic = Parameter(name="rated.knee", lower=3.0, upper=700.0, unit="N m", logarithmic=True)
    parameters = (LENGTH, DENSITY, logarithmic)
    assert beyond_bounds(parameters, [each.value_at(coordinate) for each in parameters]) == {}


def test_a_sentence_has_value_and_bounds_in_the_parameters_unit() -> None:
    assert beyond_bounds((LENGTH, DENSITY), (1.8000001, 7850.0)) == {
        "length.shank": "length.shank = 1.8000001 is beyond its bounds, 0.6 to 1.8",
        "density.shank": "density.shank = 7850 kg/m^3 is beyond its bounds, 1000 to 3000 kg/m^3",
    }
    assert list(beyond_bounds((LENGTH, DENSITY), (0.59, 1000.0))) == ["length.shank"]
