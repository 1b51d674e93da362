"""How the objectives of a run's designs move with their parameters, worked out from the log's problem."""

from __future__ import annotations

from collections.abc import Iterable

from evodesign.cli.making import making
from evodesign.problem.build import build_problem
from evodesign.problem.factory import evaluator_of
from evodesign.problem.sensitivities import Sensitivities
from evodesign.runlog.run import Run

__all__ = ["Gradients", "gradients_of"]

Gradients = dict[str, dict[str, float]]
"""Derivatives by objective, then by parameter."""


def gradients_of(run: Run, numbers: Iterable[int], jobs: int) -> dict[int, Gradients]:
    """The gradients of some designs of a run, solved anew; objectives that have none are left out.

    Args:
        run: whose problem is built again.
        numbers: of evaluations.
        jobs: that work out what the problem needs once.
    """
    problem = build_problem(run.header.problem)
    with making() as progress:
        evaluator = evaluator_of(problem, jobs, progress)
    derivatives = Sensitivities(problem, evaluator.known)
    genomes = {evaluation.number: evaluation.genome for evaluation in run.evaluations}
    found = {}
    for number in numbers:
        values = problem.space.values(genomes[number])
        moves = derivatives.at(values, evaluator.solve(values)).sensitivities()
        found[number] = {
            name: dict(move.gradient) for name, move in moves.items() if move.gradient is not None
        }
    return found
