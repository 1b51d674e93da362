"""The published robot, resized: another one than ours, where the folder `shared` lies beside the checkout."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from evodesign.problem.build import DesignProblem
from evodesign.tree.model import Tree
from evodesign.tree.urdf_read import InertiaRule, read_urdf
from tests.tree.test_icub_robot import reference_text

NAME = "robot_reference.urdf"


def published_robots(problem: DesignProblem, rng: np.random.Generator, count: int) -> Iterator[Tree]:
    """Random designs of the published robot; it has the link names of ours, and other figures."""
    tree = read_urdf(reference_text(NAME), NAME, InertiaRule.SHAPES)
    for _ in range(count):
        values = problem.space.values(tuple(rng.uniform(size=len(problem.space.parameters))))
        yield problem.space.resized(tree, values)
