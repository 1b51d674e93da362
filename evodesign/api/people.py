"""Designs of a run beside people drawn from the distribution of measured ones.

All designs are evaluated beside the same people. What has been evaluated is on the disk before the next
evaluation is looked at, and is never evaluated again.
"""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from statistics import median

import msgspec

from evodesign.analysis.decision_making import most_different
from evodesign.analysis.front import front
from evodesign.errors import InputError
from evodesign.evaluation.progress import in_words
from evodesign.evaluation.sampled_designs import SampledFactory, sampled_factory
from evodesign.identity import digest
from evodesign.pool.base import Pool
from evodesign.pool.dispatch import run_stoppable
from evodesign.problem.build import DesignProblem
from evodesign.problem.designs import alike
from evodesign.problem.samples import refuse_unsampled
from evodesign.records import SampledDesign, SampledPeople
from evodesign.runlog.directory import locked
from evodesign.runlog.header import version_differences, versions
from evodesign.runlog.run import RunLog
from evodesign.runlog.sampled_file import read_sampled, write_sampled
from evodesign.session import Display, evaluation_outcome

MOST_DESIGNS = 20
"""Designs of a front that are evaluated where nobody says which: its most different ones."""


def usual_designs(run: RunLog) -> tuple[int, ...]:
    """Numbers of the front's designs, of a large one the most different ones."""
    best = front(run.header.objectives, run.evaluations)
    few = best if len(best) <= MOST_DESIGNS else most_different(best, MOST_DESIGNS)
    return tuple(sorted(each.number for each in few))


def usual_reference(problem: DesignProblem, run: RunLog) -> int | None:
    """Number of the unscaled robot in a run; None where the run has it not."""
    wanted = problem.space.named(problem.space.unscaled(problem.scene.designed_tree))
    designs = ((each.number, each.assessment.design) for each in run.evaluations)
    return next((n for n, own in designs if alike((own[name] for name in wanted), wanted.values())), None)


def draw_people(
    run: RunLog,
    samples: int,
    designs: Sequence[int],
    reference: int | None,
    pool: Pool,
    display: Display,
    stop: Callable[[], bool],
) -> SampledPeople:
    """Evaluate designs of a run beside samples of people, as far as that has not been done.

    Designs that were evaluated beside some of the samples before are so beside the others, too: all compare.

    Args:
        run: that has the designs.
        samples: how many.
        designs: numbers of evaluations.
        reference: number of the one that others are compared with; None for none.
        pool: where evaluations run.
        display: shows what is done.
        stop: asked whether no further evaluation is to begin.
    Raises:
        InputError: a number that the run has not, or people who cannot be drawn.
        RunError: another process writes the run, or the file cannot be written.
        KeyboardInterrupt: stopped; what had arrived is kept.
    """
    refuse_unsampled(run.header.problem)
    known = {each.number for each in run.evaluations}
    asked = (*designs, *(() if reference is None else (reference,)))
    for number in asked:
        if number not in known:
            raise InputError(
                "DESIGNS", "", f"designs of {run.directory}, which has {len(known)}", f"{number}"
            )
    with locked(run.directory):
        kept = msgspec.structs.replace(_kept(run, display), samples=samples, reference=reference)
        write_sampled(run, kept)
        numbers = [*dict.fromkeys((*asked, *(each.design for each in kept.designs)))]
        done = {(each.sample, each.design) for each in kept.designs}
        missing = [
            (sample, number)
            for sample in range(1, samples + 1)
            for number in numbers
            if (sample, number) not in done
        ]
        if missing:
            display.note(_cost(run, samples, len(numbers), len(missing), pool.processes))
            with display.precompute() as progress:
                drawn = sorted({sample for sample, _ in missing})
                factory = sampled_factory(run.header.problem, drawn, pool, progress)
            left, began = Counter(sample for sample, _ in missing), time.monotonic()
            for found in _evaluated(run, factory, missing, pool, stop):
                kept = msgspec.structs.replace(kept, designs=(*kept.designs, found))
                write_sampled(run, kept)
                left[found.sample] -= 1
                if left.total() and not left[found.sample]:
                    pace = (time.monotonic() - began) / (len(missing) - left.total())
                    time_left = in_words(pace * left.total())
                    display.note(f"all designs beside sample {found.sample} of {samples}: {time_left}")
    return kept


def _evaluated(
    run: RunLog,
    factory: SampledFactory,
    asked: Sequence[tuple[int, int]],
    pool: Pool,
    stop: Callable[[], bool],
) -> Iterator[SampledDesign]:
    """Designs of a run beside samples of people, as they arrive."""
    parameters, arrived = run.header.parameters, 0
    designs = {number: run.evaluation(number) for _, number in asked}
    arguments = [
        (sample, factory.problems[sample][0].space.values_of(designs[number].assessment.design))
        for sample, number in asked
    ]
    with closing(run_stoppable(pool, factory, arguments, stop)) as results:
        for finished in results:
            sample, number = asked[finished.index]
            own, arrived = designs[number], arrived + 1
            outcome = evaluation_outcome(number, 0, own.genome, parameters, finished)
            assessment = msgspec.structs.replace(outcome.evaluation.assessment, design=own.assessment.design)
            yield SampledDesign(sample=sample, design=number, assessment=assessment, seconds=finished.seconds)
    if arrived < len(asked):
        raise KeyboardInterrupt


def _kept(run: RunLog, display: Display) -> SampledPeople:
    """What is kept of a run's samples, by the same versions of packages; nothing to begin with."""
    found, notes = read_sampled(run)
    for note in notes:
        display.note(note)
    if found is not None and (differing := version_differences(found.versions, versions())):
        display.note(f"samples of people of {', '.join(differing)} are drawn again")
        found = None
    empty = SampledPeople(
        problem=digest(run.header.problem), versions=versions(), samples=0, reference=None, designs=()
    )
    return found or empty


def _cost(run: RunLog, samples: int, designs: int, left: int, processes: int) -> str:
    """What it takes, by the times of the run's evaluations without their gradients."""
    each = median(one.seconds - one.gradient_seconds for one in run.evaluations)
    time_left = in_words(left * each / processes)
    what = f"{designs} designs beside {samples} samples of people: {left} evaluations"
    return f"{what}, {time_left} at the pace of the run's"
