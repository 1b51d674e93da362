"""What the commands that search share: options over settings, evaluations, and the end of a session."""

from __future__ import annotations

from datetime import datetime
from pathlib import Path
from typing import TypeVar

import msgspec

from evodesign.cli.front import print_front
from evodesign.cli.output import console, print_commands, print_lines, printable, show_notes
from evodesign.cli.progress import precompute_progress
from evodesign.cli.tables.result import chosen_designs, next_commands, result_lines, result_table
from evodesign.pool.base import Pool
from evodesign.problem.evaluate import AssessmentFactory
from evodesign.problem.factory import Remembering, evaluation_factory
from evodesign.records import RunHeader
from evodesign.runlog.run import RunLog
from evodesign.session import Evaluate

__all__ = ["factory_of", "given", "new_directory", "show_result", "with_budgets"]

T = TypeVar("T")


def given(option: T | None, otherwise: T) -> T:
    """An option, or what holds where it is left out."""
    return otherwise if option is None else option


def with_budgets(
    header: RunHeader, evaluations: int | None, hours: float | None, stagnation_generations: int | None
) -> RunHeader:
    """A header with the budgets that options give; no hours are no limit."""
    return msgspec.structs.replace(
        header,
        budget=given(evaluations, header.budget),
        hours=given(hours, header.hours) or None,
        stagnation_generations=given(stagnation_generations, header.stagnation_generations),
    )


def new_directory(name: str) -> Path:
    """Where a new run lies, unless an option says."""
    return Path("runs") / f"{name}-{datetime.now():%Y%m%d-%H%M%S}"


def factory_of(header: RunHeader, pool: Pool, *, cache: bool) -> Evaluate:
    """The evaluation of a header's problem; the pool works out what is missing for it."""
    with precompute_progress() as progress:
        factory = evaluation_factory(header, pool, progress)
    if cache and isinstance(factory, AssessmentFactory):  # a start is no design to know again
        return Remembering(factory)
    return factory


def show_result(run: RunLog, *, json: bool) -> None:
    """A few designs of the front, why the search ended if not for its budget, and what to do next."""
    if len(run.evaluations) < run.header.budget:
        show_notes(
            [
                f"ended after {len(run.evaluations)} of {run.header.budget} evaluations: the hypervolume "
                f"stood still for {run.header.stagnation_generations} generations; to go on all the same: "
                f"evodesign resume {run.directory} --stagnation-generations 0"
            ]
        )
    if json:
        print_front(run, json=True)
        return
    chosen = chosen_designs(run.header.objectives, run.evaluations)
    if chosen:
        console().print(result_table(run, chosen))
    print_lines(*map(printable, result_lines(run, chosen)), "go on with:")
    print_commands(*next_commands(run, chosen))
