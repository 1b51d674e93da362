"""The files of a reproduction: the paper's figures for our robots, and the robots themselves.

    robot_torques, human_torques    box plots of joint torques per height (the paper's Fig. 4 and 5)
    postures_NAME                   postures with the forces on feet and hands (Fig. 2 and 3)
    NAME.urdf                       the robot

Source: Sartore et al. 2022, Fig. 2 to 5.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from evodesign.analysis.paper_claims import TorqueNorms, TorqueNormsByHeight
from evodesign.errors import InputError
from evodesign.mechanics.scene import HUMAN, ROBOT
from evodesign.records import HeightDetail
from evodesign.report.figures.paint import write_figure
from evodesign.report.figures.posture_figure import posture_figure
from evodesign.report.figures.torque_boxes import torque_boxes
from evodesign.report.scene_models import SceneModels, placed_scene
from evodesign.tree.urdf_write import urdf_text

__all__ = ["ReproducedRobot", "write_reproduction"]


@dataclass(frozen=True, slots=True)
class ReproducedRobot:
    """A robot of the reproduction with its postures.

    Args:
        name: short, of letters and underscores; it names files and figures.
        title: of its figure of postures.
        models: the robot, the person and the load.
        heights: postures at the heights that were solved.
    """

    name: str
    title: str
    models: SceneModels
    heights: tuple[HeightDetail, ...]

    @property
    def torque_norms(self) -> TorqueNormsByHeight:
        """Torque norms of both agents by height."""
        return {
            height.height_m: TorqueNorms(
                robot=math.hypot(*height.agents[ROBOT].torques_n_m.values()),
                human=math.hypot(*height.agents[HUMAN].torques_n_m.values()),
            )
            for height in self.heights
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
            robot.name: {h.height_m: tuple(h.agents[agent].torques_n_m.values()) for h in robot.heights}
            for robot in compared
        }
        whose = "the robots" if agent == ROBOT else "the person beside each robot"
        figure = torque_boxes(series, f"joint torques of {whose}")
        written += write_figure(figure, directory, f"{agent}_torques")
    for robot in (*compared, *others):
        stages = [placed_scene(robot.models, height) for height in robot.heights]
        written += write_figure(posture_figure(stages, robot.title), directory, f"postures_{robot.name}")
        written.append(_urdf(directory, robot))
    return tuple(written)


def _urdf(directory: Path, robot: ReproducedRobot) -> Path:
    path = directory / f"{robot.name}.urdf"
    try:
        path.write_text(urdf_text(robot.models.trees[ROBOT]), encoding="utf-8")
    except OSError as error:
        wanted = "a directory that can be written"
        raise InputError(str(directory), "", wanted, f"{error.strerror}") from error
    return path
