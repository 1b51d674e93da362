"""What benchmarks of the inner solver share: the problem at four heights, made ready, and random designs."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

import msgspec
import numpy as np

from evodesign.pool.joblib_pool import JoblibPool
from evodesign.posture.check import AgentModel, Checker
from evodesign.posture.precompute.precomputed import Precomputed
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.factory import cached_precomputed
from evodesign.problem.source import read_source

HERE = Path(__file__).parent
PROBLEM = HERE.parent / "problems" / "icub_lifting.toml"
HEIGHTS = (0.8, 1.0, 1.2, 1.5)

Design = tuple[float, ...]


def problem_at(heights: Sequence[float]) -> DesignProblem:
    """The default problem, its load at other heights."""
    source = read_source(PROBLEM)
    wanted = f"heights_m = {list(heights)}"
    lines = [wanted if line.startswith("heights_m") else line for line in source.text.splitlines()]
    return build_problem(msgspec.structs.replace(source, text="\n".join(lines)))


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
