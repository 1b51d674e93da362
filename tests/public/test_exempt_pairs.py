"""Which pairs of public humanoids may overlap: by pinocchio's places and coal's triangles alone."""

from __future__ import annotations

from pathlib import Path

import pinocchio as pin
import pytest

from benchmarks.clear_robots import ROBOTS, guessed
from benchmarks.independent_overlaps import Body, overlaps
from evodesign.collision.pairs import JOINED, STILL
from evodesign.problem.collisions import may_overlap
from evodesign.tree.mesh_write import mesh_files
from evodesign.tree.urdf_write import urdf_text

pytestmark = pytest.mark.needs_robots


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:You passed package dir")
@pytest.mark.parametrize("name", ["g1", "gr1"])
def test_moving_bodies_that_may_overlap_do_so_in_the_unscaled_robot(name: str, tmp_path: Path) -> None:
    """Hulls of waists, hips and ankles overlap where their meshes do not."""
    _, problem = guessed(ROBOTS[name], tmp_path)
    robot = problem.scene.robot
    names, files = mesh_files(robot.tree, "meshes")
    for file, content in files.items():
        (tmp_path / file).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / file).write_bytes(content)
    body = Body(urdf_text(robot.tree, names), tmp_path)
    at_zero = {frozenset(pair) for pair in overlaps(body.placed({}, pin.SE3.Identity()), None)}
    exempt = {pair for pair, why in may_overlap(robot).items() if why not in (JOINED, STILL)}
    assert not [pair for pair in exempt if frozenset(pair) not in at_zero]
    assert len(robot.collisions.checked) > 500
