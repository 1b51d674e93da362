"""`lift`: a design lifts the load with a person, in time."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from evodesign.cli import options
from evodesign.cli.evaluate import chosen_design


def lift(
    problem: options.ProblemPath,
    begin: Annotated[float, typer.Option("--from", metavar="M", help="Height of the load at the start [m].")],
    end: Annotated[float, typer.Option("--to", metavar="M", help="Height at the end [m].")],
    design: options.DesignsFile = None,
    name: options.DesignName = None,
    seconds: Annotated[float, typer.Option(metavar="S", help="Time that the lift takes [s].")] = 1.5,
    profile: options.ProfileName = "minimum_jerk",
    knots: options.Knots = 12,
    csv: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write joints and torques over time.")
    ] = None,
    symmetry: options.SymmetryName = None,
    jobs: options.Jobs = options.CORES,
    json: options.Json = False,
) -> None:
    """A design and a person lift the load: torques over time, energy, power, residuals.

    Exit code 5: no lift is solved.
    """
    from evodesign.cli.output import console, print_json, show_notes, write_text
    from evodesign.cli.progress import precompute_progress
    from evodesign.cli.tables.simulation import lift_tables
    from evodesign.evaluation.factory import evaluator_of
    from evodesign.evaluation.lift_json import lift_csv, lift_json
    from evodesign.evaluation.lifts import Lifts
    from evodesign.problem.build import build_problem
    from evodesign.problem.notes import notes
    from evodesign.problem.source import read_source
    from evodesign.tasks.lift import Lift, profile_named

    asked = Lift(begin, end, seconds, profile_named(profile), knots)
    built = build_problem(read_source(problem, symmetry))
    show_notes(notes(built))
    chosen, values = chosen_design(built, design, name)
    with precompute_progress() as progress:
        evaluator = evaluator_of(built, jobs, progress, [asked])
    solutions = Lifts(evaluator, evaluator.known).solve(values, asked)
    if csv is not None:
        write_text(csv, lift_csv(solutions), "--csv")
    if json:
        print_json(lift_json(solutions))
    else:
        for table in lift_tables(f"{built.name}: {chosen}", solutions):
            console().print(table)
    if not any(each.solved for each in solutions.values()):
        raise typer.Exit(options.NOTHING_SOLVED)
