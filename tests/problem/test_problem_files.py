"""The problem files that come with the project."""

from __future__ import annotations

from pathlib import Path

import pytest

from evodesign.mechanics.payload import Grasp
from evodesign.posture.postures import Symmetry
from evodesign.problem.build import build_problem
from evodesign.problem.source import read_source
from evodesign.records import Hold

FILES = sorted((Path(__file__).parents[2] / "problems").glob("*.toml"))


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_every_problem_of_the_project_can_be_built(path: Path) -> None:
    problem = build_problem(read_source(path))
    assert len(problem.objectives) >= 1
    for genome in problem.start:
        assert len(genome) == len(problem.space.parameters)


def test_three_people_with_three_loads_are_nine_pairs() -> None:
    problem = build_problem(read_source(FILES[0].parent / "three_people_three_loads.toml"))
    pairs = {(scene.human.label, scene.payload.mass) for scene in problem.scenes}
    assert pairs == {(who, mass) for who in ("short", "middle", "tall") for mass in (5.0, 10.0, 15.0)}
    assert [task.height_m for task in problem.tasks] == [0.8, 1.0, 1.2]


def test_the_shared_load_is_rigidly_held_and_disturbed() -> None:
    problem = build_problem(read_source(FILES[0].parent / "shared_lifting.toml"))
    people = [scene.human.label for scene in problem.scenes]
    assert people == ["female P5", "female P95", "male P5", "male P95"]
    for scene in problem.scenes:
        assert (scene.payload.grasp, scene.payload.mass) == (Grasp.RIGID, 10.0)
        found = [(case.mass_share, case.push) for case in scene.disturbances.cases]
        assert found == [(0.2, (0.0, 0.0, 0.0)), (0.0, (20.0, 0.0, 0.0)), (0.0, (-20.0, 0.0, 0.0))]
    assert (problem.tasks[0], problem.tasks[-1]) == (Hold(height_m=0.4), Hold(height_m=1.6))
    assert problem.symmetry is Symmetry.ON
    assert "allocation.effort_ratio" in [parameter.name for parameter in problem.space.parameters]
