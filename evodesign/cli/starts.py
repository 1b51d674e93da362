"""`starts`: the start portfolios of a problem, and how well they serve other designs."""

from __future__ import annotations

from evodesign.cli.options import CORES, Jobs, Json, ProblemPath


def starts(problem: ProblemPath, jobs: Jobs = CORES, json: Json = False) -> None:
    """The starts from which a problem is solved, and how well they serve other designs."""
    from evodesign.cli.output import console, print_json
    from evodesign.cli.progress import precompute_progress
    from evodesign.cli.tables.problem import starts_json, starts_table
    from evodesign.evaluation.factory import cached_precomputed
    from evodesign.pool.registry import make_pool
    from evodesign.problem.build import build_problem
    from evodesign.problem.source import read_source

    built = build_problem(read_source(problem))
    with precompute_progress() as progress, make_pool("joblib", jobs, note=progress.note) as pool:
        known = cached_precomputed(built, pool, progress)
    if json:
        print_json(starts_json(built, known))
        return
    console().print(starts_table(built, known))
