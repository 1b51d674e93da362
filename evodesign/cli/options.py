"""Arguments and options that several commands share."""

from __future__ import annotations

import math
import os
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from evodesign.simulation.installed import EngineName

if TYPE_CHECKING:
    from evodesign.runlog.run import RunLog

BAD_INPUT = 2
"""Exit code of what a user gave wrong."""

NOTHING_SOLVED = 5
"""Exit code where no case has a posture, or every evaluation of a first generation failed for one reason."""

FROM_DAMAGED = 4
"""Exit code of a command that is done, from a damaged run."""

CORES = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def checked_hours(hours: float | None) -> float | None:
    """The hours given, if any.

    Raises:
        typer.BadParameter: a negative number, or none.
    """
    if hours is not None and not 0.0 <= hours < math.inf:
        raise typer.BadParameter(f"wanted a number of hours from 0, found {hours:g}", param_hint="--hours")
    return hours


ProblemPath = Annotated[
    Path,
    typer.Argument(
        metavar="PROBLEM", help="A problem file (TOML), or a name that `evodesign problems` lists."
    ),
]
RunPath = Annotated[Path, typer.Argument(metavar="RUN", help="Directory of a run.")]
NewRun = Annotated[
    Path | None,
    typer.Option("--run", metavar="DIR", help="Directory of the new run.", show_default="in runs/"),
]
Design = Annotated[int, typer.Argument(metavar="DESIGN", min=0, help="Number of an evaluation of the run.")]
DesignsFile = Annotated[
    Path | None,
    typer.Option(
        "--design", metavar="FILE", help="File of named designs.", show_default="the unscaled robot"
    ),
]

DesignName = Annotated[
    str | None,
    typer.Option(
        "--name", metavar="NAME", help="Which design of the file.", show_default="the file's only one"
    ),
]

Json = Annotated[bool, typer.Option("--json", help="Print JSON instead of tables.")]
Plot = Annotated[
    Path | None,
    typer.Option(
        "--plot",
        metavar="DIR",
        help="Also write figures: postures from the side and the front, torques (SVG and PNG).",
    ),
]
Damaged = Annotated[
    bool, typer.Option("--damaged", help="Exit with 0, not 4, though records of the run are lost.")
]
SymmetryName = Annotated[
    str | None,
    typer.Option(
        "--symmetry",
        metavar="MODE",
        help="Postures: auto, on, off or polish.",
        show_default="as in the problem",
    ),
]
Engine = Annotated[
    EngineName,
    typer.Option("--engine", metavar="NAME", help="What moves those who are pushed: mujoco or drake."),
]
HEIGHT = partial(typer.Option, "--height", metavar="M", help="Only holds at this height [m]; again for more.")
Heights = Annotated[list[float] | None, HEIGHT(show_default="all")]
PushedHeights = Annotated[list[float] | None, HEIGHT(show_default="lowest and highest")]
CarriedHeights = Annotated[list[float] | None, HEIGHT(show_default="the middle one")]
Person = Annotated[
    str | None,
    typer.Option("--person", metavar="NAME", help="Only with this person.", show_default="all"),
]
Payload = Annotated[
    str | None,
    typer.Option("--payload", metavar="NAME", help="Only with this load.", show_default="all"),
]
Knots = Annotated[int, typer.Option("--knots", metavar="N", help="Knots of the lift.")]
Frequency = Annotated[
    float,
    typer.Option("--frequency", metavar="RAD_S", help="Natural frequency of the feedback [rad/s]."),
]
Damping = Annotated[float, typer.Option("--damping", metavar="RATIO", help="Its damping ratio.")]
Video = Annotated[
    Path | None, typer.Option("--video", metavar="FILE", help="Write a film (GIF), drawn by MuJoCo.")
]
Evaluations = Annotated[
    int | None,
    typer.Option(min=1, metavar="N", help="Total evaluations of the run.", show_default="as in the problem"),
]
Hours = Annotated[
    float | None,
    typer.Option(
        metavar="H",
        help="Wall time [h] of a session; then it stops, resumable. 0 for no limit.",
        show_default="no limit",
        callback=checked_hours,
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
LeastGrowth = Annotated[
    float | None,
    typer.Option(
        min=0,
        metavar="PERCENT",
        help="End when doubling the budget is unlikely to add this much hypervolume; 0 for never.",
        show_default="never",
    ),
]
Algorithm = Annotated[
    str | None,
    typer.Option(
        metavar="NAME",
        help="surrogate, nsga2, cma-es, map-elites or random.",
        show_default="as in the problem",
    ),
]
PopulationSize = Annotated[
    int | None,
    typer.Option(min=2, metavar="N", help="Evaluations of a generation.", show_default="as in the problem"),
]
Seed = Annotated[
    int | None,
    typer.Option(min=0, metavar="N", help="Random seed of the search.", show_default="as in the problem"),
]
Jobs = Annotated[int, typer.Option(min=1, metavar="N", help="Evaluations that run at the same time.")]
PoolName = Annotated[
    str, typer.Option("--pool", metavar="NAME", help="Where evaluations run: serial, joblib or dask.")
]
Scheduler = Annotated[
    str | None,
    typer.Option(
        metavar="ADDRESS", help="Of the Dask scheduler for --pool dask, such as tcp://127.0.0.1:8786."
    ),
]
UseCache = Annotated[
    bool, typer.Option("--cache", help="Look up designs that were evaluated before, and keep new ones.")
]
ProfileName = Annotated[
    str, typer.Option("--profile", metavar="NAME", help="Height in time: minimum_jerk or free.")
]


def end_damaged(*runs: RunLog, accepted: bool) -> None:
    """End the command with its exit code if a run is damaged, unless the user accepts that."""
    from evodesign.cli.output import show_notes

    damaged = [run for run in runs if run.damaged]
    if damaged and not accepted:
        show_notes(
            f"{run.directory} is damaged, so this is not all that it found: exit code {FROM_DAMAGED}, "
            "or 0 with --damaged"
            for run in damaged
        )
        raise typer.Exit(FROM_DAMAGED)
