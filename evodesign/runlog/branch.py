"""A new run that begins with the first generations of another one.

The new run's log holds them as its own, so that it stands by itself, is resumed by replay like any other, and
solves nothing twice. What the search was for those generations is kept in its settings as a stage.
"""

from __future__ import annotations

from pathlib import Path

import msgspec

from evodesign.errors import InputError
from evodesign.records import SearchSettings, SearchStage
from evodesign.runlog.directory import locked, make_directory
from evodesign.runlog.run import Run
from evodesign.runlog.writer import RunWriter

__all__ = ["begin_branch"]


def begin_branch(old: Run, directory: Path, generations: int, settings: SearchSettings) -> int:
    """Write the beginning of a branch.

    Args:
        old: the run to leave.
        directory: of the new run; made when missing.
        generations: how many generations the new run takes over.
        settings: of the search from there on. If they are the old run's, the new run goes its way again.
    Returns:
        How many evaluations were taken over.
    Raises:
        InputError: the old run has not so many generations, or the population is larger than the past.
        RunError: the directory holds a run already, or cannot be written.
    """
    if old.header.search.asynchronous:
        raise InputError("--branch-from", "", "a run with generations", f"the asynchronous {old.directory}")
    count = _evaluations_of(old, generations)
    if settings.population > count:
        raise InputError(
            "--population", "", f"at most {count}, the evaluations taken over", str(settings.population)
        )
    search = _with_past(old.header.search, generations, settings)
    make_directory(directory)
    header = msgspec.structs.replace(old.header, search=search)
    with locked(directory), RunWriter(directory, header) as log:
        for detail in old.details:
            if detail.evaluation < count:
                log.detail(detail)
        for evaluation in old.evaluations[:count]:
            log.evaluation(evaluation)
        for generation in old.generations[:generations]:
            log.generation(generation)
        for front in old.fronts[:generations]:
            log.front(front)
        log.commit()
    return count


def _evaluations_of(old: Run, generations: int) -> int:
    """Evaluations of the first generations, all of which must be there."""
    whole = 0
    for number, (generation, front) in enumerate(zip(old.generations, old.fronts, strict=False)):
        known = len(old.evaluations) >= generation.evaluations
        if generation.number != number or front.generation != number or not known:
            break
        if old.evaluations[generation.evaluations - 1].number != generation.evaluations - 1:
            break
        whole = number + 1
    if generations > whole:
        wanted = f"at most {whole}, the whole generations of {old.directory}"
        raise InputError("--branch-from", "", wanted, str(generations))
    return old.generations[generations - 1].evaluations


def _with_past(before: SearchSettings, generations: int, after: SearchSettings) -> SearchSettings:
    """The settings after a turn, with the settings before as their last stage."""
    if after == before:
        return before
    stages = []
    left = generations
    for stage in before.past:
        stages.append(msgspec.structs.replace(stage, generations=min(stage.generations, left)))
        left -= stages[-1].generations
        if left == 0:
            break
    if left > 0:
        stages.append(
            SearchStage(
                algorithm=before.algorithm, population=before.population, seed=before.seed, generations=left
            )
        )
    return msgspec.structs.replace(after, past=tuple(stages))
