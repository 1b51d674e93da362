"""Value functions and portfolios as they are kept: plain numbers under names with units."""

from __future__ import annotations

from typing import Any

import msgspec
import numpy as np

from evodesign.nlp.program import Start
from evodesign.nlp.start_portfolio import Coverage, StartPortfolio
from evodesign.posture.formulations.human_value import HumanValue
from evodesign.posture.precompute.precomputed import PersonReach

__all__ = [
    "StoredPersonReach",
    "StoredStartPortfolio",
    "StoredValue",
    "human_value_of_stored",
    "person_reach_of_stored",
    "portfolio_of",
    "stored_person_reach",
    "stored_portfolio",
    "stored_value",
]


class StoredValue(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A value function on disk; `height_m` without coefficients means that there is none."""

    height_m: float
    push_n: float
    coefficients: tuple[float, ...]
    starts: tuple[tuple[float, dict[str, list[float]]], ...]
    error: float


class StoredStartPortfolio(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A portfolio on disk."""

    starts: tuple[dict[str, list[float]], ...]
    designs: int
    good: int
    worst: float


class StoredPersonReach(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A person's reach on disk; None where no posture was found."""

    lowest_m: float | None
    highest_m: float | None


def stored_person_reach(stretch: PersonReach | None) -> StoredPersonReach:
    """A person's reach, or that there is none, to be kept."""
    return StoredPersonReach(stretch.lowest, stretch.highest) if stretch else StoredPersonReach(None, None)


def person_reach_of_stored(stored: StoredPersonReach) -> PersonReach | None:
    """The reach that was kept, or that there is none."""
    if stored.lowest_m is None or stored.highest_m is None:
        return None
    return PersonReach(stored.lowest_m, stored.highest_m)


def stored_value(value: HumanValue | None) -> StoredValue:
    """A value function, or that there is none, to be kept."""
    if value is None:
        return StoredValue(0.0, 0.0, (), (), 0.0)
    starts = tuple((push, _numbers(start)) for push, start in value.starts)
    return StoredValue(value.height, value.push, value.coefficients, starts, value.error)


def human_value_of_stored(stored: StoredValue) -> HumanValue | None:
    """The value function that was kept, or that there is none."""
    if not stored.coefficients:
        return None
    starts = tuple((push, _arrays(start)) for push, start in stored.starts)
    return HumanValue(stored.height_m, stored.push_n, stored.coefficients, starts, stored.error)


def stored_portfolio(found: StartPortfolio) -> StoredStartPortfolio:
    """A portfolio to be kept."""
    starts = tuple(_numbers(start) for start in found.starts)
    coverage = found.coverage
    return StoredStartPortfolio(starts, coverage.designs, coverage.good, coverage.worst)


def portfolio_of(stored: StoredStartPortfolio) -> StartPortfolio:
    """The portfolio that was kept."""
    starts = tuple(_arrays(start) for start in stored.starts)
    return StartPortfolio(starts, Coverage(stored.designs, stored.good, stored.worst))


def _numbers(start: Start) -> dict[str, list[float]]:
    return {name: np.asarray(block, float).tolist() for name, block in start.items()}


def _arrays(start: dict[str, list[float]]) -> dict[str, Any]:
    return {name: np.array(block) for name, block in start.items()}
