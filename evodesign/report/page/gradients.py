"""How the objectives of a page's marked designs change with their parameters."""

from __future__ import annotations

from collections.abc import Iterable

from msgspec.structs import replace

from evodesign.problem.build import build_problem
from evodesign.problem.factory import evaluator_of
from evodesign.problem.progress import PrecomputeProgress
from evodesign.problem.sensitivities import Sensitivities
from evodesign.report.page.content import Content
from evodesign.runlog.run import Run

__all__ = ["Gradients", "gradients_of", "with_gradients"]

Gradients = dict[str, dict[str, float]]
"""Derivatives by objective, then by parameter."""


def with_gradients(content: Content, run: Run, jobs: int, progress: PrecomputeProgress) -> Content:
    """The page with the gradients of its marked designs; arguments as in `gradients_of`."""
    numbers = dict.fromkeys(mark.number for mark in content.marks if mark.number in content.designs)
    found = gradients_of(run, numbers, jobs, progress)
    designs = {
        number: replace(design, gradients=found.get(number, {})) for number, design in content.designs.items()
    }
    return replace(content, designs=designs)


def gradients_of(
    run: Run, numbers: Iterable[int], jobs: int, progress: PrecomputeProgress
) -> dict[int, Gradients]:
    """The gradients of some designs of a run, solved anew; objectives that have none are left out.

    Args:
        run: whose problem is built again.
        numbers: of evaluations.
        jobs: that work out what the problem needs once.
        progress: is shown what is worked out.
    """
    problem = build_problem(run.header.problem)
    evaluator = evaluator_of(problem, jobs, progress)
    derivatives = Sensitivities(problem, evaluator.known)
    genomes = {evaluation.number: evaluation.genome for evaluation in run.evaluations}
    found = {}
    for number in numbers:
        values = problem.space.values(genomes[number])
        sensitivities = derivatives.at(values, evaluator.solve(values)).sensitivities()
        found[number] = {
            name: dict(each.gradient) for name, each in sensitivities.items() if each.gradient is not None
        }
    return found
