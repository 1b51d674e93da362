"""The generated person: structure, signs, symmetry, and the joined segments against NumPy."""

import math
import xml.etree.ElementTree as ElementTree
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from evodesign.body.inertia import Inertia, total
from evodesign.body.placement import Placement
from evodesign.errors import InputError
from evodesign.human.anthropometry import Person, segments, sole_size
from evodesign.human.anthropometry_tables import Sex, ShoulderWidth
from evodesign.human.body import DEFAULT_JOINTS, HANDS, SOLES, TRUNK, human_tree
from evodesign.tree.model import Joint, JointKind, Tree
from tests.machine import leave_out

persons = st.builds(
    Person,
    st.floats(1.45, 2.05),
    st.floats(40.0, 140.0),
    st.sampled_from(Sex),
    st.sampled_from(ShoulderWidth),
)
few = settings(max_examples=15, deadline=None)
MAN = Person(1.8, 80.0, Sex.MALE)

SHARED_BY = {
    "lower_trunk": ("Pelvis", "L5"),
    "middle_trunk": ("L3", "T12"),
    "upper_trunk": ("T8", "LeftShoulder", "RightShoulder"),
    "head": ("Neck", "Head"),
    "upper_arm": ("LeftUpperArm",),
    "forearm": ("LeftForeArm",),
    "hand": ("LeftHand",),
    "thigh": ("LeftUpperLeg",),
    "shank": ("LeftLowerLeg",),
    "foot": ("LeftFoot", "LeftToe"),
}


def placements(tree: Tree, angles: Mapping[str, float]) -> dict[str, Placement]:
    """Placement of each link in the root's frame; joints that are not named stand at zero."""
    root_from = {tree.root: Placement()}
    for joint in tree.joints:
        turn = Placement(turned(joint, angles.get(joint.name, 0.0)))
        root_from[joint.child] = root_from[joint.parent] @ joint.parent_from_child @ turn
    return root_from


def turned(joint: Joint, angle: float) -> tuple[tuple[float, ...], ...]:
    """Rodrigues' formula."""
    x, y, z = joint.axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    matrix = np.eye(3) + math.sin(angle) * cross + (1.0 - math.cos(angle)) * cross @ cross
    return tuple(tuple(float(entry) for entry in row) for row in matrix)


def joined(bodies: list[Inertia]) -> tuple[float, np.ndarray, np.ndarray]:
    """Mass, centre and inertia of several bodies in one frame, by NumPy."""
    masses = np.array([body.mass for body in bodies])
    centers = np.array([body.center for body in bodies])
    center = masses @ centers / masses.sum()
    d = centers - center
    inertia = np.array([body.about_center for body in bodies]).sum(axis=0)
    inertia = (
        inertia + np.einsum("k,ki,ki->", masses, d, d) * np.eye(3) - np.einsum("k,ki,kj->ij", masses, d, d)
    )
    return masses.sum(), center, inertia


def published_body() -> ElementTree.Element:
    """The reference model of 48 joints, which lies beside the checkout and not in it."""
    path = Path(__file__).parents[3] / "shared/reference/sartore2022/human_subject04_48dof.urdf"
    if not path.exists():
        leave_out("the published models are not in the folder 'shared' beside the checkout")
    return ElementTree.parse(path).getroot()


def test_joints_and_links_have_the_names_of_the_published_body() -> None:
    published, ours = published_body(), human_tree(MAN)
    assert set(ours.actuated) == {joint.get("name") for joint in published.iter("joint")}
    frames = {*HANDS.values(), *SOLES.values()}
    assert set(ours.link_by_name) - frames == {link.get("name") for link in published.findall("link")}
    for joint in published.findall("joint"):
        twin = ours.joint_by_name[joint.get("name", "")]
        assert twin.parent == joint.find("parent").get("link")
        assert twin.child == joint.find("child").get("link")
        assert twin.axis == tuple(float(entry) for entry in joint.find("axis").get("xyz").split())


