"""The mean of a robot and its mirror image is symmetric, and is that mean by pinocchio's account, too."""

from __future__ import annotations

from cProfile import Profile
from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from evodesign.body.inertia import Inertia
from evodesign.body.placement import Placement
from evodesign.body.shape import Sphere
from evodesign.errors import ModelError
from evodesign.tree.averaging import averaged
from evodesign.tree.frames import link_frames
from evodesign.tree.mirror_images import Figure, differences, near, seen_in_root
from evodesign.tree.model import Joint, JointKind, Link, Look, Mesh, Tree
from evodesign.tree.resize import resize
from evodesign.tree.symmetry import mirror_of
from evodesign.tree.urdf_write import urdf_text
from tests.oracles.pinocchio_model import floating_model
from tests.tree.nearly_symmetric import FLIP, SMALL, Robot, Slack, inverse, robot

SEEDS = range(20)


def model_of(tree: Tree) -> tuple[pin.Model, pin.Data]:
    model = floating_model(urdf_text(tree))
    return model, model.createData()


def changed(tree: Tree, joint: str = "", link: str = "", **figures: object) -> Tree:
    """The tree with other figures of one joint or of one link's own inertia."""
    joints = tuple(replace(each, **figures) if each.name == joint else each for each in tree.joints)
    links = tuple(
        replace(each, own_inertia=replace(each.own_inertia, **figures)) if each.name == link else each
        for each in tree.links
    )
    return Tree(tree.name, links, joints)


# Pairs


@pytest.mark.parametrize("slack", [Slack(), SMALL], ids=["exact", "small differences"])
@pytest.mark.parametrize("slid", [False, True], ids=["", "slid"])
def test_pairs_of_twenty_robots_are_right_whatever_their_frames_axes_order_and_names(
    slack: Slack, slid: bool
) -> None:
    for seed in SEEDS:
        made = robot(seed, slack, slid=slid)
        mirror = mirror_of(averaged(made.tree).tree)
        for one, other in made.partners.items():
            assert mirror.links[made.names[one]] == made.names[other], f"robot {seed}"
        assert not mirror.loose


def test_an_exact_robot_with_turned_frames_is_symmetric_as_it_is() -> None:
    for seed in SEEDS:
        made = robot(seed, Slack())
        mirror = mirror_of(made.tree)
        assert mirror.links[made.names["arm_roll"]] == made.names["arm_roll'"]
        lefts = {made.names[key] for key in made.partners if key not in {"root", "torso", "head"}}
        assert mirror.left == lefts, "branches that begin on the middle line are told by what hangs below"


def test_largest_differences_are_named_with_their_size() -> None:
    for seed in SEEDS:
        made = robot(seed)
        largest = {each.figure: each for each in averaged(made.tree).largest}
        for figure, known in ((Figure.PLACE, made.placed), (Figure.MASS, made.weighed)):
            worst = max(known, key=lambda key: known[key])
            pair = {made.names[worst], made.names[f"{worst}'"]}
            assert set(largest[figure].names) == pair
            assert largest[figure].size == pytest.approx(known[worst], rel=0.01)  # across either axis
        assert largest.keys() == set(Figure), "every figure differs somewhere"


@pytest.mark.parametrize("key", ["leg_bend'", "leg_end'"])
def test_a_frame_of_no_mass_needs_no_partner_and_a_link_does(key: str) -> None:
    made = robot(3, Slack())
    name = made.names[key]
    shifted = Placement(translation=(0.0, 0.0, 0.01))
    tree = changed(
        made.tree, name, parent_from_child=shifted @ made.tree.joint_by_name[name].parent_from_child
    )
    if key == "leg_end'":
        assert mirror_of(tree).loose == {name, made.names["leg_end"]}
        return
    with pytest.raises(ModelError, match=f"joint ({name}|{made.names['leg_bend']}): wanted a mirror image"):
        mirror_of(tree)
    with pytest.raises(ModelError, match=r"found [0-9.]+ mm in the place of joint .* \(1.8 mm allowed\)"):
        averaged(tree)


def test_frames_at_one_place_are_paired_by_their_names() -> None:
    place = Placement(translation=(0.1, 0.0, 0.2))
    names = ("eye_a", "left_eye", "eye_b", "right_eye", "LTip", "RTip")
    joints = tuple(Joint(f"j_{name}", JointKind.FIXED, "root", name, place) for name in names)
    tree = Tree("eyes", (Link("root"), *(Link(name) for name in names)), joints)
    links = mirror_of(tree).links
    assert links["left_eye"] == "right_eye"
    assert links["LTip"] == "RTip"
    assert links["eye_a"] == "eye_a"


