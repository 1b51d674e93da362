"""The figures of one design."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from evodesign.records import CaseDetail
from evodesign.report.figures.joint_torques import joint_torques, torque_boxes
from evodesign.report.figures.paint import write_figure
from evodesign.report.figures.posture_figure import posture_figure
from evodesign.report.figures.posture_views import front_figure, side_figure
from evodesign.report.scene_models import SceneSet


def write_design_figures(
    name: str, scene_set: SceneSet, cases: Sequence[CaseDetail], directory: Path
) -> list[Path]:
    """Write figures of a design's joint torques and postures to an existing directory.

    Args:
        name: of the design, for titles.
        scene_set: its robot, and everyone who holds a load with it.
        cases: its postures.
        directory: of the files.
    Raises:
        InputError: a file cannot be written.
        RunError: postures that are not those of robot and people.
    """
    shown = [moment for detail in cases for moment in detail.few_moments]
    torques = {
        agent: [(detail.height_m, detail.agents[agent].torques_n_m) for detail in shown]
        for agent in scene_set.models[0].trees
    }
    several = any(detail.case.label for detail in shown)
    whom = " with all people and loads" if several else ""
    stages = [scene_set.placed_scene(detail) for detail in shown]
    figures = {
        "torques": torque_boxes(_by_height(torques), f"{name}: joint torques{whom}"),
        "torques_by_joint": joint_torques(torques, f"{name}: torque of each joint{whom}"),
        "postures": posture_figure(stages, f"{name}: postures"),
        "postures_side": side_figure(stages, f"{name}: postures"),
        "postures_front": front_figure(stages, f"{name}: postures"),
    }
    return [path for stem, figure in figures.items() for path in write_figure(figure, directory, stem)]


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
