"""What `init` guesses of a humanoid that is turned, named and ordered in any way."""

from __future__ import annotations

import math
import re
import tomllib
from dataclasses import replace
from random import Random

import numpy as np
import pytest

from evodesign.body.placement import Placement, Vector
from evodesign.body.shape import Box, Solid, Sphere
from evodesign.errors import ModelError
from evodesign.guess.body_plan import BodyPlan, body_plan
from evodesign.guess.contacts import contacts
from evodesign.guess.parameters import groups, load_guess
from evodesign.guess.problem_text import guessed_problem
from evodesign.problem.agent_tables import Facing
from evodesign.tree.frames import link_frames
from evodesign.tree.model import Joint, JointKind, Link, Look, Mesh, Tree
from evodesign.tree.surface import surface_of
from tests.guess.humanoid import Build, humanoid, leg_length

YAWS = {Facing.FORWARD: 0.0, Facing.LEFT: math.pi / 2.0, Facing.BACK: math.pi, Facing.RIGHT: -math.pi / 2.0}
NO_KNEE = (-2.0, 2.0)


def left(side: str) -> str:
    """Names that say nothing."""
    return {"left": "a_", "right": "b_"}[side]


def swapped(side: str) -> str:
    """Names of somebody who looks at the robot."""
    return {"left": "right_", "right": "left_"}[side]


def foot_names(plan: BodyPlan) -> dict[str, str]:
    return {side: leg.end.name for side, leg in plan.legs.items()}


@pytest.mark.parametrize("facing", Facing)
@pytest.mark.parametrize(
    ("build", "feet"),
    [
        (Build(), ("left_foot", "right_foot")),
        (Build(named=left), ("a_foot", "b_foot")),
        (Build(named=left, knee=NO_KNEE), ("a_foot", "b_foot")),
        (Build(knee=NO_KNEE, toe=0.0), ("left_foot", "right_foot")),
        (Build(named=swapped), ("right_foot", "left_foot")),
        (Build(toe=-0.05), ("left_foot", "right_foot")),
    ],
    ids=["all", "no names", "feet alone", "names alone", "knees against names", "knees against feet"],
)
def test_heading_and_sides_follow_from_knees_names_and_feet(
    facing: Facing, build: Build, feet: tuple[str, str]
) -> None:
    for seed in range(5):
        built = Build(YAWS[facing], build.named, build.knee, build.toe, order=Random(seed))
        plan = body_plan(humanoid(built))
        assert plan.facing is facing
        assert foot_names(plan) == dict(zip(("left", "right"), feet, strict=True))
        assert plan.arms["left"].end.name == feet[0].replace("foot", "hand")


def test_joints_are_those_between_hands_and_feet() -> None:
    plan = body_plan(humanoid(Build()))
    assert not [name for name in plan.joints if "bend" in name], "fingers"
    assert len(plan.joints) == 2 * 5 + 2 * 4 + 1
    assert [body.name for body in plan.trunk] == ["base", "chest"]
    assert plan.legs["left"].bodies[plan.legs["left"].bend].name == "left_shank"
    assert plan.arms["right"].bodies[plan.arms["right"].bend].name == "right_forearm"


def test_a_robot_whose_root_is_its_chest_has_the_same_limbs_and_joints() -> None:
    tree = humanoid(Build())
    waist = tree.joint_by_name["waist"]
    hanging = replace(
        waist, parent="chest", child="pelvis", parent_from_child=waist.parent_from_child.inverse
    )
    others = (joint for joint in tree.joints if joint.name not in ("waist", "turn"))
    links = tuple(link for link in tree.links if link.name != "base")
    plan, usual = body_plan(Tree("hanging", links, (hanging, *others))), body_plan(tree)
    assert sorted(plan.joints) == sorted(usual.joints)
    assert foot_names(plan) == foot_names(usual)
    assert [body.name for body in plan.trunk] == ["pelvis", "chest"]
    named = {group.name: group.links for group in groups(plan)}
    assert named == {group.name: group.links for group in groups(usual)}


@pytest.mark.parametrize("facing", Facing)
def test_knees_say_where_a_robot_looks_whose_feet_are_its_shanks(facing: Facing) -> None:
    tree = humanoid(Build(YAWS[facing], named=left, toe=0.0))
    joints = [replace(each, kind=JointKind.FIXED) if "ankle" in each.name else each for each in tree.joints]
    plan = body_plan(replace(tree, joints=tuple(joints)))
    assert (plan.facing, plan.why) == (facing, "knees say so")


