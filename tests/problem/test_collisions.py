"""The `[collisions]` table: what it makes of a problem, and what is refused."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

import coal
import pinocchio as pin
import pytest

from evodesign.collision.pairs import checked_pairs
from evodesign.collision.rules import FLOOR, LOAD
from evodesign.errors import InputError
from evodesign.evaluation.evaluate import Evaluator
from evodesign.evaluation.gradients import assessed_gradients
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.model_json import model_json
from evodesign.records import ProblemSource, Status
from evodesign.tree.model import Tree
from evodesign.tree.urdf_write import urdf_text
from evodesign.violations import BODIES_APART, HEIGHT, violations


def with_table(problem: DesignProblem, *lines: str) -> ProblemSource:
    """The point-grasp problem with the table."""
    text = "\n".join((problem.source.text, "[collisions]", *lines, ""))
    return ProblemSource("p.toml", text, problem.source.files)


def refused(problem: DesignProblem, *lines: str) -> str:
    with pytest.raises(InputError) as caught:
        build_problem(with_table(problem, *lines))
    return str(caught.value)


def test_without_the_table_nothing_is_kept_apart(problem: DesignProblem) -> None:
    assert all(agent.collisions is None for agent in problem.scene.agents)
    assert "collisions" not in model_json(problem)


def test_pairs_are_found_ignored_and_added(problem: DesignProblem) -> None:
    built = build_problem(with_table(problem))
    rules = built.scene.robot.collisions
    assert rules is not None
    assert rules.margin == 0.005
    assert {("l_upper_leg", "r_upper_leg"), ("head", LOAD), ("l_hand", FLOOR)} <= set(rules.checked)
    assert ("l_hand", LOAD) not in rules.checked
    assert ("l_upper_leg", "l_lower_leg") not in rules.checked
    shown = model_json(built)["collisions"]
    assert shown["margin_m"] == 0.005
    assert ["head", LOAD] in shown["pairs"]["robot"]
    other = build_problem(
        with_table(
            problem,
            "margin_m = 0.01",
            'ignore = [["head", "load"], ["r_upper_leg", "l_upper_leg"]]',
            'part = [["l_hand", "load"]]',
        )
    ).scene.robot.collisions
    assert other is not None
    assert other.margin == 0.01
    assert set(rules.checked) - set(other.checked) == {("head", LOAD), ("l_upper_leg", "r_upper_leg")}
    assert other.parted[-1] == ("l_hand", LOAD)
    assert {pair[0] for pair in other.parted[:-1]} == {"l_ankle_2", "l_foot_rear", "l_foot_front"}
    assert build_problem(with_table(problem)).scene.robot.collisions == rules, "whatever was built in between"


def test_what_only_a_resized_robot_brings_together_is_checked_and_told(problem: DesignProblem) -> None:
    """Trunks with short links come down on their hips: that excuses no other design."""
    built = build_problem(with_table(problem))
    rules = built.scene.robot.collisions
    assert rules is not None
    assert {("torso_2", "l_hip_2"), ("root_link", "chest")} <= set(rules.checked)
    assert {("torso_2", "l_hip_2"), ("torso_2", "r_hip_2"), ("root_link", "chest")} <= set(rules.built_in)
    assert BODIES_APART in {constraint.name for constraint in built.constraints}
    exempt = {
        tuple(each["bodies"]): each["reason"] for each in model_json(built)["collisions"]["exempt"]["robot"]
    }
    assert exempt["root_link", "torso_1"] == "joined by a joint"
    assert not set(exempt) & set(rules.checked)


def test_a_build_that_leaves_bodies_nearer_than_asked_is_refused_before_they_touch(
    problem: DesignProblem,
) -> None:
    """Beside the shortest thigh the upper leg is 2.3 mm from the pelvis; flexed hips leave 5 mm nowhere."""
    built = build_problem(with_table(problem))
    rules, tree = built.scene.robot.collisions, built.scene.robot.tree
    pair = ("root_link", "l_upper_leg")
    assert rules is not None
    assert pair in rules.built_in
    assert deepest_at_zero(tree, pair) > 0.005
    unscaled = dict(built.space.named(built.space.unscaled(tree)))
    values = tuple((unscaled | {"length.thigh": 0.6}).values())
    distance = deepest_at_zero(built.space.resized(tree, values), pair)
    assert 0.0 < distance < 0.005
    found = Evaluator(built).assess_values(values).assessment
    assert found.status is Status.BODIES_OVERLAP
    assert found.constrained[BODIES_APART] == pytest.approx(distance - 0.005, abs=1e-6)
    assert "upper_leg while all joints are at zero: no posture was sought" in found.reason


@pytest.mark.slow
def test_a_design_whose_build_brings_bodies_together_is_infeasible_by_what_they_lack(
    problem: DesignProblem,
) -> None:
    built = build_problem(with_table(problem))
    unscaled = dict(built.space.named(built.space.unscaled(built.scene.robot.tree)))
    short = unscaled | dict.fromkeys(("length.torso_1", "length.torso_2", "length.chest"), 0.6)
    evaluator = Evaluator(built)
    values = tuple(short.values())
    found = evaluator.assess_values(values).assessment
    tree = built.space.resized(built.scene.robot.tree, values)
    deepest = min(deepest_at_zero(tree, pair) for pair in built.scene.robot.collisions.built_in)
    assert deepest < -0.02
    assert found.status is Status.BODIES_OVERLAP
    assert found.constrained[BODIES_APART] == pytest.approx(deepest - 0.005, abs=1e-6)
    missed = violations(built.constraints, found)[HEIGHT]
    assert missed is not None
    assert found.violation == pytest.approx(missed + 0.005 - deepest, abs=1e-6)
    assert f"{-1e3 * deepest:.2g} mm inside" in found.reason
    assert "while all joints are at zero" in found.reason
    assert not found.objectives.keys() & {"robot_torque", "human_torque"}
    whole = evaluator.solve(values)
    gradient = assessed_gradients(built, evaluator._sensitivities, values, whole).values[BODIES_APART]
    for name in ("length.torso_1", "length.chest", "length.thigh"):
        step, differences = 0.01, []
        for sign in (-1.0, 1.0):
            moved = built.space.resized(
                built.scene.robot.tree, tuple((short | {name: short[name] + sign * step}).values())
            )
            slacks = [
                deepest_at_zero(moved, pair) - built.scene.robot.collisions.margin_of(pair)
                for pair in built.scene.robot.collisions.built_in
            ]
            differences.append(min(slacks))
        parameter = next(p for p in built.space.records if p.name == name)
        slope = (differences[1] - differences[0]) / (2.0 * step) * (parameter.upper - parameter.lower)
        assert gradient[name] == pytest.approx(slope, abs=2e-4)


def deepest_at_zero(tree: Tree, pair: tuple[str, str]) -> float:
    """By coal, on shapes read from what the tree is written as."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "robot.urdf"
        path.write_text(urdf_text(tree))
        model = pin.buildModelFromUrdf(str(path))
        geometry = pin.buildGeomFromUrdf(model, str(path), pin.GeometryType.VISUAL)
    data, places = model.createData(), geometry.createData()
    pin.updateGeometryPlacements(model, data, geometry, places, pin.neutral(model))
    placed = [
        (
            model.frames[each.parentFrame].name,
            each.geometry,
            coal.Transform3s(where.rotation, where.translation),
        )
        for each, where in zip(geometry.geometryObjects, places.oMg, strict=True)
    ]
    return min(
        coal.distance(*one[1:], *other[1:], coal.DistanceRequest(), coal.DistanceResult())
        for one in placed
        for other in placed
        if (one[0], other[0]) == pair
    )


