"""What a search is: something that asks for genomes and is told outcomes.

A search knows no robots. Its random state is its own, derived from the seed alone, so that asking and
telling again what a log remembers rebuilds it exactly (resume by replay).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from evodesign.records import Genome

__all__ = ["JOINT_STARTS", "Outcome", "Search"]

JOINT_STARTS = "joint-starts"
"""Name of the search whose genomes are starts of another solver, and not designs to assess."""


@dataclass(frozen=True, slots=True)
class Outcome:
    """What a search may know of an evaluated genome.

    Args:
        objectives: values, all to be minimised; None when one of them does not exist.
        violation: sum of constraint violations, zero when feasible; None when a failure left it unknown.
    """

    objectives: tuple[float, ...] | None
    violation: float | None

    @property
    def feasible(self) -> bool:
        """Whether every constraint holds and every objective exists."""
        return self.violation == 0.0 and self.objectives is not None


class Search(Protocol):
    """An ask-and-tell search, ready when constructed."""

    def ask(self) -> tuple[Genome, ...]:
        """The genomes of the next generation, in the unit cube."""

    def tell(self, outcomes: Sequence[Outcome]) -> None:
        """Outcomes of the genomes last asked for, in the same order."""