def test_sides_that_are_named_twice_say_where_it_looks() -> None:
    build = Build(named=lambda side: f"{side}_leg_{side}_", knee=NO_KNEE, toe=0.0)
    plan = body_plan(humanoid(build))
    assert (plan.facing, plan.why) == (Facing.FORWARD, "names of the sides say so")


def test_nothing_says_where_it_looks() -> None:
    plan = body_plan(humanoid(Build(named=left, knee=NO_KNEE, toe=0.0)))
    assert (plan.facing, plan.why) == (None, "knees, names and feet do not say where it looks")


def test_segments_are_the_longest_on_either_side_of_knee_and_elbow() -> None:
    found = {group.name: (group.links, group.length) for group in groups(body_plan(humanoid(Build())))}
    assert found == {
        "upper_arm": (("left_upper_arm", "right_upper_arm"), pytest.approx(0.26)),
        "forearm": (("left_forearm", "right_forearm"), pytest.approx(0.24)),
        "thigh": (("left_thigh", "right_thigh"), pytest.approx(0.38)),
        "shank": (("left_shank", "right_shank"), pytest.approx(0.36)),
        "trunk": (("chest",), pytest.approx(0.36)),
    }


def test_a_chest_whose_frame_is_at_the_shoulders_is_lifted_by_the_link_below_it() -> None:
    """It grows upwards too, but carries the shoulders where its growth begins."""
    tree, up = humanoid(Build()), Placement(translation=(0.0, 0.0, 0.36))
    chest = tree.link_by_name["chest"]
    head = Solid(Box(0.1, 0.1, 0.3), Placement(translation=(0.0, 0.0, 0.15)), 600.0)
    links = [replace(chest, name="spine")]
    links += [replace(link, solids=(head,)) if link is chest else link for link in tree.links]
    joints = [Joint("top", JointKind.FIXED, "spine", "chest", up)]
    for joint in tree.joints:
        place, child = joint.parent_from_child, "spine" if joint.child == "chest" else joint.child
        lowered = up.inverse @ place if joint.parent == "chest" else place
        joints.append(replace(joint, child=child, parent_from_child=lowered))
    found = groups(body_plan(Tree("slim", tuple(links), tuple(joints))))
    assert [group.links for group in found if group.name == "trunk"] == [("spine",)]


@pytest.mark.parametrize("facing", Facing)
def test_soles_are_under_the_feet_level_and_ahead(facing: Facing) -> None:
    tree = humanoid(Build(YAWS[facing]))
    plan = body_plan(tree)
    found = contacts(plan)
    assert found.sole_size == pytest.approx((0.24, 0.1))
    places = link_frames(tree, Placement(), {})
    turn = np.array(Placement.from_xyz_rpy((0, 0, 0), (0, 0, YAWS[facing])).rotation)
    for side, sign in (("left", 1.0), ("right", -1.0)):
        sole = found.soles[side]
        place = places[sole.link] @ sole.place
        assert np.allclose(place.rotation, turn, atol=1e-12)
        assert np.allclose(turn.T @ place.translation, (0.05, sign * 0.1, -leg_length()), atol=1e-12)
        hand = found.hands[side]
        palm = turn.T @ (places[hand.link] @ hand.place).translation
        assert palm == pytest.approx((0.0, sign * 0.23, -0.1), abs=0.05)
    load = load_guess(plan, -leg_length())
    assert load.heights == (0.8, 1.05, 1.3)
    assert load.size[1] == pytest.approx(1.4 * 0.4, abs=0.03)


def with_feet(tree: Tree, change: dict[str, Link]) -> Tree:
    return Tree(tree.name, tuple(change.get(link.name, link) for link in tree.links), tree.joints)


