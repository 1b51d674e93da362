"""Pictures of bodies that keep clear of each other.

    python -m benchmarks.clear_pictures [--front RUN]

Of docs/benchmarks.md: the unscaled robot of point-grasp with a `[collisions]` table, and the person, at the
lowest and the highest load of the task: from the front, where each is drawn without the other, and from the
side. Of docs/default.md and docs/sharing.md, with a run of the default problem, or of the shared one with the
table: the designs of least robot torque and of least human torque with up to three people, likewise.
"""

from __future__ import annotations

import argparse
import math
from pathlib import Path
from tempfile import TemporaryDirectory

from matplotlib.figure import Figure
from PIL import Image

from benchmarks.clearance import with_table
from evodesign.analysis.front import front
from evodesign.evaluation.evaluate import detail_of
from evodesign.evaluation.factory import evaluator_of
from evodesign.mechanics.agent import HUMAN, ROBOT
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.source import read_source
from evodesign.quantities.design_result import DesignResult
from evodesign.report.figures.design import alone
from evodesign.report.figures.paint import write_figure
from evodesign.report.figures.posture_figure import Camera, posture_figure
from evodesign.report.scene_models import PlacedScene, SceneModels, placed_scene
from evodesign.report.subset import subsample
from evodesign.runlog.run import read_run

PICTURES = Path(__file__).parents[1] / "docs" / "pictures"
ABOVE = math.radians(6.0)
FRONT, SIDE = Camera(0.0, ABOVE), Camera(-math.pi / 2.0, ABOVE)
PEOPLE = 3
LARGEST = 150_000
"""Size of a picture's file [byte]."""


def write(figure: Figure, stem: str) -> None:
    """Write a picture in its 256 best colours."""
    path = PICTURES / f"{stem}.png"
    with TemporaryDirectory() as folder:
        _, png = write_figure(figure, Path(folder), stem)
        seen = Image.open(png).convert("RGB")
        seen.quantize(256, Image.Quantize.MAXCOVERAGE, kmeans=8).save(path, optimize=True)
    print(path, path.stat().st_size)
    assert path.stat().st_size < LARGEST, f"{path} is too large"


def draw(problem: DesignProblem, result: DesignResult, words: str, stem: str) -> None:
    """A design at the lowest and the highest height, with every person, from the side and from the front."""
    sides: list[PlacedScene] = []
    fronts: dict[str, list[PlacedScene]] = {ROBOT: [], HUMAN: []}
    for scene in subsample(problem.scenes, PEOPLE):
        own = [detail_of(case) for case in result.cases if case.case.pair == scene.pair]
        ends = sorted((own[0], own[-1]), key=lambda detail: detail.case.task.height_m)
        models = SceneModels.of(scene, result.tree)
        sides += [placed_scene(models, detail) for detail in ends]
        for detail in ends:
            for name, placed in zip(fronts, alone(placed_scene(models, detail)), strict=True):
                fronts[name].append(placed)
    write(posture_figure(sides, f"{words}, from the robot's right", SIDE), f"{stem}_side")
    for name, scenes in fronts.items():
        write(posture_figure(scenes, f"{words}: the {name} from the front", FRONT), f"{stem}_front_{name}")


def draw_ends(run: Path) -> None:
    """The designs at both ends of a front."""
    log = read_run(run)
    problem = build_problem(log.header.problem)
    evaluator, stem = evaluator_of(problem, 1), "shared" if "shared" in problem.name else "default"
    for agent in (ROBOT, HUMAN):
        name = f"{agent}_torque"
        best = min(
            front(log.header.objectives, log.evaluations), key=lambda each: each.assessment.objectives[name]
        )
        result = evaluator.solve(problem.space.values(best.genome))
        draw(problem, result, f"least {agent} torque", f"{stem}_{agent}")


def main() -> None:
    """Solve and draw."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--front", type=Path)
    run = parser.parse_args().front
    if run is not None:
        draw_ends(run)
        return
    problem = build_problem(with_table(read_source(Path("problems") / "point_grasp.toml")))
    result = evaluator_of(problem, 1).solve(problem.space.unscaled(problem.scene.robot.tree))
    draw(problem, result, "bodies apart", "apart")


if __name__ == "__main__":
    main()
