"""Every search begins with the unscaled robot, whatever its problem file says."""

from __future__ import annotations

from pathlib import Path

import msgspec
import pytest

from evodesign.problem.build import build_problem
from evodesign.problem.designs import unscaled_genome
from evodesign.problem.source import read_source

START = 'start = "../populations/icub.toml"\n'


@pytest.fixture(scope="module")
def text(repository: Path) -> str:
    found = (repository / "problems/point_grasp.toml").read_text(encoding="utf-8")
    assert START in found
    return found


def test_without_a_population_the_unscaled_robot_is_the_only_start(repository: Path, text: str) -> None:
    source = read_source(repository / "problems/point_grasp.toml")
    problem = build_problem(msgspec.structs.replace(source, text=text.replace(START, "")))
    (genome,) = problem.start
    values = problem.space.named(problem.space.values(genome))
    assert all(values[name] == pytest.approx(1.0) for name in values if name.startswith("length."))
    assert genome == unscaled_genome(problem.space, problem.scene.robot.tree)


def test_a_population_without_it_comes_after_it(repository: Path, text: str) -> None:
    source = read_source(repository / "problems/point_grasp.toml")
    known = build_problem(source)
    name = "../populations/icub.toml"
    only = 'name = "own"\n\n[[design]]\nname = "long"\nlength = { thigh = 1.5 }\n'
    problem = build_problem(msgspec.structs.replace(source, files={**source.files, name: only}))
    assert len(problem.start) == 2
    assert problem.start[0] == known.start[0]


def test_outside_the_bounds_it_is_no_start(repository: Path, text: str) -> None:
    source = read_source(repository / "problems/point_grasp.toml")
    changed = text.replace(START, "").replace("lower = 0.6", "lower = 1.1")
    assert changed.count("lower = 1.1") > 0
    assert build_problem(msgspec.structs.replace(source, text=changed)).start == ()


@pytest.mark.parametrize("name", ["icub_hardware", "icub_lifting", "point_grasp", "shared_lifting"])
def test_it_begins_the_searches_of_shipped_problems(repository: Path, name: str) -> None:
    """Also where one of its values is zero, which a genome meets but for rounding."""
    problem = build_problem(read_source(repository / "problems" / f"{name}.toml"))
    values = problem.space.unscaled(problem.scene.robot.tree)
    assert problem.space.values(problem.start[0]) == pytest.approx(values, abs=1e-12)
