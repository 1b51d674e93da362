"""`simulate`: a design's holds, or a lift, by Newton's laws alone."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from evodesign.cli import options
from evodesign.errors import InputError
from evodesign.simulation.installed import EngineName, draw_without_a_screen, refuse_without_mujoco

if TYPE_CHECKING:
    from evodesign.evaluation.simulations import SimulatedCase
    from evodesign.report.opened_design import OpenedDesign


def simulate(
    run: options.RunPath,
    design: options.Design,
    height: options.Heights = None,
    person: options.Person = None,
    payload: options.Payload = None,
    begin: Annotated[
        float | None,
        typer.Option("--from", metavar="M", help="Another lift: height of the load at the start [m]."),
    ] = None,
    end: Annotated[float | None, typer.Option("--to", metavar="M", help="Height at the end [m].")] = None,
    seconds: Annotated[
        float | None,
        typer.Option(metavar="S", help="Time [s].", show_default="2 for a hold, 1.5 for a lift"),
    ] = None,
    profile: options.ProfileName = "minimum_jerk",
    knots: options.Knots = 24,
    frequency: options.Frequency = 8.0,
    damping: options.Damping = 1.0,
    push: Annotated[
        float | None,
        typer.Option(
            metavar="N_S", help="Push the robot in holds and lifts, by this impulse [N s] on its trunk."
        ),
    ] = None,
    direction: Annotated[
        float, typer.Option(metavar="DEG", help="To where, from forwards to the left.")
    ] = 0.0,
    engine: options.Engine = EngineName.MUJOCO,
    mcap: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write a recording for Foxglove and Lichtblick.")
    ] = None,
    video: options.Video = None,
    jobs: options.Jobs = options.CORES,
    json: options.Json = False,
    damaged: options.Damaged = False,
) -> None:
    """Simulate holds and lifts of a design in MuJoCo: contacts, motors, feedback; how far from the plan."""
    if push is not None:
        from evodesign.cli.push import push_once

        where = (height or (), person, payload)
        gains = (frequency, damping)
        push_once(run, design, (push, direction), where, gains, engine, jobs, video, json=json)
        return
    if engine is not EngineName.MUJOCO:
        raise InputError("--engine", "", "mujoco, which holds and lifts without a push ask for", engine)
    if (begin is None) != (end is None):
        raise InputError("--from", "", "both --from and --to, or neither", "one of them")
    refuse_without_mujoco()
    draw_without_a_screen()
    from evodesign.cli.output import console, print_json, show_notes
    from evodesign.cli.progress import precompute_progress
    from evodesign.cli.tables.simulation import simulation_table
    from evodesign.control.gains import Feedback
    from evodesign.evaluation.simulation_json import simulations_json
    from evodesign.evaluation.simulations import (
        HOLD_SECONDS,
        lifts_among,
        picked_cases,
        picked_holds,
        simulated_holds,
        simulated_lifts,
    )
    from evodesign.report.opened_design import open_design
    from evodesign.runlog.run import read_run
    from evodesign.tasks.lift import Lift, profile_named

    feedback, logged = Feedback(frequency, damping), read_run(run)
    show_notes(logged.notes)
    with precompute_progress() as progress:
        opened = open_design(logged, design, jobs, progress)
        built, robot = opened.rebuilt.problem, opened.scene_set().robot
        cases = picked_cases(opened.cases, person, payload)
        simulations: list[SimulatedCase] = []
        if begin is None or end is None:
            time = HOLD_SECONDS if seconds is None else seconds
            holds = picked_holds(cases, height or ())
            simulations += simulated_holds(built.scenes, robot, holds, time, feedback)
            lifts = lifts_among(built.tasks, height or (), knots)
        else:
            lifts = [Lift(begin, end, 1.5 if seconds is None else seconds, profile_named(profile), knots)]
        pairs = {detail.case.pair for detail in cases}
        for asked in lifts:
            solved = {p: s for p, s in opened.lifts(asked, jobs, progress).items() if p in pairs}
            show_notes(f"no lift {s.lift}: {s.reason}" for s in solved.values() if not s.solved)
            simulations += simulated_lifts(built.scenes, robot, solved, feedback)
    if mcap is not None:
        _write_recording(mcap, opened, simulations)
    if video is not None:
        _write_film(video, simulations)
    if json:
        print_json({"run": str(run), "design": design, **simulations_json(simulations, feedback)})
    else:
        title = f"{logged.header.problem_name}: design {design} in MuJoCo"
        console().print(simulation_table(title, simulations, feedback))
        show_notes(
            f"{name} in case {each.name}: torque at its limit in {', '.join(agent.at_limit)}"
            for each in simulations
            for name, agent in each.outcome.agents.items()
            if agent.at_limit
        )
    options.end_damaged(logged, accepted=damaged)


def _write_recording(path: Path, opened: OpenedDesign, simulations: Sequence[SimulatedCase]) -> None:
    from io import BytesIO

    from evodesign.cli.output import write_bytes
    from evodesign.report.replay.simulated import write_simulations

    stream = BytesIO()
    write_simulations(stream, opened.scene_set(), simulations)
    write_bytes(path, stream.getvalue(), "--mcap")


def _write_film(path: Path, simulations: Sequence[SimulatedCase]) -> None:
    from evodesign.cli.output import write_bytes
    from evodesign.simulation.film import Filmed, film

    shown = [Filmed(each.rollout.model, each.rollout.states) for each in simulations]
    write_bytes(path, film(shown), "--video")
