"""What a reproduction gives, and its files: the paper's figures for our robots, and the robots themselves.

    robot_torques, human_torques    box plots of joint torques per height (the paper's Fig. 4 and 5)
    postures_NAME                   postures with the forces on feet and hands (Fig. 2 and 3)
    NAME.urdf                       the robot

Source: Sartore et al. 2022, Fig. 2 to 5.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec

from evodesign.errors import InputError
from evodesign.files import write_whole
from evodesign.mechanics.agent import HUMAN, ROBOT
from evodesign.records import CaseDetail, Status
from evodesign.report.figures.joint_torques import torque_boxes
from evodesign.report.figures.paint import write_figure
from evodesign.report.figures.posture_figure import posture_figure
from evodesign.report.scene_models import SceneModels, placed_scene
from evodesign.reproduction.claims2022 import (
    PAPER_OPTIMISED,
    PAPER_ORIGINAL,
    Claim,
    TorqueNorms,
    TorqueNormsByHeight,
)
from evodesign.runlog.run import RunLog
from evodesign.tree.model import Tree
from evodesign.tree.urdf_write import urdf_text

PAPER = "paper"


@dataclass(frozen=True, slots=True)
class ReproducedRobot:
    """A robot of the reproduction with its postures.

    Args:
        name: short, of letters and underscores; it names files and figures.
        title: of its figure of postures.
        models: the robot, the person and the load.
        cases: postures in the cases that were solved.
    """

    name: str
    title: str
    models: SceneModels
    cases: tuple[CaseDetail, ...]

    @property
    def torque_norms(self) -> TorqueNormsByHeight:
        """Torque norms of both agents by height."""
        return {
            detail.height_m: TorqueNorms(
                robot=math.hypot(*detail.agents[ROBOT].torques_n_m.values()),
                human=math.hypot(*detail.agents[HUMAN].torques_n_m.values()),
            )
            for detail in self.cases
        }


@dataclass(frozen=True, slots=True)
class Published:
    """What the published setting gives; a robot without heights had no start that was solved.

    Args:
        original, optimised: robots and postures.
        broken: physical limits that the postures break, in words.
        difference: largest difference of a torque from the paper's formula [N m].
        statuses: how the starts ended.
    """

    original: ReproducedRobot
    optimised: ReproducedRobot
    broken: str
    difference: float
    statuses: Counter[Status]


@dataclass(frozen=True, slots=True)
class Found:
    """The best robot of a run; without heights when the run holds no feasible one."""

    robot: ReproducedRobot
    run: RunLog
    cost: float | None
    design: dict[str, float]

    @property
    def statuses(self) -> Counter[Status]:
        """How the evaluations ended."""
        return Counter(evaluation.assessment.status for evaluation in self.run.evaluations)


@dataclass(frozen=True, slots=True)
class Reproduction:
    """Everything that is shown.

    Args:
        published: the paper's setting, without limits.
        original: the robot as it is, with limits.
        highest: load that it can hold [m]; None when not solved.
        found: the best robots with limits: by gradients, by evolution.
        claims: each with its verdict.
        stricter: torque norms by setting, each stricter than the one before, and by robot.
        measured: torque norms under limits by robot, where the person stands as measured people do.
    """

    published: Published
    original: ReproducedRobot
    highest: float | None
    found: tuple[Found, ...]
    claims: tuple[Claim, ...]
    stricter: Mapping[str, Mapping[str, TorqueNormsByHeight]]
    measured: Mapping[str, TorqueNormsByHeight]

    @property
    def by_setting(self) -> dict[str, dict[str, TorqueNormsByHeight]]:
        """Table II of the paper with ours beside it: torque norms by model and setting."""
        published, limits, measured = self.published, "with limits", "measured person"
        return {
            "original": {
                PAPER: PAPER_ORIGINAL,
                "published": published.original.torque_norms,
                limits: self.original.torque_norms,
                measured: self.measured[self.original.name],
            },
            "optimised": {
                PAPER: PAPER_OPTIMISED,
                "published": published.optimised.torque_norms,
                **{f"{limits}, {one.robot.name}": one.robot.torque_norms for one in self.found},
                **{
                    f"{measured}, {name}": rows
                    for name, rows in self.measured.items()
                    if name != self.original.name
                },
            },
        }

    @property
    def by_limits(self) -> dict[str, dict[str, TorqueNormsByHeight]]:
        """What each robot's torques are under limits, and in the stricter settings, by robot and setting."""
        robots = (self.original, *(one.robot for one in self.found))
        return {
            robot.name: {
                "with limits": robot.torque_norms,
                **{name: rows[robot.name] for name, rows in self.stricter.items() if robot.name in rows},
            }
            for robot in robots
        }


