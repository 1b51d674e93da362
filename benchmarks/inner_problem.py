"""What benchmarks of the inner solver share: a problem at four heights, made ready, and random designs."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import msgspec
import numpy as np

from evodesign.evaluation.factory import cached_precomputed
from evodesign.pool.joblib_pool import JoblibPool
from evodesign.posture.check import AgentModel, Checker
from evodesign.posture.precompute.precomputed import Precomputed
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.source import read_source
from evodesign.records import ProblemSource
from evodesign.tree.resize import resize
from evodesign.tree.urdf_write import urdf_text

HERE = Path(__file__).parent
PROBLEM = HERE.parent / "problems" / "point_grasp.toml"
ROBOT = "robots/icub_shapes.urdf"
HEIGHTS = (0.8, 1.0, 1.2, 1.5)

Design = tuple[float, ...]


def longer_arm(source: ProblemSource) -> ProblemSource:
    """The robot's left forearm is 1.15 times as long as its right one."""
    tree = resize(build_problem(source).scene.robot.tree, {"l_forearm": 1.15}, {})
    return msgspec.structs.replace(source, files={**source.files, ROBOT: urdf_text(tree)})


def load_aside(source: ProblemSource) -> ProblemSource:
    """The load's centre of mass is 0.1 m to the robot's left of its middle."""
    text = source.text.replace("[payload]", "[payload]\ncenter_of_mass_m = [0.0, 0.1, 0.0]")
    return msgspec.structs.replace(source, text=text)


def pushed_aside(source: ProblemSource) -> ProblemSource:
    """The postures also withstand a push of 20 N on the robot's trunk from its right."""
    text = f'{source.text}\n[[disturbance]]\nat = "robot"\npush_n = [0.0, 20.0, 0.0]\n'
    return msgspec.structs.replace(source, text=text)


DEFAULT = "default"

VARIANTS: Mapping[str, Callable[[ProblemSource], ProblemSource]] = {
    DEFAULT: lambda source: source,
    "longer_arm": longer_arm,
    "load_aside": load_aside,
    "pushed_aside": pushed_aside,
}
"""The point-grasp problem, and what makes it one that is not its own mirror image."""


def problem_at(heights: Sequence[float], variant: str = DEFAULT) -> DesignProblem:
    """A variant of the point-grasp problem, its load at other heights."""
    source = VARIANTS[variant](read_source(PROBLEM))
    wanted = f"heights_m = {list(heights)}"
    lines = [wanted if line.startswith("heights_m") else line for line in source.text.splitlines()]
    return build_problem(msgspec.structs.replace(source, text="\n".join(lines)))


def problem_named(name: str) -> DesignProblem:
    """A variant at the heights of the benchmarks, or the problem of a file at its own."""
    return problem_at(HEIGHTS, name) if name in VARIANTS else build_problem(read_source(name))


def known_at(problem: DesignProblem, jobs: int) -> Precomputed:
    """What is known of the problem beforehand, from the user's cache or worked out now."""
    with JoblibPool(jobs) as pool:
        return cached_precomputed(problem, pool)


def random_designs(problem: DesignProblem, count: int) -> list[Design]:
    """Designs drawn uniformly between the problem's bounds, the same ones every time."""
    rng = np.random.default_rng(2022)
    points = rng.uniform(size=(count, len(problem.space.parameters))).tolist()
    return [problem.space.values(tuple(point)) for point in points]


def checker_of(problem: DesignProblem, design: Design) -> Checker:
    """The independent check of a design's postures."""
    scene = problem.scene
    tree = problem.space.resized(scene.robot.tree, design)
    return Checker(scene, AgentModel.of(scene.robot, tree), AgentModel.of(scene.human, scene.human.tree))


def processors() -> int:
    """Processors that this process may use."""
    return len(os.sched_getaffinity(0))
