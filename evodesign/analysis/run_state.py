"""Where a run stands: its front, best values and hypervolume, carried on from generation to generation.

A design that is dominated once never counts again, so that only the front is carried on, and of its members
what they are compared by. The work and the memory of a generation grow with the front, not with the run.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import msgspec

from evodesign.analysis.front import front
from evodesign.analysis.growth import growth_of
from evodesign.analysis.hypervolume import best, hypervolume, reference_point
from evodesign.records import Evaluation, Front, Generation, Objective, RunHeader

LEAST_GROWTH = 1e-3
"""Share of its value by which a hypervolume must grow to count as growing."""


def stagnant(hypervolumes: Sequence[float | None], generations: int | None) -> bool:
    """Whether the last so many generations together made the hypervolume grow by less than a thousandth.

    Args:
        hypervolumes: after each generation; None before the first feasible design, where there is no
            standstill.
        generations: how many may pass without growth; None or zero for any number.
    """
    if not generations or len(hypervolumes) <= generations:
        return False
    before, now = hypervolumes[-1 - generations], hypervolumes[-1]
    return before is not None and now is not None and now < before * (1.0 + LEAST_GROWTH)


def exhausted(history: Sequence[tuple[int, float | None]], least_percent: float | None) -> bool:
    """Whether, by experience, not one in ten searches would still grow by so much with as many evaluations.

    Args:
        history: numbers of evaluations, each with the hypervolume after it.
        least_percent: growth of the hypervolume [%]; None or zero for any.
    """
    known = growth_of(history) if least_percent else None
    return known is not None and least_percent is not None and 100.0 * known.high < least_percent


class RunState:
    """The state of a run after the generations shown to it.

    Args:
        objectives: of the run.
    """

    def __init__(self, objectives: Sequence[Objective]) -> None:
        self._objectives = tuple(objectives)
        self._members: tuple[Evaluation, ...] = ()
        self._reference: dict[str, float] | None = None
        self._shown = 0
        self._history: list[tuple[int, float | None]] = []

    def over(self, header: RunHeader) -> bool:
        """Whether a search is to end that gains, or promises, less than its header wants."""
        hypervolumes = [volume for _, volume in self._history]
        stands_still = stagnant(hypervolumes, header.stagnation_generations)
        return stands_still or exhausted(self._history, header.least_growth)

    def add(self, born: Sequence[Evaluation]) -> None:
        """Take in a generation. The first that holds a feasible design fixes the reference."""
        self._shown += len(born)
        self._reference = self._reference or reference_point(self._objectives, born)
        self._members = front(self._objectives, (*self._members, *map(_bare, born)))
        reference = self._reference
        volume = None if reference is None else hypervolume(self._objectives, self._members, reference)
        self._history.append((self._shown, volume))

    def generation(self, number: int, born: Iterable[Evaluation], seconds: float) -> Generation:
        """The record of a generation that was added last, and took so long [s]."""
        feasible = [evaluation.feasible for evaluation in born]
        return Generation(
            number=number,
            evaluations=self._shown,
            feasible_share=sum(feasible) / len(feasible),
            hypervolume=self._history[-1][1],
            reference=self._reference,
            best=best(self._objectives, self._members),
            seconds=seconds,
        )

    def front(self, number: int) -> Front:
        """The front after a generation that was added last."""
        return Front(generation=number, evaluations=tuple(member.number for member in self._members))


def _bare(evaluation: Evaluation) -> Evaluation:
    """An evaluation with no more than what a front needs."""
    assessment = msgspec.structs.replace(evaluation.assessment, design={}, reach=None, cases=())
    return msgspec.structs.replace(evaluation, genome=(), assessment=assessment)
