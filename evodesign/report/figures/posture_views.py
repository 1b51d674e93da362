"""Postures from the side and from the front, without perspective, with a scale in metres.

From the front, agents would hide each other: each is drawn alone, turned so that it looks at the
camera with the load between them.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

from matplotlib.figure import Figure

from evodesign.body.placement import Placement, rotate
from evodesign.mechanics.agent import Role
from evodesign.report.figures.posture_figure import Camera, posture_figure
from evodesign.report.scene_models import ContactWrench, PlacedScene

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
    """Each agent alone with the load and from the front, a panel for each per height or moment."""
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
