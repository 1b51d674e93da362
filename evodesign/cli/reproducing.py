"""`reproduce`: the paper's experiment again, by gradients and by evolution, held against its claims."""

from __future__ import annotations

import time
from contextlib import AbstractContextManager
from datetime import datetime
from pathlib import Path

from evodesign.cli.making import making
from evodesign.cli.output import console, counted, figure, print_json, show_notes
from evodesign.cli.progress import observer
from evodesign.cli.tables.reproduction import claims_table, reasons, torque_table
from evodesign.errors import InputError
from evodesign.problem.build import Problem, build_problem
from evodesign.problem.progress import PrecomputeProgress
from evodesign.problem.source import read_source
from evodesign.report.export.folder import refuse_full
from evodesign.report.reproduction import Reproduction, reproduction_json, write_reproduction
from evodesign.reproduction import Effort, Experiment, reproduction
from evodesign.runlog.observer import Observer

__all__ = ["reproduce_paper"]


def reproduce_paper(problem: Path, published: Path, to: Path | None, effort: Effort, json: bool) -> None:
    """Run the experiment, write its files, and print tables and verdicts.

    Args:
        problem: file of the problem with physical limits.
        published: file of the published setting.
        to: a new or empty folder.
        effort: how much is computed.
        json: print JSON instead of tables.
    """
    began = time.monotonic()
    directory = Path("runs") / f"reproduce-{datetime.now():%Y%m%d-%H%M%S}" if to is None else to
    refuse_full(directory)
    with_limits, without = _scalar(problem), _scalar(published)
    done = reproduction(Experiment(with_limits, directory, effort, began, _Progress()), without)
    compared = (done.original, *(one.robot for one in done.found))
    files = write_reproduction(directory, compared, (done.published.original, done.published.optimised))
    seconds = time.monotonic() - began
    if json:
        print_json(reproduction_json(done, directory, files, seconds))
        return
    out = console()
    out.print(torque_table(done))
    out.print(claims_table(done.claims))
    for line in (*reasons(done.claims), *_remarks(done, directory, seconds)):
        out.print(line, highlight=False, markup=False, soft_wrap=True)


class _Progress:
    """Everything on standard error."""

    def note(self, sentence: str) -> None:
        """What begins, or ended early."""
        show_notes([sentence])

    def precompute(self) -> AbstractContextManager[PrecomputeProgress]:
        """Of what a problem needs before its first evaluation."""
        return making()

    def search(self) -> AbstractContextManager[Observer]:
        """Of a logged run."""
        return observer()


def _scalar(path: Path) -> Problem:
    """A problem with one objective, so that one robot is the best."""
    problem = build_problem(read_source(path))
    if len(problem.objectives) != 1:
        raise InputError(str(path), "objectives", "one objective to reproduce", f"{len(problem.objectives)}")
    return problem


def _remarks(done: Reproduction, directory: Path, seconds: float) -> list[str]:
    published = done.published
    lines = [
        f"published setting: starts {counted(published.statuses)}; largest difference of a torque from the "
        f"paper's formula {published.difference:.1e} N m",
        f"the original robot holds loads up to {figure(done.highest)} m",
    ]
    lines += [
        f"{one.robot.name}: least cost {figure(one.cost)}; {len(one.run.evaluations)} evaluations, "
        f"{counted(one.statuses)}; the run lies in {one.run.directory}"
        for one in done.found
    ]
    return [*lines, f"figures and robots lie in {directory}; {seconds / 60.0:.1f} min"]