@pytest.mark.parametrize("apart", [True, False])
def test_links_on_the_root_are_paired_without_trying_all_with_all(apart: bool) -> None:
    few, many = calls_of_pairing(150, apart), calls_of_pairing(600, apart)
    assert many < 6 * few, "n log n; all with all would be 16 times as many"


def calls_of_pairing(count: int, apart: bool) -> int:
    """How many functions are called while so many links of a side find their partners."""
    rng = np.random.default_rng(1)
    links, joints = [Link("root", own_inertia=Inertia(1.0))], []
    for number in range(count):
        place = rng.uniform(-1.0, 1.0, 3) if apart else np.array([0.1, 0.2, 0.3])
        for side, where in (("a", place), ("b", place * FLIP)):
            name = f"{side}{number}"
            links.append(Link(name, own_inertia=Inertia(0.01)))
            joints.append(
                Joint(name, JointKind.FIXED, "root", name, Placement(translation=tuple(where.tolist())))
            )
    tree, profile = Tree("brush", tuple(links), tuple(joints)), Profile()
    mirror = profile.runcall(mirror_of, tree)
    assert all(mirror.links[f"a{number}"][0] == "b" for number in range(count))
    return sum(each.callcount for each in profile.getstats())


# Averages


@pytest.fixture(
    scope="module", params=[(False, False), (True, False), (False, True)], ids=["", "solid", "slid"]
)
def robots(request: pytest.FixtureRequest) -> list[Robot]:
    solid, slid = request.param
    return [robot(seed, solid=solid, slid=slid) for seed in SEEDS]


def test_mean_has_the_mean_mass_and_centre_that_pinocchio_finds(robots: list[Robot]) -> None:
    for made in robots:
        (model, data), (mean, mean_data) = model_of(made.tree), model_of(averaged(made.tree).tree)
        assert pin.computeTotalMass(mean) == pytest.approx(pin.computeTotalMass(model), rel=1e-12)
        center = pin.centerOfMass(model, data, pin.neutral(model))
        found = pin.centerOfMass(mean, mean_data, pin.neutral(mean))
        solid = any(
            link.solids for link in made.tree.links
        )  # their centre is the shapes' mean, not the mass's
        assert np.allclose(found, (center + FLIP * center) / 2.0, atol=1e-5 if solid else 1e-12)


def test_mean_has_the_mean_inertia_about_the_root_that_pinocchio_finds() -> None:
    for seed in SEEDS:
        made = robot(seed)
        tensors = []
        for tree in (made.tree, averaged(made.tree).tree):
            model, data = model_of(tree)
            q = pin.neutral(model)
            tensors.append(pin.crba(model, data, q)[:6, :6])  # the whole robot's, about the root
        mirror = np.diag([*FLIP, *-FLIP])
        assert np.allclose(tensors[1], (tensors[0] + mirror @ tensors[0] @ mirror) / 2.0, atol=1e-12)


def test_torques_of_the_mean_are_mirror_images_in_symmetric_postures(robots: list[Robot]) -> None:
    rng = np.random.default_rng(4)
    for made in robots:
        tree = averaged(made.tree).tree
        mirror = mirror_of(tree)
        model, data = model_of(tree)
        q, at = pin.neutral(model), {name: model.joints[model.getJointId(name)] for name in tree.actuated}
        for name in tree.actuated:
            other, sign = mirror.joints[name], mirror.signs[name]
            position = rng.uniform(-1.0, 1.0) if not (other == name and sign < 0.0) else 0.0
            q[at[name].idx_q], q[at[other].idx_q] = position, sign * position
        torques = pin.computeGeneralizedGravity(model, data, q)
        assert abs(torques).max() > 1.0
        for name in tree.actuated:
            here, there = torques[at[name].idx_v], torques[at[mirror.joints[name]].idx_v]
            assert there == pytest.approx(mirror.signs[name] * here, abs=1e-9)


def test_what_is_averaged_is_within_half_a_difference_of_the_file(robots: list[Robot]) -> None:
    for made in robots:
        result = averaged(made.tree)
        before, after = seen_in_root(made.tree), seen_in_root(result.tree)
        assert [link.name for link in result.tree.links] == [link.name for link in made.tree.links]
        assert [joint.name for joint in result.tree.joints] == [joint.name for joint in made.tree.joints]
        for name, seen in before.items():
            moved = after[name].place - seen.place
            moved -= (moved @ seen.axis) * seen.axis
            assert np.linalg.norm(moved) <= (SMALL.place + 0.03 * SMALL.axis) / 2.0 + 1e-12
            turned = np.array(after[name].frame.rotation) - np.array(seen.frame.rotation)
            assert abs(turned).max() <= 1e-12
            assert np.linalg.norm(np.cross(after[name].axis, seen.axis)) <= SMALL.axis / 2.0 + 1e-12


