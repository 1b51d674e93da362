"""Problems whose people are drawn from the distribution of measured ones, as a problem file would say it.

Sample k of a problem is the problem with `posture_sample = k` in place of `spread` in the tables of its
people, so that an evaluation of it is an ordinary one. All people of a problem are drawn by the same numbers:
where one is more bent than the mean, all are.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping

import msgspec
import tomli_w

from evodesign.errors import InputError
from evodesign.problem.agent_tables import HumanTable
from evodesign.problem.file import ProblemFile
from evodesign.problem.person_posture import is_measured
from evodesign.problem.source import decode_toml
from evodesign.records import ProblemSource


def samples_of(tables: ProblemFile, source: ProblemSource) -> int:
    """How many samples of people a problem asks for; 0 for none.

    Raises:
        InputError: tables of people ask for different numbers.
    """
    asked = {key: table.spread for key, table in tables.people.items() if table.spread is not None}
    for key, samples in asked.items():
        if samples != next(iter(asked.values())):
            wanted = f"the same number for all people, {next(iter(asked.values()))}"
            raise InputError(source.path, f"{key}.spread", wanted, f"{samples}")
    return next(iter(asked.values()), 0)


def asked_samples(source: ProblemSource) -> int:
    """The same from a problem's text; 0 also for one that this evodesign cannot read."""
    try:
        return samples_of(decode_toml(source.text, source.path, ProblemFile), source)
    except InputError:
        return 0


def refuse_unsampled(source: ProblemSource) -> None:
    """Refuse a problem none of whose people can be drawn from a distribution.

    Raises:
        InputError: no measured posture draws them, or they are drawn already.
    """
    if not _drawn(decode_toml(source.text, source.path, ProblemFile).people):
        wanted = 'a person with posture = "measured" and without posture_sample'
        raise InputError(source.path, "human", wanted, "none")


def sampled_source(source: ProblemSource, sample: int) -> ProblemSource:
    """The problem beside the people of a sample, counted from 1."""
    raw = tomllib.loads(source.text)
    drawn = _drawn(decode_toml(source.text, source.path, ProblemFile).people)
    people = raw["human"] if isinstance(raw["human"], list) else [raw["human"]]
    for place, person in enumerate(people):
        if place in drawn:
            person.pop("spread", None)
            person["posture_sample"] = sample
    return msgspec.structs.replace(source, text=tomli_w.dumps(raw))


def _drawn(people: Mapping[str, HumanTable]) -> frozenset[int]:
    """Places of the tables whose people are drawn: those that say so, or else all of whom it is possible."""
    tables = list(people.values())
    asked = {place for place, table in enumerate(tables) if table.spread is not None}
    others = (p for p, table in enumerate(tables) if is_measured(table) and table.posture_sample is None)
    return frozenset(asked or others)
