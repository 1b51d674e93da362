"""The people that a problem file names: a population's table stands for one person per sex and percentile."""

from __future__ import annotations

from collections.abc import Sequence

import msgspec

from evodesign.errors import InputError
from evodesign.human.population import population
from evodesign.mechanics.scene import Agent
from evodesign.problem.file import HumanTable, ProblemFile
from evodesign.records import ProblemSource

__all__ = ["everyone", "refuse_unrated"]

OF_ONE = ("stature_m", "mass_kg", "sex", "urdf")
"""Keys that describe one person and so do not go with a population."""


def everyone(tables: ProblemFile, source: ProblemSource) -> list[tuple[str, HumanTable]]:
    """A table for each person, with its key for messages, in the file's order.

    Raises:
        InputError: a population that cannot be, or one that is also a single person.
    """
    return [one for key, table in tables.people.items() for one in _members(key, table, source)]


def _members(key: str, table: HumanTable, source: ProblemSource) -> list[tuple[str, HumanTable]]:
    if table.population is None:
        return [(key, table)]
    for other in OF_ONE:
        if getattr(table, other) is not None:
            raise InputError(source.path, f"{key}.{other}", "either this key or population", "both")
    try:
        people = population(table.population.sex, table.population.percentiles)
    except InputError as error:
        raise InputError(source.path, f"{key}.{error.key}", error.wanted, error.found) from error
    group = f"{table.name} " if table.name else ""
    return [
        (
            key,
            msgspec.structs.replace(
                table,
                population=None,
                name=group + name,
                stature_m=person.stature,
                mass_kg=person.mass,
                sex=person.sex,
            ),
        )
        for name, person in people.items()
    ]


def refuse_unrated(key: str, name: str, source: ProblemSource, people: Sequence[Agent]) -> None:
    """Refuse an objective that needs strengths where a person has none.

    Args:
        key: of the objective.
        name: of the objective.
        source: the problem, for messages.
        people: all that the problem has.
    Raises:
        InputError: none of a person's moving joints has a strength.
    """
    for person in people:
        if not any(joint in person.strengths for joint in person.joints):
            wanted = "people of known strength (stature_m, mass_kg and sex, or strengths_n_m)"
            found = f"'{name}' with a person '{person.tree.name}' of unknown strength"
            raise InputError(source.path, key, wanted, found)