def test_what_is_seen_stays_where_it_is_when_a_frame_moves_along_its_axis() -> None:
    made = robot(4, slid=True)
    meshes = (Mesh("shank.stl", link_from_mesh=Placement.from_xyz_rpy((0.1, 0.2, 0.3), (0.4, 0.5, 0.6))),)
    looks = (Look(Sphere(0.01), Placement(translation=(0.1, 0.0, 0.2))),)
    links = tuple(replace(link, looks=looks, meshes=meshes) for link in made.tree.links)
    tree = replace(made.tree, links=links)
    mean = averaged(tree).tree
    before, after = (link_frames(each, Placement(), {}) for each in (tree, mean))
    moved = 0.0
    for link in mean.links:
        for new, old in (
            (link.meshes[0].link_from_mesh, meshes[0].link_from_mesh),
            (link.looks[0].link_from_look, looks[0].link_from_look),
        ):
            here, there = before[link.name] @ old, after[link.name] @ new
            assert np.allclose(here.translation, there.translation, atol=1e-12)
            assert np.allclose(here.rotation, there.rotation, atol=1e-12)
            moved = max(moved, float(np.abs(np.subtract(new.translation, old.translation)).max()))
    assert moved > 0.005


def test_limits_are_what_both_sides_allow_and_efforts_the_weaker_side_s() -> None:
    for seed in SEEDS:
        made = robot(seed)
        result = averaged(made.tree)
        mirror = mirror_of(result.tree)
        for joint in result.tree.joints:
            if joint.kind is JointKind.FIXED:
                continue
            own = made.tree.joint_by_name[joint.name]
            other = made.tree.joint_by_name[mirror.joints[joint.name]]
            sign = mirror.signs[joint.name]
            its = (other.lower, other.upper) if sign > 0 else (-other.upper, -other.lower)
            assert (joint.lower, joint.upper) == (max(own.lower, its[0]), min(own.upper, its[1]))
            assert joint.effort == min(own.effort, other.effort)
        unequal = [pair for pair in result.weaker if pair[2] != pair[3]]
        assert ("of different effort limits the smaller counts (" in str(result)) == bool(unequal)


def test_a_resized_mean_is_symmetric() -> None:
    rng = np.random.default_rng(5)
    for seed in SEEDS:
        made = robot(seed, solid=True, slid=seed % 2 == 0)
        tree = averaged(made.tree).tree
        mirror = mirror_of(tree)
        lengths: dict[str, float] = {}
        densities: dict[str, float] = {}
        for link in tree.links:
            if link.solids:
                for chosen, bounds in ((lengths, (0.6, 1.8)), (densities, (500.0, 4000.0))):
                    chosen[link.name] = chosen.get(mirror.links[link.name], float(rng.uniform(*bounds)))
        assert len(lengths) > 8
        assert mirror_of(resize(tree, lengths, densities)).links == mirror.links


def test_a_mean_whose_links_keep_their_inertia_is_symmetric_when_stretched() -> None:
    rng = np.random.default_rng(6)
    for seed in SEEDS:
        tree = averaged(robot(seed, slid=seed % 2 == 0).tree).tree
        mirror = mirror_of(tree)
        lengths: dict[str, float] = {}
        for link in tree.links:
            moves = any(joint.kind is not JointKind.FIXED for joint in tree.child_joints[link.name])
            if link.inertia.mass > 0.0 and moves and link.name != tree.root:
                lengths[link.name] = lengths.get(mirror.links[link.name], float(rng.uniform(0.6, 1.8)))
        assert len(lengths) > 5
        assert mirror_of(resize(tree, lengths, {})).links == mirror.links


def test_the_mean_of_a_mean_is_itself(robots: list[Robot]) -> None:
    for made in robots:
        tree = averaged(made.tree).tree
        again = averaged(tree)
        assert again.largest == ()
        assert str(again) == "no figure differs"
        for one, other in zip(tree.joints, again.tree.joints, strict=True):
            assert np.allclose(
                one.parent_from_child.translation, other.parent_from_child.translation, atol=1e-12
            )


