"""`show`: one design of a run as a card, as JSON, and as figures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from evodesign.analysis.cases import named_people_or_loads
from evodesign.cli.making import making
from evodesign.cli.output import console, print_json, show_notes
from evodesign.cli.tables.card import card
from evodesign.errors import InputError
from evodesign.report.export.design import design_json
from evodesign.report.opened_design import OpenedDesign, open_design
from evodesign.runlog.run import read_run

if TYPE_CHECKING:
    from evodesign.problem.ergonomics import Ergonomics

__all__ = ["show_design"]


def show_design(directory: Path, number: int, jobs: int, json: bool, plot: Path | None) -> None:
    """Print one design; write its figures if asked."""
    if plot is not None:
        _make(plot)
    run = read_run(directory)
    show_notes(run.notes)
    with making() as progress:
        opened = open_design(run, number, jobs, progress)
    if plot is not None:
        _write_figures(opened, plot)
    if json:
        from evodesign.problem.ergonomics import ergonomics_json  # CasADi takes its time to load

        told = design_json(opened.run.header, opened.evaluation, opened.heights, on_front=opened.on_front)
        asked = [ergonomics_json(one) for one in _ergonomics(opened)]
        print_json({"run": str(directory), **told, "ergonomics": asked})
        return
    console().print(card(opened, _ergonomics(opened)))


def _ergonomics(opened: OpenedDesign) -> tuple[Ergonomics, ...]:
    """What the postures ask of the people; none, and a note, if the people cannot be told."""
    try:
        return opened.ergonomics()
    except InputError as error:
        show_notes([f"what the postures ask of the person is left out ({error})"])
        return ()


def _make(directory: Path) -> None:
    try:
        directory.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        found = f"'{directory}' ({error.strerror})"
        raise InputError("--plot", "", "a folder that can be written", found) from error


def _write_figures(opened: OpenedDesign, directory: Path) -> None:
    from evodesign.report.figures.joint_torques import joint_torques  # matplotlib takes its time to load
    from evodesign.report.figures.paint import write_figure
    from evodesign.report.figures.posture_figure import posture_figure
    from evodesign.report.figures.torque_boxes import torque_boxes

    name = f"{opened.run.header.problem_name}, design {opened.evaluation.number}"
    scene_set = opened.scene_set()
    torques = {
        agent: [(detail.height_m, detail.agents[agent].torques_n_m) for detail in opened.heights]
        for agent in scene_set.models[0].trees
    }
    several = named_people_or_loads(opened.heights)
    whom = " with all people and loads" if several else ""
    stages = [scene_set.placed_scene(detail) for detail in opened.heights]
    figures = {
        "torques": torque_boxes(_by_height(torques), f"{name}: joint torques{whom}"),
        "torques_by_joint": joint_torques(torques, f"{name}: torque of each joint{whom}"),
        "postures": posture_figure(stages, f"{name}: postures"),
    }
    for stem, figure in figures.items():
        written = write_figure(figure, directory, stem)
        show_notes(f"written: {path}" for path in written)


def _by_height(
    torques: Mapping[str, Sequence[tuple[float, Mapping[str, float]]]],
) -> dict[str, dict[float, list[float]]]:
    """Of each agent, all joint torques [N m] at a height, whoever holds whichever load."""
    boxes: dict[str, dict[float, list[float]]] = {}
    for agent, cases in torques.items():
        boxes[agent] = {}
        for height, by_joint in cases:
            boxes[agent].setdefault(height, []).extend(by_joint.values())
    return boxes
