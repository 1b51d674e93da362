"""`carry`: robot and person walk with the load that they hold."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated

import typer

from evodesign.cli import options
from evodesign.simulation.installed import draw_without_a_screen, refuse_without_a_controller

if TYPE_CHECKING:
    from collections.abc import Sequence

    from evodesign.records import CaseDetail


def carry(
    run: options.RunPath,
    design: options.Design,
    height: options.CarriedHeights = None,
    person: options.Person = None,
    payload: options.Payload = None,
    distance: Annotated[float, typer.Option(metavar="M", help="How far they walk [m].")] = 2.0,
    direction: Annotated[
        float,
        typer.Option(
            metavar="DEG",
            help="To where, from the robot's forwards to its left; 180: the person walks forwards.",
        ),
    ] = 180.0,
    load: Annotated[
        float | None,
        typer.Option(metavar="KG", help="Another mass of the load [kg].", show_default="the problem's"),
    ] = None,
    frequency: options.Frequency = 8.0,
    damping: options.Damping = 1.0,
    video: options.Video = None,
    jobs: options.Jobs = options.CORES,
    json: options.Json = False,
    damaged: options.Damaged = False,
) -> None:
    """Let a design's robot and person walk with the load in MuJoCo, under whole-body controllers."""
    refuse_without_a_controller()
    draw_without_a_screen()
    from evodesign.cli.output import console, print_json, show_notes, write_bytes
    from evodesign.cli.progress import precompute_progress
    from evodesign.cli.tables.simulation import carries_table
    from evodesign.control.gains import Feedback
    from evodesign.evaluation.carries import carried_holds, carries_json
    from evodesign.evaluation.pushes import pushed_holds
    from evodesign.evaluation.simulations import picked_cases, picked_holds
    from evodesign.report.opened_design import open_design
    from evodesign.runlog.run import read_run
    from evodesign.simulation.film import carried_film, film
    from evodesign.simulation.pushed_plan import PushConditions

    conditions, logged = PushConditions(Feedback(frequency, damping)), read_run(run)
    show_notes(logged.notes)
    with precompute_progress() as progress:
        opened = open_design(logged, design, jobs, progress)
        holds = picked_holds(picked_cases(opened.cases, person, payload), height or ())
        plans = pushed_holds(
            opened.rebuilt.problem.scenes, opened.scene_set().robot, holds if height else _middle(holds)
        )
        way = distance, math.radians(direction)
        cases = list(carried_holds(plans, way, load, conditions))
    if video is not None:
        write_bytes(video, film([carried_film(case.outcome) for case in cases]), "--video")
    if json:
        header = {"run": str(run), "design": design, "direction_deg": direction}
        print_json({**header, "carries": carries_json(cases)})
    else:
        to = f"{distance:g} m to {direction:g} degrees"
        console().print(carries_table(f"{logged.header.problem_name}: design {design} carries {to}", cases))
        show_notes(
            f"{name} in {case.name}: torque at its limit in {', '.join(agent.saturated)}"
            for case in cases
            for name, agent in case.outcome.agents.items()
            if agent.saturated
        )
    options.end_damaged(logged, accepted=damaged)


def _middle(holds: Sequence[CaseDetail]) -> list[CaseDetail]:
    """Of every person and load the hold of middle height."""
    own: dict[tuple[str, str], list[CaseDetail]] = {}
    for detail in holds:
        own.setdefault(detail.case.pair, []).append(detail)
    ordered = (sorted(each, key=lambda detail: detail.height_m) for each in own.values())
    return [each[(len(each) - 1) // 2] for each in ordered]