def test_a_link_of_the_middle_is_averaged_with_its_own_image() -> None:
    made = robot(2, Slack())
    head = made.names["head"]
    off = made.tree.link_by_name[head].own_inertia
    frame = link_frames(made.tree, Placement(), {})[head]
    aside = inverse(Placement(frame.rotation)).apply((0.0, 0.0008, 0.0))
    center = tuple(a + b for a, b in zip(off.center, aside, strict=True))
    result = averaged(changed(made.tree, link=head, center=center))
    (only,) = result.largest
    assert str(only) == f"0.8 mm in the centre of mass of link {head} from the middle"
    assert np.allclose(result.tree.link_by_name[head].inertia.center, off.center, atol=1e-12)


# What does not correspond


def test_a_link_whose_shapes_do_not_correspond_keeps_the_mean_inertia_and_is_only_seen() -> None:
    made = robot(6, Slack(), solid=True)
    name, other = made.names["arm_bend"], made.names["arm_bend'"]
    link = made.tree.link_by_name[name]
    extra = replace(link.solids[0], shape=Sphere(0.002))
    links = tuple(
        replace(each, solids=(*each.solids, extra)) if each.name == name else each for each in made.tree.links
    )
    tree = replace(made.tree, links=links)
    result = averaged(tree).tree
    one, image = result.link_by_name[name], result.link_by_name[other]
    assert not one.solids
    assert [len(each.looks) for each in (one, image)] == [3, 2]
    masses = [tree.link_by_name[each].inertia.mass for each in (name, other)]
    assert one.inertia.mass == pytest.approx(sum(masses) / 2.0)
    assert image.inertia.mass == pytest.approx(sum(masses) / 2.0)
    mirror_of(result)
    assert result.link_by_name[made.names["leg_bend"]].solids


@pytest.mark.parametrize(
    ("figures", "words"),
    [
        ({"mass": 1.05}, r"\d\.\d+ % in the mass of link {one} / {other} \(2 % allowed\)"),
        ({"limit": 0.03}, r"1\.7 degrees in the limits of joint {one} / {other} \(1 degrees allowed\)"),
        ({"inertia": 1.5}, r"\d+ % in the inertia of link {one} / {other} \(5 % allowed\)"),
        ({"center": 0.016}, r"16 mm in the centre of mass of link {one} / {other} \(\d.* mm allowed\)"),
    ],
    ids=lambda value: next(iter(value)) if isinstance(value, dict) else "",
)
def test_a_pair_beyond_the_tolerance_is_named_with_what_differs_and_by_how_much(
    figures: dict[str, float], words: str
) -> None:
    made = robot(9, Slack())
    one, other = made.names["leg_bend"], made.names["leg_bend'"]
    own, joint = made.tree.link_by_name[one].own_inertia, made.tree.joint_by_name[one]
    match figures:
        case {"mass": factor}:
            tree = changed(made.tree, link=one, mass=own.mass * factor)
        case {"inertia": factor}:
            tensor = tuple(tuple(factor * x for x in row) for row in own.about_center)
            tree = changed(made.tree, link=one, about_center=tensor)
        case {"center": shift}:
            tree = changed(made.tree, link=one, center=(own.center[0] + shift, *own.center[1:]))
        case {"limit": shift}:
            tree = changed(made.tree, one, upper=joint.upper + shift)
    names = sorted([one, other], key=[each.name for each in tree.joints].index)
    with pytest.raises(ModelError, match=words.format(one=names[0], other=names[1])):
        averaged(tree)


def test_what_is_light_beside_the_robot_is_not_held_to_a_share_of_itself() -> None:
    """A camera of 10 g may sit where it likes; so may not a thigh."""
    made = robot(9, Slack())
    camera = Link("camera", own_inertia=Inertia(0.01, (0.0, 0.003, 0.0)))
    joint = Joint("camera", JointKind.FIXED, made.names["root"], "camera", Placement())
    tree = replace(made.tree, links=(*made.tree.links, camera), joints=(*made.tree.joints, joint))
    (only,) = averaged(tree).largest
    assert str(only) == "3 mm in the centre of mass of link camera from the middle"
    mass = sum(link.inertia.mass for link in tree.links)
    assert only.most == pytest.approx(3e-4 * mass / 0.01)
    with pytest.raises(ModelError, match=r"of link camera from the middle \(1.1 mm allowed\)"):
        averaged(changed(tree, link="camera", mass=20.0, about_center=np.eye(3).tolist()))


def test_differences_of_an_exact_pair_are_rounding() -> None:
    made = robot(11, Slack())
    seen = seen_in_root(made.tree)
    for one, other in made.partners.items():
        for each in differences(seen[made.names[one]], seen[made.names[other]], near(50.0)):
            assert each.size < 1e-9
