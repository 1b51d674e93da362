"""The pictures of docs/model.md of bodies that keep clear of each other.

    python -m benchmarks.clear_pictures

The unscaled robot of the default problem with a `[collisions]` table, and the person, at the lowest and the
highest load height of the task: from the front, where each is drawn without the other, and from the side.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

from matplotlib.figure import Figure

from benchmarks.clearance import with_table
from evodesign.mechanics.scene import HUMAN, ROBOT
from evodesign.problem.build import build_problem
from evodesign.problem.evaluate import detail_of
from evodesign.problem.factory import evaluator_of
from evodesign.problem.source import read_source
from evodesign.records import CaseDetail
from evodesign.report.figures.paint import write_figure
from evodesign.report.figures.posture_figure import Camera, posture_figure
from evodesign.report.scene_models import PlacedScene, SceneModels, placed_scene

PICTURES = Path(__file__).parents[1] / "docs" / "pictures"
FRONT, SIDE = Camera(0.0, math.radians(6.0)), Camera(-math.pi / 2.0, math.radians(6.0))
LARGEST = 150_000
"""Size of a picture's file [byte]."""


def alone(models: SceneModels, detail: CaseDetail) -> Iterator[PlacedScene]:
    """Robot, then person, each without the other and looking along +x."""
    agents = tuple(replace(agent, facing=0.0) for agent in models.agents)
    placed = placed_scene(replace(models, agents=agents), detail)
    for name in (ROBOT, HUMAN):
        own = replace(placed.models, trees={name: models.trees[name]})
        wrenches = tuple(wrench for wrench in placed.wrenches if wrench.agent == name)
        yield replace(placed, models=own, wrenches=wrenches)


def write(figure: Figure, stem: str) -> None:
    """Write a picture without its SVG."""
    with TemporaryDirectory() as folder:
        _, png = write_figure(figure, Path(folder), stem)
        path = PICTURES / png.name
        path.write_bytes(png.read_bytes())
    print(path, path.stat().st_size)
    assert path.stat().st_size < LARGEST, f"{path} is too large"


def main() -> None:
    """Solve and draw."""
    problem = build_problem(with_table(read_source(Path("problems") / "icub_lifting.toml")))
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