def test_soles_of_meshes_are_those_of_their_vertices_or_guessed_from_the_inertia() -> None:
    tree = humanoid(Build())
    feet = {
        name: Link(
            name, own_inertia=tree.link_by_name[name].inertia, meshes=(Mesh("foot.stl", (0.001,) * 3),)
        )
        for name in ("left_foot", "right_foot")
    }
    corners = 1000.0 * np.array([(x, y, z) for x in (-0.1, 0.2) for y in (-0.04, 0.04) for z in (-0.08, 0.0)])
    slanted = np.vstack([corners, (400.0, 0.0, -50.0)])
    surface = surface_of(slanted, np.array([[0, 1, 2]]), 0.0)
    shown = {
        name: replace(foot, meshes=(replace(foot.meshes[0], surface=surface),)) for name, foot in feet.items()
    }
    found = contacts(body_plan(with_feet(tree, shown)))
    assert found.sole_size == (0.3, 0.08), "the toe cap is too high to stand on"
    assert found.soles["left"].place.translation == pytest.approx((0.05, 0.0, -0.08), abs=1e-5)
    wider = Look(Box(0.4, 0.3, 0.3), Placement())
    boxed = {name: replace(foot, looks=(wider,)) for name, foot in shown.items()}
    assert contacts(body_plan(with_feet(tree, boxed))).sole_size == (0.3, 0.08), "the box only collides"
    guessed = contacts(body_plan(with_feet(tree, feet)))
    assert guessed.sole_size == pytest.approx((0.24, 0.1), abs=1e-3), "a box has the box's inertia"
    assert "to be checked" in guessed.why_soles


def test_soles_and_palms_are_fixed_to_feet_and_hands_that_no_joint_moves() -> None:
    """What is fixed to a shank or forearm does not grow with it, so the contact must be of what touches."""
    tree = humanoid(Build())
    still = [
        replace(each, kind=JointKind.FIXED) if re.search("ankle|wrist", each.name) else each
        for each in tree.joints
    ]
    found = contacts(body_plan(replace(tree, joints=tuple(still))))
    for side in ("left", "right"):
        assert (found.soles[side].link, found.hands[side].link) == (f"{side}_foot", f"{side}_hand")


def test_frames_of_the_hands_own_are_taken() -> None:
    tree = humanoid(Build())
    named = [Link(f"{side}_palm_frame") for side in ("left", "right")]
    joints = [
        Joint(f"{side}_fixed", JointKind.FIXED, f"{side}_hand", f"{side}_palm_frame", Placement())
        for side in ("left", "right")
    ]
    found = contacts(body_plan(Tree(tree.name, (*tree.links, *named), (*tree.joints, *joints))))
    assert {side: hand.frame for side, hand in found.hands.items()} == {
        "left": "left_palm_frame",
        "right": "right_palm_frame",
    }
    assert not found.hands["left"].link, "nothing is added"


def test_a_frame_called_hand_at_the_wrist_is_no_palm() -> None:
    tree = humanoid(Build())
    named = [Link(f"{side}_hand_frame") for side in ("left", "right")]

    def found(down: float) -> dict[str, str]:
        place = Placement(translation=(0.0, 0.0, -down))
        joints = [
            Joint(f"{side}_fixed", JointKind.FIXED, f"{side}_hand", f"{side}_hand_frame", place)
            for side in ("left", "right")
        ]
        built = Tree(tree.name, (*tree.links, *named), (*tree.joints, *joints))
        return {side: hand.frame for side, hand in contacts(body_plan(built)).hands.items()}

    assert found(0.0) == {"left": "left_palm", "right": "right_palm"}
    assert found(0.08) == {"left": "left_hand_frame", "right": "right_hand_frame"}


@pytest.mark.parametrize("shown", [True, False], ids=["shapes", "no shapes"])
def test_a_forearm_without_a_wrist_holds_with_its_far_end(shown: bool) -> None:
    tree = humanoid(Build())
    gone = {name for link in tree.links if "finger" in (name := link.name) or "hand" in name}
    links = [link for link in tree.links if link.name not in gone]
    if not shown:
        links = [Link(each.name, own_inertia=each.inertia) for each in links]
    joints = tuple(joint for joint in tree.joints if joint.child not in gone)
    plan = body_plan(Tree(tree.name, tuple(links), joints))
    found = contacts(plan)
    assert found.why_hands == "the far ends of forearms without wrists"
    hand = found.hands["left"]
    assert (hand.link, hand.place.translation) == ("left_forearm", pytest.approx((0.0, 0.0, -0.24), abs=1e-9))


