"""`baseline`: the paper's joint problem from many starts, logged as a run like any other."""

from __future__ import annotations

from collections import Counter
from datetime import datetime
from pathlib import Path

from evodesign.cli.output import console, counted
from evodesign.cli.searching import Budgets, Wishes, Workers, start
from evodesign.problem.baseline import GENERATION, refuse_unsuited
from evodesign.problem.build import build_problem
from evodesign.problem.source import read_source
from evodesign.runlog.directory import name_in_path
from evodesign.runlog.run import read_run
from evodesign.search.base import JOINT_STARTS

__all__ = ["start_baseline"]


def start_baseline(
    problem: Path, run: Path | None, starts: int, seed: int | None, jobs: int, pool: str, json: bool
) -> None:
    """Solve the joint problem from many starts; print its front, and how the starts ended."""
    built = build_problem(read_source(problem))
    refuse_unsuited(built)
    name = name_in_path(built.name)
    directory = Path("runs") / f"{name}-baseline-{datetime.now():%Y%m%d-%H%M%S}" if run is None else run
    wishes = Wishes(JOINT_STARTS, min(starts, GENERATION), seed, asynchronous=False)
    budgets = Budgets(starts, hours=None, stagnation_generations=0)
    workers = Workers(pool, jobs, scheduler=None, cache=False)
    start(problem, directory, wishes, budgets, workers, None, json)
    if json:
        return
    ended = Counter(evaluation.assessment.status for evaluation in read_run(directory).evaluations)
    console().print(f"how the {sum(ended.values())} starts ended: {counted(ended)}", highlight=False)