def write_reproduction(
    directory: Path, compared: Sequence[ReproducedRobot], others: Sequence[ReproducedRobot]
) -> tuple[Path, ...]:
    """Write figures and robots.

    Args:
        directory: an existing one.
        compared: robots that share the box plots.
        others: robots with figures of postures only.
    Returns:
        What was written.
    Raises:
        InputError: a file cannot be written.
    """
    written: list[Path] = []
    for agent in (ROBOT, HUMAN):
        series = {
            robot.name: {
                detail.height_m: tuple(detail.agents[agent].torques_n_m.values()) for detail in robot.cases
            }
            for robot in compared
        }
        whose = "the robots" if agent == ROBOT else "the person beside each robot"
        figure = torque_boxes(series, f"joint torques of {whose}")
        written += write_figure(figure, directory, f"{agent}_torques")
    for robot in (*compared, *others):
        stages = [placed_scene(robot.models, detail) for detail in robot.cases]
        written += write_figure(posture_figure(stages, robot.title), directory, f"postures_{robot.name}")
        written.append(write_robot(directory, robot.name, robot.models.trees[ROBOT]))
    return tuple(written)


def write_robot(directory: Path, name: str, tree: Tree) -> Path:
    """Write a robot as NAME.urdf into an existing directory.

    Raises:
        InputError: the file cannot be written.
    """
    return write_file(directory / f"{name}.urdf", urdf_text(tree))


def write_file(path: Path, text: str) -> Path:
    """Write a text into an existing directory.

    Raises:
        InputError: the file cannot be written.
    """
    try:
        write_whole(path, text.encode())
    except OSError as error:
        wanted = "a directory that can be written"
        raise InputError(str(path.parent), "", wanted, f"{error.strerror}") from error
    return path


def reproduction_json(
    done: Reproduction, directory: Path, files: Iterable[Path], seconds: float
) -> dict[str, Any]:
    """A reproduction as a JSON object; its shape is a promise. Torque norms [N m], heights [m]."""
    published = done.published
    return {
        "directory": str(directory),
        "torque_norms": {
            model: {setting: _torque_norms(torque_norms) for setting, torque_norms in rows.items()}
            for model, rows in done.by_setting.items()
        },
        "stricter": {
            robot: {setting: _torque_norms(torque_norms) for setting, torque_norms in rows.items()}
            for robot, rows in done.by_limits.items()
        },
        "claims": msgspec.to_builtins(list(done.claims)),
        "published": {
            "torque_difference": published.difference,
            "broken_limits": published.broken,
            "statuses": _statuses(published.statuses),
        },
        "original_highest_m": done.highest,
        "found": {
            one.robot.name: {
                "run": str(one.run.directory),
                "cost": one.cost,
                "parameters": one.design,
                "evaluations": len(one.run.evaluations),
                "statuses": _statuses(one.statuses),
            }
            for one in done.found
        },
        "files": [str(path) for path in files],
        "seconds": seconds,
    }


def _torque_norms(torque_norms: TorqueNormsByHeight) -> list[dict[str, float]]:
    return [
        {"height_m": height, "robot": norms.robot, "human": norms.human}
        for height, norms in torque_norms.items()
    ]


def _statuses(statuses: Counter[Status]) -> dict[str, int]:
    return {str(status): count for status, count in statuses.items()}
