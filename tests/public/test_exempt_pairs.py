"""Public humanoids with meshes: which pairs may overlap, by pinocchio and coal, and that no others do."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path

import pinocchio as pin
import pytest

from benchmarks.clear_robots import ROBOTS, nearest, solved
from benchmarks.independent_overlaps import Body, overlaps
from evodesign.collision.pairs import JOINED, STILL
from evodesign.evaluation.evaluate import Evaluator
from evodesign.evaluation.factory import cached_precomputed
from evodesign.mechanics.agent import ROBOT
from evodesign.pool.worker import SerialPool
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.collisions import may_overlap
from evodesign.problem.source import read_source
from evodesign.tree.mesh_write import mesh_files
from evodesign.tree.urdf_write import urdf_text

pytestmark = [pytest.mark.needs_robots, pytest.mark.slow]

DEEPEST = 0.003
"""Of an overlap [m]."""


@pytest.fixture(scope="module")
def problem_of(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], DesignProblem]:
    """What `init` writes for a robot, with the tests' cache of compiled functions."""

    def found(name: str) -> DesignProblem:
        file = tmp_path_factory.mktemp(name) / "robot.toml"
        init = [sys.executable, "-m", "evodesign", "init", str(ROBOTS[name]), "--to", str(file)]
        subprocess.run(init, check=True, capture_output=True)
        return build_problem(read_source(file))

    return cache(found)


@pytest.mark.usefixtures("few_designs_meet")
def test_a_robot_of_which_nothing_is_said_holds_the_load_without_overlap(
    problem_of: Callable[[str], DesignProblem],
) -> None:
    apart = problem_of("gr1")
    problem = replace(apart, start_portfolio=False, tasks=(apart.tasks[0], apart.tasks[-1]))
    with SerialPool() as pool:
        evaluator = Evaluator(problem, cached_precomputed(problem, pool))
    result = solved(evaluator)
    assert all(case.solved for case in result.cases)
    assert nearest(result)["distance_m"] > -DEEPEST
    with_rows = sum(len(pairs) for (of, _), pairs in evaluator.known.meetings.items() if of == ROBOT)
    assert 0 < with_rows < len(problem.scene.robot.collisions.checked)


@pytest.mark.filterwarnings("ignore:You passed package dir")
@pytest.mark.parametrize("name", ["g1", "gr1"])
def test_moving_bodies_that_may_overlap_do_so_in_the_unscaled_robot(
    name: str, problem_of: Callable[[str], DesignProblem], tmp_path: Path
) -> None:
    """Hulls of waists, hips and ankles overlap where their meshes do not."""
    robot = problem_of(name).scene.robot
    names, files = mesh_files(robot.tree, "meshes")
    for file, content in files.items():
        (tmp_path / file).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / file).write_bytes(content)
    body = Body(urdf_text(robot.tree, names), tmp_path)
    at_zero = {frozenset(pair) for pair in overlaps(body.placed({}, pin.SE3.Identity()), None)}
    exempt = {pair for pair, why in may_overlap(robot).items() if why not in (JOINED, STILL)}
    assert not [pair for pair in exempt if frozenset(pair) not in at_zero]
    assert len(robot.collisions.checked) > 500
