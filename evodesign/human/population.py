"""People of a population: stature and mass at a percentile of published distributions, by sex.

A percentile p stands for a person whose stature and whose mass are both the p-th percentile of their sex. It
is a convention that spans small and large bodies with few people; nobody says that the two go together.

Between two percentiles that the source prints, a value follows a straight line in the standard normal score
z = Phi^-1(p / 100), which is exact for a normal distribution; nothing is said beyond the outermost ones.

Source: the `source` key of `data/population.toml` (Fryar et al. 2025, Tables 3 and 7).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from enum import StrEnum
from functools import cache
from itertools import pairwise
from statistics import NormalDist

from evodesign.errors import InputError, nearest_name
from evodesign.human.anthropometry import Person
from evodesign.human.anthropometry_tables import Sex, figures
from evodesign.records import Record


class PopulationSex(StrEnum):
    """Whose percentiles are taken."""

    MALE = "male"
    FEMALE = "female"
    BOTH = "both"


SEXES: Mapping[PopulationSex, tuple[Sex, ...]] = {
    PopulationSex.MALE: (Sex.MALE,),
    PopulationSex.FEMALE: (Sex.FEMALE,),
    PopulationSex.BOTH: (Sex.FEMALE, Sex.MALE),
}


class Distribution(Record, frozen=True):
    """Stature [m] and mass [kg] of one sex at the table's percentiles."""

    stature_m: tuple[float, ...]
    mass_kg: tuple[float, ...]


class PopulationTable(Record, frozen=True):
    """The whole data file; the percentiles rise."""

    source: str
    percentiles: tuple[float, ...]
    female: Distribution
    male: Distribution

    def of(self, sex: Sex) -> Distribution:
        """The distribution of a sex."""
        return {Sex.MALE: self.male, Sex.FEMALE: self.female}[sex]


@cache
def population_table() -> PopulationTable:
    """The figures of `data/population.toml`."""
    return figures("population.toml", PopulationTable)


def population(sex: str, percentiles: Sequence[float]) -> Mapping[str, Person]:
    """People by name, such as `female P5`: women first, each sex in the order of the percentiles.

    Args:
        sex: `male`, `female` or `both`.
        percentiles: of stature and mass alike, each once.
    Raises:
        InputError: an unknown sex, no percentile, one twice, or one that the source does not reach.
    """
    if sex not in set(PopulationSex):
        wanted = f"one of {', '.join(PopulationSex)}"
        raise InputError(
            "human", "population.sex", wanted, f"'{sex}'{nearest_name(sex, list(PopulationSex))}"
        )
    _refuse(percentiles)
    return {
        f"{one} P{percentile:g}": _person(one, percentile)
        for one in SEXES[PopulationSex(sex)]
        for percentile in percentiles
    }


def _refuse(percentiles: Sequence[float]) -> None:
    """Refuse percentiles that cannot be looked up."""
    printed = population_table().percentiles
    if not percentiles:
        raise InputError("human", "population.percentiles", "at least one percentile", "an empty list")
    for position, percentile in enumerate(percentiles):
        key = f"population.percentiles[{position}]"
        if not printed[0] <= percentile <= printed[-1]:
            wanted = f"a number from {printed[0]:g} to {printed[-1]:g}, as far as the source goes"
            raise InputError("human", key, wanted, f"{percentile:g}")
        if percentile in percentiles[:position]:
            raise InputError("human", key, "each percentile once", f"{percentile:g} twice")


def _person(sex: Sex, percentile: float) -> Person:
    rows = population_table().of(sex)
    return Person(_at(percentile, rows.stature_m), _at(percentile, rows.mass_kg), sex)


def _at(percentile: float, values: Sequence[float]) -> float:
    """The value at a percentile within the table, on a straight line over the normal score."""
    printed = population_table().percentiles
    steps = zip(pairwise(printed), pairwise(values), strict=True)
    (before, after), (low, high) = next(step for step in steps if percentile <= step[0][1])
    start, end = _score(before), _score(after)
    share = (_score(percentile) - start) / (end - start)
    return low * (1.0 - share) + high * share


def _score(percentile: float) -> float:
    """The standard normal score of a percentile."""
    return NormalDist().inv_cdf(percentile / 100.0)