def test_ranges_are_those_of_the_published_body_but_for_the_signs_of_hip_flexion_and_toes() -> None:
    ours = human_tree(MAN)
    for joint in published_body().findall("joint"):
        name, limit = joint.get("name", ""), joint.find("limit")
        lower, upper = float(limit.get("lower")), float(limit.get("upper"))
        if name.endswith(("Hip_roty", "BallFoot_roty")):
            lower, upper = -upper, -lower
        twin = ours.joint_by_name[name]
        assert (twin.lower, twin.upper) == pytest.approx((lower, upper), abs=1e-4), name


def test_a_person_has_48_joints_of_which_33_move_by_default() -> None:
    tree = human_tree(MAN)
    assert len(tree.actuated) == 48
    assert len(set(DEFAULT_JOINTS)) == len(DEFAULT_JOINTS) == 33
    still = set(tree.actuated) - set(DEFAULT_JOINTS)
    assert len(still) == 15
    assert {name for name in still if "Right" not in name} == {
        "jT1C7_rotx",
        "jT1C7_roty",
        "jT1C7_rotz",
        "jC1Head_rotx",
        "jC1Head_roty",
        "jLeftC7Shoulder_rotx",
        "jLeftWrist_rotx",
        "jLeftWrist_rotz",
        "jLeftKnee_rotz",
        "jLeftBallFoot_roty",
    }
    assert tree.root == "Pelvis"
    assert {*HANDS.values(), *SOLES.values(), *TRUNK} <= set(tree.link_by_name)


@few
@given(persons)
def test_links_weigh_what_the_person_weighs(person: Person) -> None:
    mass = math.fsum(link.inertia.mass for link in human_tree(person).links)
    assert mass == pytest.approx(person.mass, rel=1e-12)


@few
@given(persons)
def test_standing_soles_touch_the_floor_and_the_head_reaches_the_stature(person: Person) -> None:
    tree = human_tree(person)
    hip_height = 0.530 * person.stature
    at = placements(tree, {})
    for side in ("left", "right"):
        sole = at[SOLES[side]].translation
        assert sole[2] + hip_height == pytest.approx(0.0, abs=1e-12)
    head = tree.link_by_name["Head"].looks[0]
    top = at["Head"].apply(head.link_from_look.translation)[2] + head.shape.radius
    assert top + hip_height == pytest.approx(person.stature, abs=1e-12)
    assert at["LeftUpperArm"].translation[2] + hip_height == pytest.approx(0.818 * person.stature, abs=1e-12)


@pytest.mark.parametrize(
    ("sex", "stature", "breadth"), [(Sex.MALE, 1.756, 0.289), (Sex.FEMALE, 1.628, 0.269)]
)
def test_the_chest_is_as_broad_as_measured_between_the_arms(sex: Sex, stature: float, breadth: float) -> None:
    """ANSUR II's means; the rest of the trunk is as broad as the hips, and hanging arms are clear of it."""
    tree = human_tree(Person(stature, 80.0, sex))
    widths = {name: tree.link_by_name[name].looks[0].shape.y for name in ("Pelvis", "L5", "L3", "T12", "T8")}
    assert widths.pop("T8") == pytest.approx(breadth, rel=0.01)
    assert set(widths.values()) == {0.191 * stature}
    at, arm = placements(tree, {}), tree.link_by_name["LeftUpperArm"].looks[0].shape
    assert at["LeftUpperArm"].translation[1] - arm.radius > breadth / 2.0 + 0.02


@few
@given(persons)
def test_sole_frames_stand_in_the_middle_of_the_soles(person: Person) -> None:
    at = placements(human_tree(person), {})
    length, width = sole_size(person)
    ankle, sole = at["LeftFoot"].translation, at["LeftSole"].translation
    assert sole[0] - ankle[0] == pytest.approx(0.25 * length, abs=1e-12)
    assert sole[1] == ankle[1] > width / 2.0


