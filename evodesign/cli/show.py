"""`show`: one design of a run as a card, as JSON, and as figures."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, TypeVar

from evodesign.cli.options import CORES, Damaged, Design, Jobs, Json, Plot, RunPath, end_damaged
from evodesign.errors import InputError
from evodesign.files import make_folder

if TYPE_CHECKING:
    from evodesign.report.opened_design import OpenedDesign

T = TypeVar("T")


def show(
    run: RunPath,
    design: Design,
    jobs: Jobs = CORES,
    json: Json = False,
    plot: Plot = None,
    damaged: Damaged = False,
) -> None:
    """One design of a run: objectives, parameters, torques, contact forces."""
    from evodesign.cli.output import console, print_json, show_notes
    from evodesign.cli.progress import precompute_progress
    from evodesign.evaluation.clearance import distance_json, overlaps
    from evodesign.records import task_names
    from evodesign.report.opened_design import open_design
    from evodesign.runlog.run import read_run

    if plot is not None:
        make_folder(plot, "--plot")
    logged = read_run(run)
    show_notes(logged.notes)
    with precompute_progress() as progress:
        opened = open_design(logged, design, jobs, progress)
    if plot is not None:
        from evodesign.report.figures.design import write_design_figures  # matplotlib takes its time to load

        name = f"{logged.header.problem_name}, design {design}"
        figures = write_design_figures(name, opened.scene_set(), opened.cases, plot)
        show_notes(f"written: {path}" for path in figures)
    ergonomics = partial(_part, opened.ergonomics, "what the postures ask of the person")
    bill = partial(_part, opened.bill, "the bill of materials")
    distances = partial(_part, opened.body_distances, "how near bodies come to each other")
    if json:
        from evodesign.analysis.people_spread import spread_json
        from evodesign.quantities.ergonomics import ergonomics_json  # CasADi takes its time to load
        from evodesign.report.export.design import design_json

        told = design_json(opened.run.header, opened.evaluation, opened.cases, on_front=opened.on_front)
        asked = [ergonomics_json(one) for one in ergonomics() or ()]
        nearest = [task_names(case) | distance_json(each) for case, each in (distances() or {}).items()]
        built_of, spread = bill(), opened.spread()
        hardware = {"hardware": built_of} if built_of else {}
        people = {} if spread is None else {"spread": spread_json(spread, design)}
        print_json(
            {"run": str(run), **told, **people, **hardware, "ergonomics": asked, "clearances": nearest}
        )
    else:
        from evodesign.cli.tables.card import card

        console().print(card(opened, ergonomics() or (), bill() or {}))
        show_notes([*overlaps((distances() or {}).items()), *_assumed(opened)])
    end_damaged(logged, accepted=damaged)


def _part(ask: Callable[[], T], what: str) -> T | None:
    """A part of what is shown; None, and a note, if the problem cannot tell it or cannot be built here."""
    from evodesign.cli.output import show_notes

    try:
        return ask()
    except InputError as error:
        show_notes([f"{what} is left out ({error})"])
        return None


def _assumed(opened: OpenedDesign) -> tuple[str, ...]:
    """Heights at which postures of people rest on an assumption; none if the problem cannot be built here."""
    from evodesign.problem.notes import assumed_heights

    try:
        return tuple(assumed_heights(opened.rebuilt.problem))
    except InputError:
        return ()  # said beside the other parts
