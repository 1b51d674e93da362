"""Mirror partners are found by geometry, and what differs is named."""

from __future__ import annotations

from dataclasses import replace
from random import Random

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from evodesign.body.inertia import Inertia
from evodesign.body.placement import Placement
from evodesign.errors import ModelError
from evodesign.problem.build import DesignProblem
from evodesign.tree.mirror_pairs import Mirror
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
    robot, human = (mirror_of(agent.tree) for agent in problem.scene.agents)
    assert all(robot.joints[name] == "r_" + name[2:] for name in robot.joints if name.startswith("l_"))
    assert all(human.joints[name] == name.replace("Left", "Right") for name in human.joints if "Left" in name)


def is_image(tree: Tree, one: Joint, other: Joint, sign: float, tolerance: float) -> bool:
    """Whether joint and link are another's image, compared number by number; frames are not turned here."""
    place, image = one.parent_from_child.translation, other.parent_from_child.translation
    body, its = (tree.link_by_name[joint.child].own_inertia for joint in (one, other))
    pairs = [(place[0], image[0]), (place[1], -image[1]), (place[2], image[2]), (body.mass, its.mass)]
    if body.mass > 0.0:
        pairs += [(body.center[0], its.center[0]), (body.center[1], -its.center[1])]
    if one.kind is not JointKind.FIXED:
        turns = -1.0 if one.kind is JointKind.PRISMATIC else 1.0
        pairs += [(turns * sign * one.axis[k], m * other.axis[k]) for k, m in enumerate((-1.0, 1.0, -1.0))]
        limits = (one.lower, one.upper) if sign > 0.0 else (-one.upper, -one.lower)
        pairs += zip(limits, (other.lower, other.upper), strict=True)
    return one.kind is other.kind and all(a == b or abs(a - b) <= tolerance for a, b in pairs)


def is_bare(tree: Tree, joint: Joint) -> bool:
    """Whether nothing below a joint has mass or moves."""
    bare = joint.kind is JointKind.FIXED and tree.link_by_name[joint.child].own_inertia.mass == 0.0
    return bare and all(is_bare(tree, below) for below in tree.child_joints[joint.child])


def has_image(tree: Tree, one: str, other: str) -> bool:
    """Whether the branches below two links can be matched in any way, tried one after the other."""
    return matched(
        tree,
        [joint for joint in tree.child_joints[one] if not is_bare(tree, joint)],
        [joint for joint in tree.child_joints[other] if not is_bare(tree, joint)],
    )


def matched(tree: Tree, ours: list[Joint], theirs: list[Joint]) -> bool:
    if len(ours) != len(theirs):
        return False
    if not ours:
        return True
    first, *rest = ours
    for joint in theirs:
        fits = any(is_image(tree, first, joint, sign, 1e-9) for sign in (1.0, -1.0))
        others = [other for other in theirs if other is not joint]
        if fits and has_image(tree, first.child, joint.child) and matched(tree, rest, others):
            return True
    return False


JITTER = [0.0] * 60 + [4e-10, -9e-10, 1.1e-9, 3e-9]


def crowded_tree(random: Random, jitter: list[float] = JITTER) -> Tree:
    """Pairs and middle links of few places, masses, axes and ranges, most of them mirrored."""
    limits = [(-1.0, 1.0), (-0.2, 1.0), (-float("inf"), float("inf"))]
    links, joints, pairs = [Link("root", own_inertia=Inertia(1.0))], [], [("root", "root")]
    for number in range(random.randint(1, 14)):
        parents = random.choice(pairs)
        middle = parents[0] == parents[1] and random.random() < 0.4
        kind = random.choice([JointKind.FIXED, JointKind.REVOLUTE, JointKind.PRISMATIC])
        y = 0.0 if middle else random.choice([0.0, 0.1, 0.3])
        place = (random.choice([0.0, 0.5]), y, random.choice([0.0, 1.0]))
        mass = random.choice([0.0, 1.0, 2.0])
        center = (random.choice([0.0, 0.25]), 0.0 if middle else random.choice([0.0, 0.125]), 0.0)
        axis = random.choice([(0.0, 1.0, 0.0), (1.0, 0.0, 0.0)])
        turn = random.choice([1.0, 1.0, -1.0])
        lower, upper = (0.0, 0.0) if kind is JointKind.FIXED else random.choice(limits)
        names = []
        for side, parent in zip((1.0,) if middle else (1.0, -1.0), parents, strict=False):
            name = f"{random.choice('abcdef')}{number}{'lr'[side < 0.0]}"
            moved = (place[0] + random.choice(jitter), side * place[1] + random.choice(jitter), place[2])
            inertia = Inertia(max(mass + random.choice(jitter), 0.0), (center[0], side * center[1], 0.0))
            mirrored = axis if side > 0.0 else (-turn * axis[0], turn * axis[1], axis[2])
            links.append(Link(name, own_inertia=inertia))
            joints.append(
                Joint(name, kind, parent, name, Placement(translation=moved), mirrored, lower, upper)
            )
            names.append(name)
        pairs.append((names[0], names[-1]))
    random.shuffle(joints)
    return Tree("crowd", tuple(links), tuple(joints))


def outcome(tree: Tree) -> Mirror | None:
    """The mirror, if there is one."""
    try:
        return mirror_of(tree)
    except ModelError:
        return None


@given(st.randoms(use_true_random=False))
def test_partners_are_images_of_each_other_number_by_number(random: Random) -> None:
    tree = crowded_tree(random)
    mirror = outcome(tree)
    assume(mirror is not None)
    for joint in tree.joints:
        other = tree.joint_by_name[mirror.joints[joint.name]]
        assert mirror.joints[other.name] == joint.name
        if joint.child in mirror.loose:
            assert is_bare(tree, joint)
            continue
        assert mirror.links[joint.parent] == other.parent
        assert is_image(tree, joint, other, mirror.signs[joint.name], 3e-9), (
            "each of two places may be 1e-9 off"
        )


@given(st.randoms(use_true_random=False))
def test_a_mirror_is_found_where_trying_all_partners_finds_one(random: Random) -> None:
    tree = crowded_tree(random, jitter=[0.0])
    (root, *_) = tree.links
    assert (outcome(tree) is not None) == has_image(tree, root.name, root.name)


def test_about_as_many_crowded_trees_have_a_mirror_as_have_none() -> None:
    """The comparisons above compare something."""
    found = [outcome(crowded_tree(Random(seed))) for seed in range(200)]
    assert 40 < sum(each is not None for each in found) < 160
