"""What a search is: something that asks for genomes and is told outcomes.

A search knows no robots. Its random state is its own, derived from the seed alone, so that asking and
telling again what a log remembers rebuilds it exactly (resume by replay).

An asynchronous search is asked for one genome at a time, and told outcomes as they come. Turns number the
genomes in the order of asking. The genome of a turn follows from the settings, the turn and the outcomes told
before it was asked, and from nothing else: asking leaves no trace. So a genome that was asked and never
evaluated, because a session ended, needs no record, and a log that says which outcomes were known at each
turn rebuilds everything. It does not matter how many workers there were.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from evodesign.records import Genome

Gradient = tuple[float | None, ...]
"""Derivatives by coordinate of the genome; None for a discrete one."""

JOINT_STARTS = "joint-starts"
"""Name of the search whose genomes are starts of another solver, and not designs to assess."""


GRADIENT_SEARCHES = frozenset({"surrogate"})
"""Names of the searches that use gradients where evaluations have them."""


POPULATIONS = {"surrogate": 8}
"""Evaluations of a generation where none are given, by the name of the search."""

USUAL_POPULATION = 48
"""Of every other search."""


@dataclass(frozen=True, slots=True)
class ObjectivePart:
    """One of the values whose mean an objective is, and its derivatives; None where these are unknown."""

    value: float
    gradient: Gradient | None


@dataclass(frozen=True, slots=True)
class Outcome:
    """What a search may know of an evaluated genome.

    Args:
        objectives: values, all to be minimised; None when one of them does not exist.
        violation: sum of constraint violations, zero when feasible; None when a failure left it unknown.
        gradients: of each objective, None for one that does not exist; none at all where none were asked for.
        margins: how far the design lies beyond each constraint's bounds, negative within them; None where it
            is unknown. None at all where only the violation is told.
        margin_gradients: of each margin, as of objectives.
        descriptors: in the settings' order, None for one that does not exist; none where none are named.
        parts: of each objective, those whose mean it is, as many in every outcome; none for one that is no
            such mean. None at all where nothing is known of them.
    """

    objectives: tuple[float, ...] | None
    violation: float | None
    gradients: tuple[Gradient | None, ...] = ()
    margins: tuple[float | None, ...] = ()
    margin_gradients: tuple[Gradient | None, ...] = ()
    descriptors: tuple[float | None, ...] = ()
    parts: tuple[tuple[ObjectivePart, ...], ...] = ()

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


class AsynchronousSearch(Protocol):
    """An asynchronous search, ready when constructed."""

    def ask(self, turn: int) -> Genome:
        """The genome of a turn, in the unit cube."""

    def tell(self, turn: int, outcome: Outcome) -> None:
        """The outcome of a turn's genome; every turn that was asked may be told, once, in any order."""
