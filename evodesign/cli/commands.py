"""The commands' names, arguments and options.

What a command needs is imported when it is called: showing a front must not wait for CasADi to load.
"""

from __future__ import annotations

import math
import os
from pathlib import Path
from typing import Annotated

import typer

__all__ = ["COMMANDS"]

ProblemPath = Annotated[Path, typer.Argument(metavar="PROBLEM", help="Problem file (TOML).")]
RunPath = Annotated[Path, typer.Argument(metavar="RUN", help="Directory of a run.")]
Design = Annotated[int, typer.Argument(metavar="DESIGN", min=0, help="Number of an evaluation of the run.")]
Json = Annotated[bool, typer.Option("--json", help="Print JSON instead of tables.")]
SymmetryName = Annotated[
    str | None,
    typer.Option("--symmetry", help="Postures: on, off or polish.", show_default="as in the problem"),
]
Evaluations = Annotated[
    int | None, typer.Option(min=1, help="Total evaluations of the run.", show_default="as in the problem")
]
Hours = Annotated[
    float | None,
    typer.Option(
        help="Wall time of a session; then it stops, resumable. 0 for no limit.", show_default="no limit"
    ),
]
Stagnation = Annotated[
    int | None,
    typer.Option(
        min=0,
        metavar="N",
        help="End when the hypervolume has grown by less than 0.1 % in N generations; 0 for never.",
        show_default="never",
    ),
]
Algorithm = Annotated[
    str | None, typer.Option(help="nsga2, cma-es or random.", show_default="as in the problem")
]
PopulationSize = Annotated[
    int | None, typer.Option(min=2, help="Evaluations of a generation.", show_default="as in the problem")
]
Seed = Annotated[int | None, typer.Option(min=0, help="Of the search.", show_default="as in the problem")]
Jobs = Annotated[int, typer.Option(min=1, help="Evaluations that run at the same time.")]
PoolName = Annotated[str, typer.Option("--pool", help="Where evaluations run: serial, joblib or dask.")]
Scheduler = Annotated[
    str | None,
    typer.Option(
        metavar="ADDRESS", help="Of the Dask scheduler for --pool dask, such as tcp://127.0.0.1:8786."
    ),
]
UseCache = Annotated[
    bool, typer.Option("--cache", help="Look up designs that were evaluated before, and keep new ones.")
]

CORES = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def checked_hours(hours: float | None) -> float | None:
    """The hours given, if any.

    Raises:
        typer.BadParameter: a negative number, or none.
    """
    if hours is not None and not 0.0 <= hours < math.inf:
        raise typer.BadParameter(f"wanted a number of hours from 0, found {hours:g}", param_hint="--hours")
    return hours


def search(
    problem: ProblemPath,
    run: Annotated[
        Path | None, typer.Option(help="Directory of the new run.", show_default="runs/NAME-TIME")
    ] = None,
    algorithm: Algorithm = None,
    evaluations: Evaluations = None,
    hours: Hours = None,
    stagnation_generations: Stagnation = None,
    population: PopulationSize = None,
    seed: Seed = None,
    asynchronous: Annotated[
        bool | None,
        typer.Option(
            "--asynchronous/--generations",
            help="Whether no worker waits for the slowest of a generation.",
            show_default="as in the problem",
        ),
    ] = None,
    symmetry: SymmetryName = None,
    jobs: Jobs = CORES,
    pool: PoolName = "joblib",
    scheduler: Scheduler = None,
    cache: UseCache = False,
    json: Json = False,
) -> None:
    """Search a problem's designs; every evaluation is logged, and the search can be stopped and resumed."""
    from evodesign.cli.searching import Budgets, Wishes, Workers, start

    budgets = Budgets(evaluations, checked_hours(hours), stagnation_generations)
    wishes = Wishes(algorithm, population, seed, asynchronous)
    start(problem, run, wishes, budgets, Workers(pool, jobs, scheduler, cache), symmetry, json)


def resume(
    run: RunPath,
    evaluations: Evaluations = None,
    hours: Hours = None,
    stagnation_generations: Stagnation = None,
    jobs: Jobs = CORES,
    pool: PoolName = "joblib",
    scheduler: Scheduler = None,
    cache: UseCache = False,
    accept_versions: Annotated[
        bool, typer.Option("--accept-versions", help="Go on although packages have other versions.")
    ] = False,
    json: Json = False,
) -> None:
    """Go on with a run that was stopped or killed, or give a finished one a larger budget."""
    from evodesign.cli.searching import Budgets, Workers, go_on

    budgets = Budgets(evaluations, checked_hours(hours), stagnation_generations)
    go_on(run, budgets, Workers(pool, jobs, scheduler, cache), accept_versions, json)