def without_shapes(tree: Tree, feet_inertia: float) -> Tree:
    """The robot with nothing but masses; the principal moments of its feet are all the same [kg m^2]."""
    alike = tuple(tuple(feet_inertia * (i == j) for j in range(3)) for i in range(3))
    links = [Link(link.name, own_inertia=link.inertia) for link in tree.links]
    return replace(
        tree,
        links=tuple(
            replace(link, own_inertia=replace(link.inertia, about_center=alike))
            if link.name.endswith("foot")
            else link
            for link in links
        ),
    )


def test_soles_that_no_robot_of_its_stature_has_are_none_and_heights_stay_below_the_head() -> None:
    plan = body_plan(without_shapes(humanoid(Build()), 0.3))
    assert plan.stature == pytest.approx(leg_length() - 0.02 + 0.46), "from the feet to the shoulders"
    found = contacts(plan)
    assert (found.soles, found.sole_size) == ({}, (0.0, 0.0))
    assert re.match(r"1\.\d+ x 1\.\d+ m is more than a third of the robot's 1\.26 m \(boxes", found.why_soles)
    text = guessed_problem(plan.welded.tree, "robot.urdf").text
    assert 'soles = { left = "FILL IN", right = "FILL IN", size_m = "FILL IN" }  # FILL IN frames' in text
    assert "left_sole" not in text
    heights = tomllib.loads(text)["task"]["heights_m"]
    assert heights == [0.75, 0.95, 1.2], "above the ankles"


def test_a_robot_without_shapes_whose_feet_have_the_inertia_of_feet_stands_on_their_boxes() -> None:
    found = contacts(body_plan(without_shapes(humanoid(Build()), 0.001)))
    assert found.soles
    assert 0.05 < found.sole_size[0] < 0.4


@pytest.mark.parametrize(
    ("points", "words"),
    [
        ([(-0.4, -0.1, -0.1), (0.4, 0.1, -0.1)], "0.8 x 0.2 m is more than a third"),
        ([(0.0, 0.0, -0.1), (0.1, 0.0, -0.1)], "0.1 x 0 m is no sole to stand on"),
        ([(-0.1, -0.1, -2.0), (0.1, 0.1, -2.0)], "2 m below the last joints is deeper than the robot's"),
    ],
    ids=["too long", "a line", "in the ground"],
)
def test_soles_of_meshes_that_no_foot_has_are_none(points: list[Vector], words: str) -> None:
    tree = humanoid(Build())
    surface = surface_of(np.array([*points, points[0]], float), np.array([[0, 1, 2]]), 0.0)
    feet = {
        name: Link(
            name, own_inertia=tree.link_by_name[name].inertia, meshes=(Mesh("foot.stl", surface=surface),)
        )
        for name in ("left_foot", "right_foot")
    }
    found = contacts(body_plan(with_feet(tree, feet)))
    assert found.soles == {}
    assert found.why_soles.startswith(words)
    assert found.why_soles.endswith("(the lowest 2 cm of the feet's shapes)")


def test_a_shape_of_any_kind_makes_a_sole() -> None:
    tree = humanoid(Build())
    balls = {
        name: Link(
            name, own_inertia=tree.link_by_name[name].inertia, looks=(Look(Sphere(0.05), Placement()),)
        )
        for name in ("left_foot", "right_foot")
    }
    assert contacts(body_plan(with_feet(tree, balls))).sole_size == pytest.approx((0.1, 0.1))


def test_what_has_no_arms_has_no_hands() -> None:
    plan = body_plan(humanoid(Build(arms=False)))
    assert plan.arms == {}
    assert contacts(plan).hands == {}


def test_what_has_no_two_legs_is_refused() -> None:
    with pytest.raises(ModelError, match="humanoid: wanted two legs, found four or more"):
        body_plan(humanoid(Build(horse=True)))
    tree = humanoid(Build())
    fixed = {
        "left_knee",
        "right_knee",
        "left_hip_roll",
        "right_hip_roll",
        "left_ankle_roll",
        "right_ankle_roll",
    }
    joints = tuple(
        Joint(joint.name, JointKind.FIXED, joint.parent, joint.child, joint.parent_from_child)
        if joint.name in fixed
        else joint
        for joint in tree.joints
    )
    with pytest.raises(
        ModelError, match=r"wanted two legs, .* of at least 3 joints .* found none \(the lowest link"
    ):
        body_plan(Tree(tree.name, tree.links, joints))
