"""`search` and `resume`: the loop with its pool, its log and someone who watches."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import datetime
from functools import partial
from pathlib import Path
from types import FrameType
from typing import NoReturn

from evodesign import evolve
from evodesign.cli.fronts import show_run
from evodesign.cli.header import header_of, renewed
from evodesign.cli.output import show_notes
from evodesign.cli.progress import observer
from evodesign.cli.ready import problem_factory
from evodesign.errors import Interrupted
from evodesign.pool.registry import make_pool
from evodesign.problem.build import build_problem
from evodesign.problem.notes import notes
from evodesign.problem.source import read_source
from evodesign.runlog.directory import name_in_path, refuse_run, segments
from evodesign.search.registry import make_search

__all__ = ["Wishes", "go_on", "start"]


@dataclass(frozen=True, slots=True)
class Wishes:
    """What the command line says about a search; None leaves it to the problem file."""

    algorithm: str | None
    evaluations: int | None
    population: int | None
    seed: int | None
    symmetry: str | None


def start(path: Path, run: Path | None, wishes: Wishes, jobs: int, pool: str, json: bool) -> None:
    """Search a problem in a new run directory and print the front."""
    problem = build_problem(read_source(path, wishes.symmetry))
    show_notes(notes(problem))
    table = problem.search
    settings = problem.settings(
        table.algorithm if wishes.algorithm is None else wishes.algorithm,
        table.population if wishes.population is None else wishes.population,
        table.seed if wishes.seed is None else wishes.seed,
    )
    budget = table.evaluations if wishes.evaluations is None else wishes.evaluations
    header = header_of(problem, settings, budget)
    own = Path("runs") / f"{name_in_path(problem.name)}-{datetime.now():%Y%m%d-%H%M%S}"
    directory = own if run is None else run
    refuse_run(directory)  # before anything takes time; the search's settings too
    make_search(settings)
    _stop_on_terminate()
    with _resumable(directory), make_pool(pool, jobs) as workers:
        factory = problem_factory(header, workers)
        with observer() as watching:
            done = evolve.start(directory, header, factory, workers, watching)
    show_run(done, json)


def go_on(run: Path, evaluations: int | None, jobs: int, pool: str, json: bool) -> None:
    """Resume a run and print the front."""
    _stop_on_terminate()
    with _resumable(run), make_pool(pool, jobs) as workers, observer() as watching:
        ready = partial(problem_factory, pool=workers)
        done = evolve.resume(run, ready, workers, watching, evaluations, renew=renewed)
    show_run(done, json)


@contextmanager
def _resumable(directory: Path) -> Iterator[None]:
    """Turn a stop into an error that says how to go on, also one before or after the loop itself."""
    try:
        yield
    except KeyboardInterrupt:
        hint = f"; go on with: evodesign resume {directory}" if segments(directory) else ""
        raise Interrupted(f"stopped{hint}") from None


def _stop_on_terminate() -> None:
    """Let SIGTERM end a search as Ctrl-C does: logged, and resumable."""

    def stop(signum: int, frame: FrameType | None) -> NoReturn:
        raise KeyboardInterrupt

    signal.signal(signal.SIGTERM, stop)