def branch(
    run: RunPath,
    branch_from: Annotated[
        int, typer.Option(min=1, metavar="GENERATION", help="How many generations the new run takes over.")
    ],
    to: Annotated[
        Path | None,
        typer.Option("--run", help="Directory of the new run.", show_default="runs/NAME-TIME"),
    ] = None,
    algorithm: Algorithm = None,
    evaluations: Evaluations = None,
    hours: Hours = None,
    stagnation_generations: Stagnation = None,
    population: PopulationSize = None,
    seed: Seed = None,
    jobs: Jobs = CORES,
    pool: PoolName = "joblib",
    scheduler: Scheduler = None,
    cache: UseCache = False,
    json: Json = False,
) -> None:
    """Begin a new run with the first generations of another, and go on with another seed or search."""
    from evodesign.cli.searching import BranchPoint, Budgets, Wishes, Workers
    from evodesign.cli.searching import branch as begin

    budgets = Budgets(evaluations, checked_hours(hours), stagnation_generations)
    workers = Workers(pool, jobs, scheduler, cache)
    begin(
        run, BranchPoint(branch_from, to), Wishes(algorithm, population, seed, None), budgets, workers, json
    )


def front(
    run: RunPath,
    knee: Annotated[
        bool, typer.Option("--knee", help="Only where every exchange near by loses more than it gains.")
    ] = False,
    near: Annotated[
        str | None,
        typer.Option(metavar="NAME=NUMBER,...", help="Closest first to these values of objectives."),
    ] = None,
    different: Annotated[
        bool, typer.Option("--different", help="The most different designs, 10 unless --limit says.")
    ] = False,
    where: Annotated[
        list[str] | None,
        typer.Option(
            metavar="CONDITION",
            help="Only designs such as 'reach_height >= 1.5 and robot_torque@1.2 < 10'.",
        ),
    ] = None,
    limit: Annotated[int | None, typer.Option(min=1, help="At most so many.", show_default="all")] = None,
    csv: Annotated[bool, typer.Option("--csv", help="Print CSV instead of tables.")] = False,
    json: Json = False,
    plot: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Also write a figure of the front (HTML).")
    ] = None,
) -> None:
    """The designs of a run that no other design beats in every objective, or a choice of them."""
    from evodesign.cli.fronts import Picking, Printing, show

    show(run, Picking(knee, different, near, where or (), limit), Printing(json, csv, plot))


def watch(
    run: RunPath,
    serve: Annotated[
        bool, typer.Option("--serve", help="On a local page that refreshes itself, for this machine alone.")
    ] = False,
    port: Annotated[int, typer.Option(min=0, max=65535, help="Of the page; 0 for any free one.")] = 8765,
    every: Annotated[float, typer.Option(min=0.1, help="Seconds between two looks.")] = 1.0,
    once: Annotated[bool, typer.Option("--once", help="Show the present state and leave.")] = False,
    json: Annotated[bool, typer.Option("--json", help="Print the present state as JSON and leave.")] = False,
) -> None:
    """Follow a running search; Ctrl-C leaves, and the search goes on."""
    from evodesign.cli.watching import watch as follow

    follow(run, every=every, serve=serve, port=port, once=once, json=json)


def compare(
    runs: Annotated[list[Path], typer.Argument(metavar="RUN RUN...", help="Directories of runs.")],
    json: Json = False,
    plot: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Also write a figure of the comparison (HTML).")
    ] = None,
) -> None:
    """Several runs side by side: hypervolumes, rank tests over seeds, the best designs of all."""
    from evodesign.cli.comparing import compare_runs

    compare_runs(runs, json, plot)


def show(
    run: RunPath,
    design: Design,
    jobs: Jobs = CORES,
    json: Json = False,
    plot: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="Also write figures of its torques and postures (SVG and PNG)."),
    ] = None,
) -> None:
    """One design of a run: objectives, parameters, torques, contact forces."""
    from evodesign.cli.showing import show_design

    show_design(run, design, jobs, json, plot)


def export(
    run: RunPath,
    design: Design,
    to: Annotated[Path, typer.Option(metavar="DIR", help="A new or empty folder.")],
    jobs: Jobs = CORES,
) -> None:
    """One design of a run as files: URDF, MJCF, postures, and a replay for Foxglove and Lichtblick."""
    from evodesign.cli.exporting import export_run_design

    export_run_design(run, design, to, jobs)


def evaluate(
    problem: ProblemPath,
    design: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="File of named designs.", show_default="the unscaled robot"),
    ] = None,
    name: Annotated[
        str | None,
        typer.Option(help="Which design of the file.", show_default="the file's only one"),
    ] = None,
    symmetry: SymmetryName = None,
    jobs: Jobs = CORES,
    json: Json = False,
) -> None:
    """One design in full: reach, postures, torques, wrenches, residuals."""
    from evodesign.cli.designs import evaluate_design

    evaluate_design(problem, design, name, symmetry, jobs, json)


