"""The evaluation of designs beside samples of people, as workers build it.

Samples differ in parameters of the programs alone, so that all evaluations of a worker share its programs.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from evodesign.evaluation.evaluate import Evaluator
from evodesign.evaluation.factory import cached_precomputed, values_factory
from evodesign.evaluation.progress import SILENT, PrecomputeProgress
from evodesign.identity import digest
from evodesign.nlp.solver import SolverCache
from evodesign.pool.base import Limits, Pool
from evodesign.pool.registry import make_pool
from evodesign.posture.precompute.precomputed import Precomputed
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.samples import sampled_source
from evodesign.records import Assessed, ProblemSource, SampledDesign

Sampled = tuple[int, tuple[float, ...]]
"""The number of a sample, and a design as one value per parameter."""


@dataclass(frozen=True, slots=True)
class SampledFactory:
    """Builds the evaluation of designs beside samples of people, in whichever process it is called.

    Args:
        name: digest of the problem and of the samples' numbers.
        problems: beside the people of each sample, with what is known of them beforehand.
    """

    name: str
    problems: Mapping[int, tuple[DesignProblem, Precomputed]] = field(compare=False)

    @property
    def limits(self) -> Limits:
        """What one evaluation may cost."""
        return next(iter(self.problems.values()))[0].limits

    def __call__(self) -> Callable[[Sampled], Assessed]:
        """The function from sample and design to results; programs are built by the first evaluation."""
        solvers, latest = SolverCache(), dict[int, Evaluator]()

        def assess(asked: Sampled) -> Assessed:
            sample, values = asked
            if sample not in latest:
                latest.clear()
                latest[sample] = Evaluator(*self.problems[sample], solvers)
            return latest[sample].assess_values(values)

        return assess


def sampled_factory(
    source: ProblemSource, samples: list[int], pool: Pool, progress: PrecomputeProgress = SILENT
) -> SampledFactory:
    """The evaluation of a problem's designs beside samples of people.

    Args:
        source: of the problem.
        samples: their numbers, from 1.
        pool: where what no cache holds is worked out.
        progress: is shown what is worked out.
    """
    values_factory(build_problem(source), pool, progress)  # what all samples have in common
    problems = {sample: build_problem(sampled_source(source, sample)) for sample in samples}
    known = {sample: cached_precomputed(each, pool, progress) for sample, each in problems.items()}
    both = {sample: (each, known[sample]) for sample, each in problems.items()}
    return SampledFactory(digest((source, samples)), both)


def sampled_beside(
    problem: DesignProblem,
    designs: Sequence[tuple[float, ...]],
    jobs: int,
    progress: PrecomputeProgress = SILENT,
) -> tuple[SampledDesign, ...]:
    """Designs beside all samples of people that their problem asks for, evaluated in this process.

    Args:
        problem: that asks for samples.
        designs: one value per parameter each; they are numbered from zero.
        jobs: that work out what is missing.
        progress: is shown what is worked out.
    """
    samples = [*range(1, problem.samples + 1)]
    with make_pool("joblib", jobs, note=progress.note) as pool:
        assess = sampled_factory(problem.source, samples, pool, progress)()
    found = []
    for sample in samples:
        for number, values in enumerate(designs):
            began = time.perf_counter()
            assessment = assess((sample, values)).assessment
            seconds = time.perf_counter() - began
            found.append(SampledDesign(sample=sample, design=number, assessment=assessment, seconds=seconds))
    return tuple(found)
