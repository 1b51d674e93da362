"""The cases of a design, a person with a load at a height each, and what they are called.

A log names people where a problem has several, and loads likewise; with one of each, a case is its height.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Protocol

__all__ = ["Case", "case_name", "named_people_or_loads", "pair_name"]


class Case(Protocol):
    """What outcomes and postures of a case have in common."""

    @property
    def height_m(self) -> float:
        """Of the load [m]."""

    @property
    def human_name(self) -> str:
        """Who holds it; empty where there is one person."""

    @property
    def payload_name(self) -> str:
        """What is held; empty where there is one load."""


def pair_name(case: Case) -> str:
    """Person and load, such as `short, 5 kg`; empty where there is one of each."""
    return ", ".join(name for name in (case.human_name, case.payload_name) if name)


def case_name(case: Case) -> str:
    """Person, load and height, such as `short, 5 kg, 0.8 m`."""
    return ", ".join(name for name in (pair_name(case), f"{case.height_m:g} m") if name)


def named_people_or_loads(cases: Iterable[Case]) -> bool:
    """Whether a height alone does not say which case is meant."""
    return any(pair_name(case) for case in cases)
