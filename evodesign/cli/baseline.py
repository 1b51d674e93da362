"""`baseline`: the paper's joint problem from many starts, logged as a run like any other."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Annotated

import typer

from evodesign.cli.options import CORES, Jobs, Json, PoolName, ProblemPath
from evodesign.cli.search import search


def baseline(
    problem: ProblemPath,
    starts: Annotated[int, typer.Option(min=1, metavar="N", help="How many starts.")] = 50,
    seed: Annotated[
        int | None,
        typer.Option(min=0, metavar="N", help="Random seed of the starts.", show_default="as in the problem"),
    ] = None,
    run: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="Directory of the new run.", show_default="in runs/"),
    ] = None,
    jobs: Jobs = CORES,
    pool: PoolName = "joblib",
    json: Json = False,
) -> None:
    """The paper's way: postures at all heights and the design in one program, from many starts."""
    from evodesign.analysis.failures import causes
    from evodesign.api.sessions import new_directory
    from evodesign.cli.output import print_lines
    from evodesign.evaluation.baseline import GENERATION, refuse_unsuited
    from evodesign.problem.build import build_problem
    from evodesign.problem.source import read_source
    from evodesign.runlog.run import read_run
    from evodesign.searches.base import JOINT_STARTS

    built = build_problem(read_source(problem))
    refuse_unsuited(built)
    directory = new_directory(f"{built.name}-baseline") if run is None else run
    search(
        problem,
        directory,
        JOINT_STARTS,
        starts,
        stagnation_generations=0,
        population=min(starts, GENERATION),
        seed=seed,
        asynchronous=False,
        jobs=jobs,
        pool=pool,
        json=json,
    )
    if not json:
        ended = Counter(evaluation.assessment.status for evaluation in read_run(directory).evaluations)
        print_lines(f"how the {sum(ended.values())} starts ended: {causes(ended)}")