@few
@given(persons)
def test_links_join_to_the_published_segments(person: Person) -> None:
    tree = human_tree(person)
    at = placements(tree, {})
    expected = segments(person)
    for segment, links in SHARED_BY.items():
        bodies = [tree.link_by_name[link].inertia.moved(at[link]) for link in links]
        whole = expected[segment]
        mass, center, inertia = joined(bodies)
        assert mass == pytest.approx(whole.mass, rel=1e-12)
        assert center == pytest.approx(np.array(whole.center), abs=1e-12)
        scale = np.trace(np.array(whole.about_center))
        assert inertia == pytest.approx(np.array(whole.about_center), abs=1e-12 * scale)
        ours = total(bodies)
        assert ours.mass == pytest.approx(mass, rel=1e-12)
        assert np.array(ours.about_center) == pytest.approx(inertia, abs=1e-12 * scale)


@few
@given(persons)
def test_slabs_have_their_centres_in_their_middles(person: Person) -> None:
    tree = human_tree(person)
    at = placements(tree, {})
    for link, above in (("Pelvis", "L5"), ("L5", "L3"), ("L3", "T12"), ("T12", "T8"), ("Neck", "Head")):
        height = at[above].translation[2] - at[link].translation[2]
        assert tree.link_by_name[link].inertia.center == pytest.approx((0.0, 0.0, height / 2.0), abs=1e-12)


@few
@given(persons)
def test_every_body_is_physically_consistent_and_chain_links_weigh_nothing(person: Person) -> None:
    frames = {*HANDS.values(), *SOLES.values()}
    for link in human_tree(person).links:
        body = link.inertia
        if "_f" in link.name or link.name in frames:
            assert body == Inertia(), link.name
            continue
        inertia = np.array(body.about_center)
        assert body.mass > 0.0, link.name
        assert (inertia == inertia.T).all(), link.name
        small, middle, large = np.linalg.eigvalsh(inertia)
        assert small > 0.0, link.name
        assert small + middle >= large, link.name


@few
@given(persons, st.data())
def test_a_mirrored_posture_is_the_mirror_image(person: Person, data: st.DataObject) -> None:
    tree = human_tree(person)
    angles: dict[str, float] = {}
    for name in tree.actuated:
        joint = tree.joint_by_name[name]
        if "Left" in name:
            angle = data.draw(st.floats(joint.lower, joint.upper))
            angles[name] = angle
            angles[name.replace("Left", "Right")] = angle if name.endswith("roty") else -angle
        elif "Right" not in name and name.endswith("roty"):
            angles[name] = data.draw(st.floats(joint.lower, joint.upper))
    at = placements(tree, angles)
    flip = np.diag([1.0, -1.0, 1.0])
    for name, left in at.items():
        if "Right" in name:
            continue
        right = at[name.replace("Left", "Right")]
        assert flip @ left.translation == pytest.approx(np.array(right.translation), abs=1e-12)
        assert flip @ left.rotation @ flip == pytest.approx(np.array(right.rotation), abs=1e-12)


@few
@given(persons)
def test_right_side_is_exactly_the_mirrored_left_side(person: Person) -> None:
    tree = human_tree(person)
    flip = np.array([1.0, -1.0, 1.0])
    for link in tree.links:
        if "Right" in link.name:
            continue
        twin = tree.link_by_name[link.name.replace("Left", "Right")]
        assert twin.inertia.mass == link.inertia.mass
        assert (flip * link.inertia.center == twin.inertia.center).all()
        assert (np.outer(flip, flip) * link.inertia.about_center == twin.inertia.about_center).all()
        assert [look.shape for look in twin.looks] == [look.shape for look in link.looks]
        for look, other in zip(link.looks, twin.looks, strict=True):
            assert (flip * look.link_from_look.translation == other.link_from_look.translation).all()
    for joint in tree.joints:
        if "Right" in joint.name:
            continue
        twin = tree.joint_by_name[joint.name.replace("Left", "Right")]
        assert (flip * joint.parent_from_child.translation == twin.parent_from_child.translation).all()
        assert twin.parent_from_child.rotation == Placement().rotation
        assert twin.axis == joint.axis
        if twin is not joint:
            same = joint.axis[1] == 1.0
            wanted = (joint.lower, joint.upper) if same else (-joint.upper, -joint.lower)
            assert (twin.lower, twin.upper) == wanted