def polish(
    run: RunPath,
    design: Annotated[int, typer.Argument(min=0, metavar="DESIGN", help="Number of a design of the run.")],
    objective: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="What is to get better.", show_default="all, none getting worse"),
    ] = None,
    weights: Annotated[
        str | None,
        typer.Option(
            metavar="NAME=NUMBER,...", help="Several objectives, weighted relative to their values."
        ),
    ] = None,
    evaluations: Annotated[int, typer.Option(min=2, help="Designs that may be evaluated.")] = 60,
    to: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="New file of designs.", show_default="RUN/polished-DESIGN.toml"),
    ] = None,
    jobs: Jobs = CORES,
    json: Json = False,
) -> None:
    """Improve one design of a run by going downhill on its exact gradients; never returns a worse one."""
    from evodesign.cli.polishing import polish_design

    polish_design(run, design, objective, weights, evaluations, to, jobs, json)


def check(problem: ProblemPath, json: Json = False) -> None:
    """Read a problem and show what was understood: agents, load, task, and what each parameter changes."""
    from evodesign.cli.designs import check_problem

    check_problem(problem, json)


def baseline(
    problem: ProblemPath,
    starts: Annotated[int, typer.Option(min=1, help="How many starts.")] = 50,
    seed: Annotated[
        int | None, typer.Option(min=0, help="Of the starts.", show_default="as in the problem")
    ] = None,
    run: Annotated[
        Path | None, typer.Option(help="Directory of the new run.", show_default="runs/NAME-baseline-TIME")
    ] = None,
    jobs: Jobs = CORES,
    pool: PoolName = "joblib",
    json: Json = False,
) -> None:
    """The paper's way: postures at all heights and the design in one program, from many starts."""
    from evodesign.cli.baseline import start_baseline

    start_baseline(problem, run, starts, seed, jobs, pool, json)


def reproduce(
    to: Annotated[
        Path | None,
        typer.Option(help="New folder for runs, figures and robots.", show_default="runs/reproduce-TIME"),
    ] = None,
    problem: Annotated[Path, typer.Option(metavar="FILE", help="The problem with physical limits.")] = Path(
        "problems/sartore2022.toml"
    ),
    published: Annotated[
        Path, typer.Option(metavar="FILE", help="The published setting, without limits.")
    ] = Path("problems/sartore2022_as_published.toml"),
    starts: Annotated[int, typer.Option(min=1, help="Starts of the joint problem.")] = 50,
    evaluations: Annotated[int, typer.Option(min=1, help="Designs that the search evaluates.")] = 480,
    seed: Annotated[int, typer.Option(min=0, help="Of starts and search.")] = 1,
    minutes: Annotated[
        float, typer.Option(min=0.1, help="After which both have ended, with what they have by then.")
    ] = 12.0,
    jobs: Jobs = CORES,
    pool: PoolName = "joblib",
    json: Json = False,
) -> None:
    """Sartore et al. 2022 again: its table, claims and figures, with verdicts, then by evolution."""
    from evodesign.cli.reproducing import reproduce_paper
    from evodesign.reproduction import Effort

    reproduce_paper(problem, published, to, Effort(starts, evaluations, seed, minutes, jobs, pool), json)


def report(
    run: RunPath,
    output: Annotated[
        Path | None, typer.Option(metavar="FILE", help="The page.", show_default="RUN/report.html")
    ] = None,
    designs: Annotated[
        str, typer.Option(metavar="NUMBERS", help="Designs to mark and to show postures of, such as 12,53.")
    ] = "",
    sensitivities: Annotated[
        bool,
        typer.Option(
            "--sensitivities", help="Also how the marked designs' objectives move; solves these designs anew."
        ),
    ] = False,
    jobs: Jobs = CORES,
) -> None:
    """Write the page of a run: front, parameters, progress, failures, postures; one file, no network."""
    from evodesign.cli.reports import write_report

    write_report(run, output, designs, sensitivities, jobs)


def seeds(problem: ProblemPath, jobs: Jobs = CORES, json: Json = False) -> None:
    """What a problem is solved from: its seeds, and how well they lead other designs."""
    from evodesign.cli.seeding import show_seeds

    show_seeds(problem, jobs, json)


def verify(run: RunPath, json: Json = False) -> None:
    """Check a run: every checksum and record, their order, what follows from them, and the replay."""
    from evodesign.cli.files import verify_run

    verify_run(run, json)


def recover(
    run: RunPath,
    to: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Directory to write.", show_default="RUN-recovered")
    ] = None,
    json: Json = False,
) -> None:
    """Write all that can be read of a damaged run to a new directory, and say what is lost."""
    from evodesign.cli.files import recover_run

    recover_run(run, to, json)


def merge(
    run: RunPath,
    to: Annotated[
        Path | None, typer.Option(metavar="FILE", help="File to write.", show_default="in place")
    ] = None,
    json: Json = False,
) -> None:
    """Put all segments of a run into one indexed MCAP file."""
    from evodesign.cli.files import merge_run

    merge_run(run, to, json)


COMMANDS = (
    search,
    resume,
    branch,
    front,
    report,
    show,
    export,
    watch,
    compare,
    evaluate,
    polish,
    check,
    seeds,
    verify,
    recover,
    merge,
    baseline,
    reproduce,
)
