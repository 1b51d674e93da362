"""The figures of one design: joint torques, and postures, also from the side and front with a scale."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from matplotlib.figure import Figure

from evodesign.body.placement import Placement, rotate
from evodesign.mechanics.agent import Role
from evodesign.records import CaseDetail
from evodesign.report.figures.joint_torques import joint_torques, torque_boxes
from evodesign.report.figures.paint import write_figure
from evodesign.report.figures.posture_figure import Camera, posture_figure
from evodesign.report.scene_models import ContactWrench, PlacedScene, SceneSet


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


SIDE = Camera(azimuth=-math.pi / 2.0, elevation=0.0)
"""From the robot's right: it stands on the left and looks to the right."""

PAIR = 2
"""Agents of whom each has one other."""

FRONT = Camera(azimuth=0.0, elevation=0.0)
"""Into the face of whoever looks along +x."""


def side_figure(stages: Sequence[PlacedScene], title: str) -> Figure:
    """Robot, person and load from the robot's right, one panel per height or moment of a lift."""
    robots = any(agent.role is Role.ROBOT for stage in stages for agent in stage.models.agents)
    where = "the robot's right" if robots else "the side"
    return posture_figure(stages, f"{title} from {where}", SIDE)


def front_figure(stages: Sequence[PlacedScene], title: str) -> Figure:
    """Each agent alone with the load and from the front, a panel for each per height or moment.

    Agents would hide each other: each is drawn alone, turned so that it looks at the camera with the load
    between them.
    """
    pair = all(len(stage.models.agents) == PAIR for stage in stages)
    who = "robot and person each without the other" if pair else "each without the others"
    return posture_figure(
        [one for each in stages for one in alone(each)], f"{title} from the front, {who}", FRONT
    )


def alone(stage: PlacedScene) -> Iterator[PlacedScene]:
    """Each agent without the others and looking along +x."""
    for agent in stage.models.agents:
        turn = Placement.from_xyz_rpy((0.0, 0.0, 0.0), (0.0, 0.0, -agent.facing))
        frames = {link: turn @ frame for link, frame in stage.frames[agent.name].items()}
        wrenches = tuple(_turned(each, turn) for each in stage.wrenches if each.agent == agent.name)
        yield replace(
            stage,
            models=replace(stage.models, trees={agent.name: stage.models.trees[agent.name]}),
            frames={agent.name: frames},
            world_from_load=turn @ stage.world_from_load,
            wrenches=wrenches,
        )


def _turned(wrench: ContactWrench, turn: Placement) -> ContactWrench:
    """A wrench in a world that is turned."""
    force, moment = (rotate(turn.rotation, each) for each in (wrench.force, wrench.moment))
    return replace(wrench, point=turn.apply(wrench.point), force=force, moment=moment)
