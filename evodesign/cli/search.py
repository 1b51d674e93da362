"""`search`: the designs of a problem, searched in a run of its own."""

from __future__ import annotations

from typing import Annotated

import typer

from evodesign.cli import options

__all__ = ["search"]


def search(
    problem: options.ProblemPath,
    run: options.NewRun = None,
    algorithm: options.Algorithm = None,
    evaluations: options.Evaluations = None,
    hours: options.Hours = None,
    stagnation_generations: options.Stagnation = None,
    population: options.PopulationSize = None,
    seed: options.Seed = None,
    asynchronous: Annotated[
        bool | None,
        typer.Option(
            "--asynchronous/--generations",
            help="Whether no worker waits for the slowest of a generation.",
            show_default="as in the problem",
        ),
    ] = None,
    symmetry: options.SymmetryName = None,
    jobs: options.Jobs = options.CORES,
    pool: options.PoolName = "joblib",
    scheduler: options.Scheduler = None,
    cache: options.UseCache = False,
    json: options.Json = False,
) -> None:
    """Search a problem's designs; every evaluation is logged, and the search can be stopped and resumed."""
    from msgspec.structs import replace

    from evodesign import evolve
    from evodesign.cli.output import show_notes
    from evodesign.cli.progress import search_progress
    from evodesign.cli.session import factory_of, given, new_directory, show_result, with_budgets
    from evodesign.cli.stopping import Stop, resumable
    from evodesign.pool.registry import make_pool
    from evodesign.problem.build import build_problem
    from evodesign.problem.notes import notes
    from evodesign.problem.source import read_source
    from evodesign.runlog.directory import name_in_path, refuse_run
    from evodesign.runlog.header import header_of
    from evodesign.search.registry import make_asynchronous_search, make_search

    built = build_problem(read_source(problem, symmetry))
    show_notes(notes(built))
    table = built.search
    settings = built.settings(
        given(algorithm, table.algorithm),
        given(population, table.population),
        given(seed, table.seed),
        given(asynchronous, table.asynchronous),
    )
    header = header_of(built, settings, table.evaluations)
    header = replace(header, hours=table.hours, stagnation_generations=table.stagnation_generations)
    header = with_budgets(header, evaluations, hours, stagnation_generations)
    directory = new_directory(name_in_path(built.name)) if run is None else run
    refuse_run(directory)  # before anything takes time; the search's settings too
    (make_asynchronous_search if settings.asynchronous else make_search)(settings)
    stop = Stop(header.hours)
    with resumable(directory, stop), make_pool(pool, jobs, scheduler) as workers:
        factory = factory_of(header, workers, cache=cache)
        with search_progress() as observer, stop.heeded():
            done = evolve.start(directory, header, factory, workers, observer, stop=stop)
    show_result(done, json=json)
