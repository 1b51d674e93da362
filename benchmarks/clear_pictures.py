"""The pictures of docs/model.md of bodies that keep clear of each other.

    python -m benchmarks.clear_pictures

The unscaled robot of point-grasp with a `[collisions]` table, and the person, at the lowest and the
highest load height of the task: from the front, where each is drawn without the other, and from the side.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

from matplotlib.figure import Figure
from PIL import Image

from benchmarks.clearance import with_table
from evodesign.body.placement import Placement, rotate
from evodesign.problem.build import build_problem
from evodesign.problem.evaluate import detail_of
from evodesign.problem.factory import evaluator_of
from evodesign.problem.source import read_source
from evodesign.records import CaseDetail
from evodesign.report.figures.paint import write_figure
from evodesign.report.figures.posture_figure import Camera, posture_figure
from evodesign.report.scene_models import ContactWrench, PlacedScene, SceneModels, placed_scene

PICTURES = Path(__file__).parents[1] / "docs" / "pictures"
FRONT, SIDE = Camera(0.0, math.radians(6.0)), Camera(-math.pi / 2.0, math.radians(6.0))
LARGEST = 150_000
"""Size of a picture's file [byte]."""


def alone(models: SceneModels, detail: CaseDetail) -> Iterator[PlacedScene]:
    """Robot, then person, each without the other and looking along +x."""
    placed = placed_scene(models, detail)
    for agent in models.agents:
        turn = Placement.from_xyz_rpy((0.0, 0.0, 0.0), (0.0, 0.0, -agent.facing))
        frames = {link: turn @ frame for link, frame in placed.frames[agent.name].items()}
        own = replace(models, trees={agent.name: models.trees[agent.name]})
        wrenches = tuple(turned(each, turn) for each in placed.wrenches if each.agent == agent.name)
        yield replace(placed, models=own, frames={agent.name: frames}, wrenches=wrenches)


def turned(wrench: ContactWrench, turn: Placement) -> ContactWrench:
    """A wrench in a world that is turned."""
    force, moment = (rotate(turn.rotation, each) for each in (wrench.force, wrench.moment))
    return replace(wrench, point=turn.apply(wrench.point), force=force, moment=moment)


def write(figure: Figure, stem: str) -> None:
    """Write a picture in its 256 best colours."""
    path = PICTURES / f"{stem}.png"
    with TemporaryDirectory() as folder:
        _, png = write_figure(figure, Path(folder), stem)
        seen = Image.open(png).convert("RGB")
        seen.quantize(256, Image.Quantize.MAXCOVERAGE, kmeans=8).save(path, optimize=True)
    print(path, path.stat().st_size)
    assert path.stat().st_size < LARGEST, f"{path} is too large"


def main() -> None:
    """Solve and draw."""
    problem = build_problem(with_table(read_source(Path("problems") / "point_grasp.toml")))
    result = evaluator_of(problem, 1).solve(problem.space.unscaled(problem.scene.robot.tree))
    details = [detail_of(case) for case in result.cases]
    ends = sorted((details[0], details[-1]), key=lambda detail: detail.case.task.height_m)
    models = SceneModels.of(problem.scene, result.tree)
    scenes = [placed_scene(models, detail) for detail in ends]
    write(posture_figure(scenes, "bodies apart, from the robot's right", SIDE), "apart_side")
    scenes = [scene for detail in ends for scene in alone(models, detail)]
    write(posture_figure(scenes, "bodies apart, from the front: robot, person", FRONT), "apart_front")


if __name__ == "__main__":
    main()
