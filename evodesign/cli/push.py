"""`push`: the largest pushes on the trunk of a design's robot that it survives."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from evodesign.cli import damage
from evodesign.cli.options import CORES, Damaged, Design, Engine, Jobs, Json, RunPath
from evodesign.errors import InputError
from evodesign.simulation.installed import EngineName, draw_without_a_screen, refuse_without_a_controller

if TYPE_CHECKING:
    from evodesign.evaluation.pushes import PushedDesign
    from evodesign.report.opened_design import OpenedDesign


def push(
    run: RunPath,
    design: Design,
    height: Annotated[
        list[float] | None,
        typer.Option(
            metavar="M",
            help="Only holds at this height [m]; again for more.",
            show_default="lowest and highest",
        ),
    ] = None,
    person: Annotated[
        str | None, typer.Option(metavar="NAME", help="Only with this person.", show_default="all")
    ] = None,
    payload: Annotated[
        str | None, typer.Option(metavar="NAME", help="Only with this load.", show_default="all")
    ] = None,
    direction: Annotated[
        list[float] | None,
        typer.Option(
            metavar="DEG",
            help="Only to this direction, from forwards to the left; again for more.",
            show_default="eight",
        ),
    ] = None,
    alone: Annotated[bool, typer.Option("--alone", help="The robot without load and people.")] = False,
    spread: Annotated[
        bool, typer.Option("--spread", help="Also with other friction, load and late sensors.")
    ] = False,
    frequency: Annotated[
        float, typer.Option(metavar="RAD_S", help="Bandwidth of the controllers [rad/s].")
    ] = 8.0,
    damping: Annotated[float, typer.Option(metavar="RATIO", help="Their damping ratio.")] = 1.0,
    engine: Engine = EngineName.MUJOCO,
    jobs: Jobs = CORES,
    json: Json = False,
    damaged: Damaged = False,
) -> None:
    """Push a design's robot, under whole-body controllers, to the largest impulses it survives."""
    refuse_without_a_controller(engine)
    from evodesign.cli.output import console, print_json, show_notes
    from evodesign.cli.progress import precompute_progress
    from evodesign.cli.tables.push import margins_table
    from evodesign.control.gains import Feedback
    from evodesign.evaluation.pushes import found_margins, margins_json
    from evodesign.report.opened_design import open_design
    from evodesign.runlog.run import read_run
    from evodesign.simulation.engine import engine_named
    from evodesign.simulation.push_margin import DIRECTIONS
    from evodesign.simulation.pushed_plan import PushConditions

    conditions = PushConditions(Feedback(frequency, damping), engine=engine_named(engine))
    logged = read_run(run)
    show_notes(logged.notes)
    with precompute_progress() as progress:
        opened = open_design(logged, design, jobs, progress)
        pushed = pushed_in(opened, height or (), person, payload, alone=alone)
        turns = [math.radians(each) for each in direction or ()]
        found = found_margins(pushed, conditions, turns or DIRECTIONS, spread=spread)
    if json:
        header = {"run": str(run), "design": design, "engine": engine}
        print_json({**header, **margins_json(found, conditions)})
    else:
        title = f"{logged.header.problem_name}: pushes that design {design} survives in {engine.label}"
        console().print(margins_table(title, found))
    damage.end(logged, accepted=damaged)


def push_once(
    run: Path,
    design: int,
    push: tuple[float, float],
    asked: tuple[Sequence[float], str | None, str | None],
    feedback: tuple[float, float],
    engine: EngineName,
    jobs: int,
    video: Path | None,
    *,
    json: bool,
) -> None:
    """What comes of one push in each hold that is asked for: `simulate --push`.

    Args:
        run: directory of the run.
        design: number of the design.
        push: impulse [N s], and direction from forwards to the left [degrees].
        asked: heights [m], person and load; empty or None for all.
        feedback: bandwidth [rad/s] and damping ratio of the controllers.
        engine: that moves everything.
        jobs: processes that may be used.
        video: where to write a film; None for none.
        json: whether JSON is printed.
    Raises:
        InputError: an impulse that is not positive, nothing to push, or a film of another engine than MuJoCo.
    """
    impulse, turn = push
    if not 0.0 < impulse < math.inf:
        raise InputError("--push", "", "a positive number", f"{impulse}")
    refuse_without_a_controller(engine)
    draw_without_a_screen()
    from evodesign.cli.output import console, print_json, write_bytes
    from evodesign.cli.progress import precompute_progress
    from evodesign.cli.tables.push import pushes_table
    from evodesign.control.gains import Feedback
    from evodesign.evaluation.pushes import outcome_json
    from evodesign.report.opened_design import open_design
    from evodesign.runlog.run import read_run
    from evodesign.simulation.engine import engine_named
    from evodesign.simulation.film import film, pushed_film
    from evodesign.simulation.push import Push
    from evodesign.simulation.pushed_plan import PushConditions

    logged = read_run(run)
    with precompute_progress() as progress:
        pushed = pushed_in(open_design(logged, design, jobs, progress), *asked, alone=False)
        tests = pushed.tests(PushConditions(Feedback(*feedback), engine=engine_named(engine)))
        given = Push(impulse, math.radians(turn))
        outcomes = {name: test.pushed(given, frames=video is not None) for name, test in tests.items()}
    if video is not None:
        write_bytes(
            video, film([pushed_film(tests[name], each) for name, each in outcomes.items()]), "--video"
        )
    if json:
        pushes = [outcome_json(name, each) for name, each in outcomes.items()]
        print_json({"run": str(run), "design": design, "engine": engine, "pushes": pushes})
    else:
        pushed_so = f"pushed by {impulse:g} N s to {turn:g} degrees in {engine.label}"
        title = f"{logged.header.problem_name}: design {design} {pushed_so}"
        console().print(pushes_table(title, outcomes))


def pushed_in(
    opened: OpenedDesign,
    heights: Sequence[float],
    person: str | None,
    payload: str | None,
    *,
    alone: bool,
) -> PushedDesign:
    """The holds that are asked for: the lowest and highest ones unless heights are said."""
    from evodesign.evaluation.pushes import PushedDesign
    from evodesign.evaluation.simulations import picked_cases, picked_holds

    cases = picked_holds(picked_cases(opened.cases, person, payload), heights)
    if not heights:
        ends = {
            end(
                (each for each in cases if each.case.pair == pair), key=lambda detail: detail.height_m
            ).case.name
            for pair in {each.case.pair for each in cases}
            for end in (min, max)
        }
        cases = tuple(each for each in cases if each.case.name in ends)
    return PushedDesign(opened.rebuilt.problem.scenes, opened.scene_set().robot, cases, alone=alone)
