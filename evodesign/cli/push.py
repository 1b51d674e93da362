"""`push`: the largest pushes on the trunk of a design's robot that it survives."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from evodesign.cli import options
from evodesign.errors import InputError
from evodesign.simulation.installed import EngineName, draw_without_a_screen, refuse_without_a_controller

if TYPE_CHECKING:
    from evodesign.evaluation.progress import PrecomputeProgress
    from evodesign.report.opened_design import OpenedDesign
    from evodesign.simulation.pushed_plan import PushedDesign


def push(
    run: options.RunPath,
    design: options.Design,
    height: options.PushedHeights = None,
    person: options.Person = None,
    payload: options.Payload = None,
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
    frequency: options.Frequency = 8.0,
    damping: options.Damping = 1.0,
    engine: options.Engine = EngineName.MUJOCO,
    jobs: options.Jobs = options.CORES,
    json: options.Json = False,
    damaged: options.Damaged = False,
) -> None:
    """Push a design's robot, under whole-body controllers, to the largest impulses it survives."""
    refuse_without_a_controller(engine)
    from evodesign.cli.output import console, print_json, show_notes
    from evodesign.cli.progress import precompute_progress
    from evodesign.cli.tables.simulation import margins_table
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
        pushed = pushed_in(opened, (height or (), person, payload), jobs, progress, alone=alone)
        turns = [math.radians(each) for each in direction or ()]
        found = found_margins(pushed, conditions, turns or DIRECTIONS, spread=spread)
    if json:
        header = {"run": str(run), "design": design, "engine": engine}
        print_json({**header, **margins_json(found, conditions)})
    else:
        title = f"{logged.header.problem_name}: pushes that design {design} survives in {engine.label}"
        console().print(margins_table(title, found))
    options.end_damaged(logged, accepted=damaged)


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
    from evodesign.cli.tables.simulation import pushes_table
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
        pushed = pushed_in(open_design(logged, design, jobs, progress), asked, jobs, progress)
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
    asked: tuple[Sequence[float], str | None, str | None],
    jobs: int,
    progress: PrecomputeProgress,
    *,
    alone: bool = False,
) -> PushedDesign:
    """The holds and lifts that are asked for; the search's own unless heights are said.

    Args:
        opened: the design.
        asked: heights of holds [m], person and load; empty or None for all.
        jobs: processes that may be used.
        progress: of the lifts' precomputation.
        alone: whether the robot stands alone.
    """
    from evodesign.cli.output import show_notes
    from evodesign.evaluation.pushes import pushed_holds
    from evodesign.evaluation.simulations import picked_cases, picked_holds
    from evodesign.simulation.pushed_plan import PushedDesign, PushedPlan, pushed_cases
    from evodesign.tasks import Lift

    heights, person, payload = asked
    cases = picked_cases(opened.cases, person, payload)
    holds = picked_holds(cases, heights)
    picked = [detail.case for detail in holds] if heights else pushed_cases([each.case for each in cases])
    scenes, robot = opened.rebuilt.problem.scenes, opened.scene_set().robot
    plans = pushed_holds(scenes, robot, [detail for detail in holds if detail.case in picked])
    for lift in dict.fromkeys(case.task for case in picked if isinstance(case.task, Lift)):
        solved = opened.lifts(lift, jobs, progress)
        for case in (each for each in picked if each.task == lift):
            show_notes(f"no lift {case.name}: {s.reason}" for s in [solved[case.pair]] if not s.solved)
            if (course := solved[case.pair].course) is not None:
                plans.append(PushedPlan.lift(scenes, robot, case, course))
    return PushedDesign(tuple(plans), alone)
