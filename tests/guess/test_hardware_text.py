"""The part of a new problem file that is commented out works as soon as its # are gone."""

from __future__ import annotations

import math
import re
import tomllib
from dataclasses import replace

import pytest

from evodesign.body.placement import Placement
from evodesign.evaluation.evaluate import Evaluator
from evodesign.guess.body_plan import body_plan
from evodesign.guess.hardware_text import hardware_text
from evodesign.guess.problem_text import guessed_problem
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.records import ProblemSource
from evodesign.tree.frames import link_frames
from evodesign.tree.model import Tree
from evodesign.tree.urdf_write import urdf_text
from tests.guess.humanoid import Build, humanoid

YAWS = (0.0, math.pi / 2.0, math.pi)


def without_marks(text: str) -> str:
    """The text with every # gone that is the first of its line and has no space behind it."""
    return re.sub(r"^#(?=\S|$)", "", text, flags=re.MULTILINE)


def built(tree: Tree, change: dict[str, str] | None = None) -> DesignProblem:
    text = without_marks(guessed_problem(tree, "robot.urdf").text)
    for old, new in (change or {}).items():
        assert old in text
        text = text.replace(old, new)
    text += "\n[solver]\ncompile = false\nstart_portfolio = false\n"
    return build_problem(ProblemSource(path="p.toml", text=text, files={"robot.urdf": urdf_text(tree)}))


@pytest.mark.parametrize("yaw", YAWS)
def test_without_its_marks_the_block_is_part_of_a_problem(yaw: float) -> None:
    problem = built(humanoid(Build(yaw)))
    groups = {parameter.name: parameter.joints for parameter in problem.space.parameters if parameter.joints}
    assert [*groups] == [f"margin.{n}" for n in ("hip", "knee", "ankle", "shoulder", "elbow", "torso")]
    assert sorted(joint for joints in groups.values() for joint in joints) == sorted(
        problem.scene.robot.joints
    )
    assert groups["margin.knee"] == ("left_knee", "right_knee")
    assert [stance.name for stance in problem.stances] == ["squat", "one leg"]
    assert len(problem.space.walls) == 1


def test_with_its_marks_it_changes_nothing() -> None:
    text = guessed_problem(humanoid(Build()), "robot.urdf").text
    tables = tomllib.loads(text)
    assert "load_case" not in tables
    assert {*tables["design"]} == {"allocation", "length"}


@pytest.mark.slow
def test_a_design_with_hardware_is_evaluated() -> None:
    problem = built(humanoid(Build()), {"[collisions]  # nothing passes through anything": ""})
    problem = replace(problem, tasks=problem.tasks[1:2])
    result = Evaluator(problem).solve(problem.space.unscaled(problem.scene.robot.tree))
    assert all(case.solved for case in result.cases)
    assert len(result.rated) == len(problem.space.parameters)


@pytest.mark.parametrize("yaw", YAWS)
@pytest.mark.parametrize("knee", [(-0.05, 2.4), (-2.4, 0.05)])
def test_in_a_squat_the_knees_are_ahead_of_the_hips(yaw: float, knee: tuple[float, float]) -> None:
    tree = humanoid(Build(yaw, knee=knee, toe=0.05))
    plan = body_plan(tree)
    squat = tomllib.loads(without_marks("\n".join(hardware_text(plan))))["load_case"][0]
    angles = {joint: math.radians(angle) for joint, angle in squat["joints_deg"].items()}
    assert sorted(abs(angle) for angle in squat["joints_deg"].values()) == [35.0, 35.0, 45.0, 45.0]
    assert plan.facing is not None
    places = link_frames(tree, Placement(), angles)

    def ahead(link: str) -> float:
        return sum(a * b for a, b in zip(places[link].translation, plan.facing.ahead, strict=True))

    for side in ("left", "right"):
        knee_name = plan.legs[side].bodies[plan.legs[side].bend].name
        assert ahead(knee_name) > ahead(plan.legs[side].bodies[0].name) + 0.1


def test_a_robot_of_meshes_gets_no_walls_and_is_told_why() -> None:
    tree = humanoid(Build())
    links = (
        replace(each, solids=(), own_inertia=each.inertia) if each.solids else each for each in tree.links
    )
    bare = Tree(tree.name, tuple(links), tree.joints)
    text = "\n".join(hardware_text(body_plan(bare)))
    assert "design.wall]]\n" not in text
    assert "# no [[design.wall]]: that is for links of boxes, cylinders and spheres." in text
    assert "#[[design.actuator]]" in text