@pytest.mark.parametrize("side", ["Left", "Right"])
@pytest.mark.parametrize(
    ("joint", "extreme", "moved", "direction"),
    [
        ("Hip_roty", "lower", "LowerLeg", "forward"),  # flexion
        ("Hip_rotx", "abduction", "LowerLeg", "outward"),
        ("Knee_roty", "upper", "Foot", "backward"),
        ("Ankle_roty", "upper", "Toe", "down"),  # plantarflexion
        ("Elbow_rotz", "flexion", "Hand", "forward"),
        ("Shoulder_rotx", "abduction", "ForeArm", "up"),
        ("C7Shoulder_rotx", "abduction", "UpperArm", "up"),
        ("Wrist_rotx", "abduction", "Palm", "up"),  # extension: palms look down
        ("Wrist_rotz", "abduction", "Palm", "backward"),  # ulnar: thumbs look forward
    ],
)
def test_signs_of_the_ranges_are_anatomical(
    side: str, joint: str, extreme: str, moved: str, direction: str
) -> None:
    """From zero to the named end of its range, each joint moves the link the way that its name says."""
    tree = human_tree(MAN)
    name = f"j{side}{joint}"
    limits = tree.joint_by_name[name]
    left = side == "Left"
    angle = {
        "lower": limits.lower,
        "upper": limits.upper,
        "abduction": limits.upper if left else limits.lower,
        "flexion": limits.lower if left else limits.upper,
    }[extreme]
    link = f"{side}{moved}"
    before, after = (np.array(placements(tree, q)[link].translation) for q in ({}, {name: angle}))
    outward = 1.0 if left else -1.0
    axis, sign = {
        "forward": (0, 1.0),
        "backward": (0, -1.0),
        "outward": (1, outward),
        "up": (2, 1.0),
        "down": (2, -1.0),
    }[direction]
    assert sign * (after - before)[axis] > 0.02


def test_toes_bend_up_further_than_down() -> None:
    for side in ("Left", "Right"):
        joint = human_tree(MAN).joint_by_name[f"j{side}BallFoot_roty"]
        tip = Placement(turned(joint, joint.lower)).apply((0.07, 0.0, 0.0))
        assert tip[2] > 0.06
        assert -joint.lower > joint.upper > 0.0


def test_flexed_spine_leans_forward() -> None:
    tree = human_tree(MAN)
    for name in ("jL5S1_roty", "jL4L3_roty", "jL1T12_roty", "jT9T8_roty", "jT1C7_roty"):
        joint = tree.joint_by_name[name]
        assert placements(tree, {name: joint.upper})["Head"].translation[0] > 0.02
        assert joint.upper > -joint.lower > 0.0


def test_the_t_pose_lies_within_all_ranges() -> None:
    for joint in human_tree(MAN).joints:
        assert joint.lower <= 0.0 <= joint.upper
        assert (joint.lower < joint.upper) == (joint.kind is JointKind.REVOLUTE)


@few
@given(persons)
def test_a_small_change_of_the_person_changes_the_body_little(person: Person) -> None:
    stature, mass = min(person.stature * (1.0 + 1e-6), 2.05), min(person.mass * (1.0 + 1e-6), 140.0)
    other = Person(stature, mass, person.sex, person.shoulder_width)
    for link, near in zip(human_tree(person).links, human_tree(other).links, strict=True):
        assert near.inertia.mass == pytest.approx(link.inertia.mass, rel=1e-5)
        assert np.array(near.inertia.about_center) == pytest.approx(
            np.array(link.inertia.about_center), abs=1e-5
        )


def test_the_standing_centre_of_mass_is_near_the_pelvis() -> None:
    """Arms raised sideways lift it by some centimetres above the usual 0.55 to 0.57 of the stature."""
    for sex in Sex:
        tree = human_tree(Person(1.75, 70.0, sex))
        at = placements(tree, {})
        _, center, _ = joined([link.inertia.moved(at[link.name]) for link in tree.links])
        assert 0.55 < center[2] / 1.75 + 0.530 < 0.61
        assert center[1] == pytest.approx(0.0, abs=1e-15)


def test_a_person_outside_the_tables_has_no_body() -> None:
    with pytest.raises(InputError, match="stature_m"):
        human_tree(Person(1.2, 70.0, Sex.FEMALE))