def test_what_cannot_be_meant_is_refused(problem: DesignProblem) -> None:
    wanted = "wanted a link of the robot or of a person, found 'hed'; did you mean 'head'?"
    assert wanted in refused(problem, 'ignore = [["hed", "chest"]]')
    assert "collisions.part[0]" in refused(problem, 'part = [["head", "LeftHand"]]')
    both = refused(problem, 'part = [["head", "load"]]', 'ignore = [["head", "load"]]')
    assert "wanted a pair that is not ignored, found 'head' and 'load' among those ignored" in both
    assert "margin_m" in refused(problem, "margin_m = -0.1")


def test_everyone_keeps_clear_of_the_same(problem: DesignProblem) -> None:
    """A pair that rests on each other in one person is no pair of the others: rows fit everybody's starts."""
    person = 'stature_m = 1.82\nmass_kg = 72.7\nsex = "male"'
    assert person in problem.source.text
    several = problem.source.text.replace(person, 'population = { sex = "both", percentiles = [5, 95] }')
    built = build_problem(ProblemSource("p.toml", f"{several}\n[collisions]\n", problem.source.files))
    alone = [
        set(checked_pairs(each.human.tree, each.human.joints, each.human.hand_frames, each.human.foot_frames))
        for each in built.scenes
    ]
    assert len(alone) == 4
    assert set.union(*alone) != set.intersection(*alone)
    for scene in built.scenes:
        assert scene.human.collisions is not None
        assert set(scene.human.collisions.checked) == set.intersection(*alone)
