"""Mirror partners are found by geometry, and what differs is named."""

from __future__ import annotations

from dataclasses import replace

import pytest

from evodesign.body.inertia import Inertia
from evodesign.body.placement import Placement
from evodesign.errors import ModelError
from evodesign.problem.build import DesignProblem
from evodesign.tree.model import Joint, JointKind, Link, Tree
from evodesign.tree.symmetry import left_half, mirror_of


def bird(right_axis: tuple[float, float, float] = (-1.0, 0.0, 0.0), right_mass: float = 1.0) -> Tree:
    """body with two wings turning about x and a head turning about z."""

    def wing(name: str, y: float, axis: tuple[float, float, float], lower: float, upper: float) -> Joint:
        return Joint(
            name, JointKind.REVOLUTE, "body", name, Placement(translation=(0.1, y, 0.2)), axis, lower, upper
        )

    return Tree(
        "bird",
        (
            Link("body", own_inertia=Inertia(3.0)),
            Link("one", own_inertia=Inertia(1.0, (0.0, 0.3, 0.0))),
            Link("two", own_inertia=Inertia(right_mass, (0.0, -0.3, 0.0))),
            Link("head", own_inertia=Inertia(0.5, (0.1, 0.0, 0.1))),
            Link("camera"),
        ),
        (
            wing("one", 0.2, (1.0, 0.0, 0.0), -0.2, 1.0),
            wing("two", -0.2, right_axis, *((-0.2, 1.0) if right_axis[0] < 0.0 else (-1.0, 0.2))),
            Joint(
                "head",
                JointKind.REVOLUTE,
                "body",
                "head",
                Placement(translation=(0.3, 0.0, 0.3)),
                (0.0, 0.0, 1.0),
                -1.0,
                1.0,
            ),
            Joint(
                "camera",
                JointKind.FIXED,
                "head",
                "camera",
                Placement.from_xyz_rpy((0.1, 0.0, 0.0), (1.0, 0.2, 0.4)),
            ),
        ),
    )


@pytest.mark.parametrize(("axis", "sign"), [((-1.0, 0.0, 0.0), 1.0), ((1.0, 0.0, 0.0), -1.0)])
def test_sign_tells_whether_partners_turn_alike(axis: tuple[float, float, float], sign: float) -> None:
    mirror = mirror_of(bird(axis))
    assert mirror.joints["one"] == "two"
    assert mirror.joints["two"] == "one"
    assert mirror.signs["one"] == mirror.signs["two"] == sign
    assert mirror.signs["head"] == -1.0
    assert mirror.is_middle("head")
    assert mirror.is_middle("camera"), "a bare frame may be turned as it likes"


def test_left_half_keeps_the_middle_and_one_wing() -> None:
    tree = bird()
    part, doubled = left_half(tree, mirror_of(tree))
    assert sorted(part.link_by_name) == ["body", "camera", "head", "one"]
    assert doubled == {"one"}


def test_heavier_wing_is_named() -> None:
    with pytest.raises(ModelError, match=r"link one: .* found 'two', whose mass or shape differs"):
        mirror_of(bird(right_mass=1.1))


def test_missing_wing_is_named() -> None:
    tree = bird()
    lame = Tree(
        "bird",
        tuple(link for link in tree.links if link.name != "two"),
        tuple(j for j in tree.joints if j.name != "two"),
    )
    with pytest.raises(
        ModelError, match=r"joint one: wanted a mirror image .*, found none \(the nearest is 'head'\)"
    ):
        mirror_of(lame)


def test_lopsided_body_is_named() -> None:
    tree = bird()
    links = tuple(
        replace(link, own_inertia=Inertia(0.5, (0.1, 0.02, 0.1))) if link.name == "head" else link
        for link in tree.links
    )
    with pytest.raises(ModelError, match=r"link head: .* found a mass or shape that is not symmetric"):
        mirror_of(replace(tree, links=links))


def test_robot_and_person_pair_left_with_right(problem: DesignProblem) -> None:
    robot, human = (mirror_of(agent.tree) for agent in (problem.scene.robot, problem.scene.human))
    assert all(robot.joints[name] == "r_" + name[2:] for name in robot.joints if name.startswith("l_"))
    assert all(human.joints[name] == name.replace("Left", "Right") for name in human.joints if "Left" in name)
