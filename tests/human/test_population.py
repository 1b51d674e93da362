"""People at percentiles, against the printed tables, SciPy's normal distribution and other units."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import norm

from evodesign.errors import InputError
from evodesign.human.anthropometry import Person
from evodesign.human.anthropometry_tables import Sex
from evodesign.human.population import population, population_table

REACH = "wanted a number from 5 to 95, as far as the source goes"

INCHES = {
    Sex.FEMALE: (58.9, 59.8, 60.6, 61.6, 63.5, 65.4, 66.4, 67.1, 67.9),
    Sex.MALE: (63.9, 65.0, 65.9, 66.9, 69.0, 70.9, 72.1, 72.7, 73.7),
}
POUNDS = {
    Sex.FEMALE: (111.8, 120.6, 127.4, 138.0, 162.0, 196.7, 220.1, 236.3, 262.7),
    Sex.MALE: (134.2, 146.8, 154.3, 166.3, 191.0, 221.9, 244.8, 261.8, 290.6),
}
"""The same report's Tables 8 and 4, which print the two measures in other units."""


@pytest.mark.parametrize("sex", Sex)
def test_the_table_agrees_with_the_reports_tables_in_inches_and_pounds(sex: Sex) -> None:
    rows = population_table().of(sex)
    assert np.array(rows.stature_m) / 0.0254 == pytest.approx(np.array(INCHES[sex]), abs=0.071)
    assert np.array(rows.mass_kg) / 0.45359237 == pytest.approx(np.array(POUNDS[sex]), abs=0.17)


def test_a_printed_percentile_gives_the_printed_person() -> None:
    people = population("both", (5.0, 50.0, 95.0))
    assert list(people) == ["female P5", "female P50", "female P95", "male P5", "male P50", "male P95"]
    assert people["female P5"] == Person(1.496, 50.7, Sex.FEMALE)
    assert people["male P95"] == Person(1.872, 131.8, Sex.MALE)


@given(st.sampled_from(Sex), st.floats(5.0, 95.0))
def test_between_printed_percentiles_a_value_is_on_a_line_over_the_normal_score(sex: Sex, p: float) -> None:
    (someone,) = population(sex, (p,)).values()
    table = population_table()
    scores = norm.ppf(np.array(table.percentiles) / 100.0)
    rows = table.of(sex)
    assert someone.stature == pytest.approx(np.interp(norm.ppf(p / 100.0), scores, rows.stature_m), abs=1e-9)
    assert someone.mass == pytest.approx(np.interp(norm.ppf(p / 100.0), scores, rows.mass_kg), abs=1e-7)


@given(st.sampled_from(Sex), st.floats(5.0, 95.0), st.floats(5.0, 95.0))
def test_a_higher_percentile_is_never_a_smaller_person(sex: Sex, one: float, other: float) -> None:
    low, high = (next(iter(population(sex, (p,)).values())) for p in sorted((one, other)))
    assert low.stature <= high.stature + 1e-12
    assert low.mass <= high.mass + 1e-12


def test_statures_are_nearly_normal_and_masses_are_not() -> None:
    """Why masses are not taken from a mean and a standard deviation: the heavy half is far wider."""
    for sex in Sex:
        rows = population_table().of(sex)
        for values, least, most in ((rows.stature_m, 0.9, 1.15), (rows.mass_kg, 1.5, 2.1)):
            low, middle, high = values[0], values[4], values[-1]
            assert least < (high - middle) / (middle - low) < most


def test_the_same_question_has_the_same_answer() -> None:
    assert population("both", (12.5, 60.0)) == population("both", (12.5, 60.0))
    assert list(population("female", (12.5,))) == ["female P12.5"]


@pytest.mark.parametrize(
    ("sex", "percentiles", "sentence"),
    [
        ("both", (), "human: population.percentiles: wanted at least one percentile, found an empty list"),
        (
            "male",
            (50.0, 0.0),
            f"human: population.percentiles[1]: {REACH}, found 0",
        ),
        (
            "male",
            (99.0,),
            f"human: population.percentiles[0]: {REACH}, found 99",
        ),
        (
            "male",
            (float("nan"),),
            f"human: population.percentiles[0]: {REACH}, found nan",
        ),
        (
            "female",
            (5.0, 50.0, 5.0),
            "human: population.percentiles[2]: wanted each percentile once, found 5 twice",
        ),
        (
            "femal",
            (50.0,),
            "human: population.sex: wanted one of male, female, both, found 'femal'; did you mean 'female'?",
        ),
    ],
)
def test_a_population_that_cannot_be_is_refused_in_one_sentence(
    sex: str, percentiles: tuple[float, ...], sentence: str
) -> None:
    with pytest.raises(InputError) as caught:
        population(sex, percentiles)
    assert str(caught.value) == sentence
