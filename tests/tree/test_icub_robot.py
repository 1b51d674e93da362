from __future__ import annotations

import math
from io import BytesIO
from pathlib import Path

import mujoco
import numpy as np
import pytest
import yourdfpy
from lxml import etree

from evodesign.body.placement import Placement
from evodesign.body.shape import Box, Cylinder, Sphere
from evodesign.tree.model import JointKind, Tree
from evodesign.tree.urdf_read import InertiaRule, read_urdf
from evodesign.tree.urdf_write import UNLIMITED, urdf_text
from problems.robots.write_icub import TABLE, URDF, read_table, robot
from tests.machine import leave_out
from tests.oracles.pinocchio_model import carried_inertia, carriers, floating_model

REFERENCE = Path(__file__).resolve().parents[3] / "shared" / "reference" / "sartore2022"
MASS = 58.573865
FRAMES = {"base_link", "l_sole", "r_sole", "l_hand_frame", "r_hand_frame", "imu_frame"}
UNSCALED_DENSITIES = {
    "l_upper_arm": 1662,
    "l_forearm": 729,
    "l_hip_3": 601,
    "l_lower_leg": 2178,
    "root_link": 2129,
    "torso_1": 1199,
    "torso_2": 893,
    "chest": 627,
}


@pytest.fixture(scope="module")
def text() -> str:
    return URDF.read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def icub(text) -> Tree:
    return read_urdf(text, URDF.name, InertiaRule.SHAPES)


def reference_text(name: str) -> str:
    path = REFERENCE / name
    if not path.exists():
        leave_out("the published models are not in the folder 'shared' beside the checkout")
    return path.read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def reference() -> Tree:
    return read_urdf(reference_text("robot_reference.urdf"), "robot_reference.urdf", InertiaRule.SHAPES)


def other_side(name: str) -> str:
    return {"l_": "r_", "r_": "l_"}.get(name[:2], name[:2]) + name[2:]


FLIP = np.diag([1.0, -1.0, 1.0])


def mirrored(vector) -> np.ndarray:
    return FLIP @ np.array(vector)


def mirrored_matrix(matrix) -> np.ndarray:
    return FLIP @ np.array(matrix) @ FLIP


def total_mass(tree: Tree) -> float:
    return sum(link.inertia.mass for link in tree.links)


def assert_says_the_same(text: str, wanted: str):
    """The same elements and words; numbers up to the digits in which the sines of two machines may differ."""
    for mine, other in zip(attributes(text), attributes(wanted), strict=True):
        assert mine[:2] == other[:2]
        for word, wanted_word in zip(mine[2].split(), other[2].split(), strict=True):
            assert word == wanted_word or float(word) == pytest.approx(
                float(wanted_word), rel=1e-12, abs=1e-12
            )


def attributes(text: str) -> list[tuple[str, str, str]]:
    elements = etree.fromstring(text.encode()).iter()
    return [(element.tag, name, value) for element in elements for name, value in element.attrib.items()]


# The file


def test_the_committed_urdf_is_what_the_table_says(text):
    assert_says_the_same(urdf_text(robot(read_table(TABLE.read_text(encoding="utf-8")))), text)


def test_the_robot_read_and_written_says_the_same(text, icub):
    assert_says_the_same(urdf_text(icub), text)


# Bodies


def test_it_weighs_the_published_mass_without_the_dummies(icub):
    assert total_mass(icub) == pytest.approx(MASS, abs=1e-9)


def test_its_unscaled_densities_are_the_published_ones(icub):
    found = {name: icub.link_by_name[name].solids[0].density for name in UNSCALED_DENSITIES}
    assert {name: round(density) for name, density in found.items()} == UNSCALED_DENSITIES


def test_every_link_is_one_solid_or_a_bare_frame(icub):
    assert {link.name for link in icub.links if not link.solids} == FRAMES
    assert all(len(link.solids) == 1 for link in icub.links if link.name not in FRAMES)
    assert not any(link.looks or link.own_inertia.mass for link in icub.links)


def test_effort_and_velocity_are_unlimited(icub):
    assert {(joint.effort, joint.velocity) for joint in icub.joints} == {(math.inf, math.inf)}


# Mirror symmetry


def test_left_and_right_links_are_mirror_images(icub):
    pairs = [(link, icub.link_by_name[other_side(link.name)]) for link in icub.links if link.name[1] == "_"]
    assert len(pairs) == 38
    for link, image in pairs:
        assert [solid.shape for solid in link.solids] == [solid.shape for solid in image.solids]
        assert [solid.density for solid in link.solids] == [solid.density for solid in image.solids]
        assert link.inertia.mass == image.inertia.mass
        assert (mirrored(link.inertia.center) == image.inertia.center).all()
        assert (mirrored_matrix(link.inertia.about_center) == np.array(image.inertia.about_center)).all()


def test_links_in_the_middle_are_their_own_mirror_images(icub):
    middle = [link.inertia for link in icub.links if link.name[1] != "_"]
    assert len(middle) == 10
    for inertia in middle:
        assert inertia.center[1] == 0.0
        assert abs(np.array(inertia.about_center)[1, [0, 2]]).max() < 1e-18  # cos(pi/2) is 6e-17 in floats


def test_left_and_right_joints_are_mirror_images(icub):
    for joint in icub.joints:
        image = icub.joint_by_name[other_side(joint.name)]
        place, other = joint.parent_from_child, image.parent_from_child
        assert (image.parent, image.child) == (other_side(joint.parent), other_side(joint.child))
        assert (mirrored(place.translation) == other.translation).all()
        assert (image.kind, image.lower, image.upper) == (joint.kind, joint.lower, joint.upper)
        if image is not joint:
            assert (mirrored_matrix(place.rotation) == np.array(other.rotation)).all()
            assert joint.kind is JointKind.FIXED or (-mirrored(joint.axis) == image.axis).all()


def test_axes_are_exact(icub):
    for joint in icub.joints:
        assert sorted(map(abs, joint.axis)) == [0.0, 0.0, 1.0]


def test_soles_lie_on_the_bottom_faces_of_the_feet(icub):
    places = {link: place for link, (_, place) in carriers(icub).items()}
    for side in "lr":
        for foot in (f"{side}_foot_front", f"{side}_foot_rear"):
            (solid,) = icub.link_by_name[foot].solids
            bottom = places[foot] @ solid.link_from_solid
            sole = places[f"{side}_sole"]
            assert sole.rotation == bottom.rotation
            assert sole.translation[2] == pytest.approx(bottom.translation[2] - solid.shape.z / 2, abs=1e-15)


# Against the published robot


def test_names_are_those_of_the_published_robot(icub, reference):
    assert {link.name for link in icub.links} == {link.name for link in reference.links}
    assert {joint.name for joint in icub.joints} == {joint.name for joint in reference.joints}
    for joint in icub.joints:
        published = reference.joint_by_name[joint.name]
        assert (joint.parent, joint.child) == (published.parent, published.child)
        assert joint.kind is published.kind or joint.name == "r_wrist_yaw"


def places_at_rest(tree: Tree) -> dict[str, Placement]:
    places = {tree.root: Placement()}
    for joint in tree.joints:
        places[joint.child] = places[joint.parent] @ joint.parent_from_child
    return places


def published_place(places: dict[str, Placement], name: str) -> np.ndarray:
    """Middle of a published link's place and the mirror image of its partner's."""
    sides = (np.array(places[name].translation), mirrored(places[other_side(name)].translation))
    return (sides[0] + sides[1]) / 2.0


def test_at_rest_every_link_stands_where_the_published_one_does(icub, reference):
    places, published = places_at_rest(icub), places_at_rest(reference)
    for name, place in places.items():
        below = 0.00515 if name.endswith("_sole") else 0.0
        wanted = published_place(published, name) - [0.0, 0.0, below]
        np.testing.assert_allclose(place.translation, wanted, atol=5e-6, err_msg=name)


def test_axes_and_limits_are_the_published_ones(icub, reference):
    for joint in icub.joints:
        published = reference.joint_by_name[joint.name]
        if joint.kind is JointKind.FIXED:
            continue
        np.testing.assert_allclose(joint.axis, published.axis, atol=1e-6)
        if joint.name != "r_wrist_yaw":
            assert (joint.lower, joint.upper) == (published.lower, published.upper)


def test_shapes_are_the_published_bodies(icub, reference):
    """Volume, centre and inertia of unit density, whichever way the boxes' sides are listed."""
    for link in icub.links:
        published = reference.link_by_name[link.name]
        if link.name in FRAMES:
            continue
        (mine,), (other,) = link.solids, published.solids
        assert type(mine.shape) is type(other.shape)
        assert mine.shape.volume == pytest.approx(other.shape.volume, rel=1e-12)
        np.testing.assert_allclose(link.inertia.center, published.inertia.center, atol=1e-6)
        gyration, wanted = (
            np.array(body.inertia.about_center) / body.inertia.mass for body in (link, published)
        )
        tolerance = 3e-5 if link.name.endswith("wrist_1") else 1e-8  # its halves are not mirror images
        np.testing.assert_allclose(gyration, wanted, atol=tolerance, err_msg=link.name)


def test_masses_are_the_published_ones_averaged(icub, reference):
    for link in icub.links:
        if link.name not in FRAMES:
            pair = [reference.link_by_name[name].inertia.mass for name in (link.name, other_side(link.name))]
            assert link.inertia.mass == pytest.approx(sum(pair) / 2.0, rel=1e-12)


def test_the_published_robot_reads_with_its_shapes(reference):
    assert (len(reference.links), len(reference.joints), len(reference.actuated)) == (48, 47, 32)
    assert total_mass(reference) == pytest.approx(MASS + 4.0, abs=1e-9)
    kinds = [type(link.solids[0].shape) for link in reference.links if link.solids]
    assert (len(kinds), set(kinds)) == (42, {Box, Cylinder, Sphere})


def test_the_published_person_reads_with_the_inertia_of_the_file():
    person = read_urdf(reference_text("human_subject04_48dof.urdf"), "person.urdf", InertiaRule.FILE)
    assert (len(person.links), len(person.actuated)) == (49, 48)
    assert total_mass(person) == pytest.approx(72.70, abs=0.005)
    assert not any(link.solids for link in person.links)


# In other libraries


def test_pinocchio_builds_the_same_robot(text, icub):
    model = floating_model(text)
    inertias, places = carried_inertia(icub), carriers(icub)
    assert set(model.names) == {"universe", *inertias}
    for name, inertia in inertias.items():
        found = model.inertias[model.getJointId(name)]
        assert found.mass == pytest.approx(inertia.mass, abs=1e-12)
        np.testing.assert_allclose(found.lever, inertia.center, atol=1e-12)
        np.testing.assert_allclose(found.inertia, inertia.about_center, atol=1e-12)
    for name in icub.actuated:
        joint = icub.joint_by_name[name]
        place = places[joint.parent][1] @ joint.parent_from_child
        found = model.jointPlacements[model.getJointId(name)]
        np.testing.assert_allclose(found.rotation, place.rotation, atol=1e-12)
        np.testing.assert_allclose(found.translation, place.translation, atol=1e-12)


def test_pinocchio_sees_no_limit_on_effort(text):
    assert (floating_model(text).effortLimit[6:] == UNLIMITED).all()


def test_mujoco_loads_the_file_as_it_is(text):
    """It welds the root link to the world and drops its mass: a URDF has no floating base."""
    model = mujoco.MjModel.from_xml_string(text)
    assert (model.nq, model.nu) == (32, 0)
    assert model.body_mass.sum() == pytest.approx(MASS - 2.67135, abs=1e-9)


def test_mujoco_finds_the_same_bodies_when_it_keeps_them_apart(text, icub):
    spec = mujoco.MjSpec.from_string(text)
    spec.compiler.fusestatic = False
    spec.body("root_link").add_freejoint()
    model = spec.compile()
    assert model.body_mass.sum() == pytest.approx(MASS, abs=1e-9)
    assert (model.nq, model.nbody) == (32 + 7, 48 + 1)
    for link in icub.links:
        body = model.body(link.name)
        if link.name in FRAMES:
            assert body.mass[0] == 0.0
            continue
        assert body.mass[0] == pytest.approx(link.inertia.mass, abs=1e-12)
        np.testing.assert_allclose(body.ipos, link.inertia.center, atol=1e-12)
        principal = np.linalg.eigvalsh(np.array(link.inertia.about_center))
        np.testing.assert_allclose(sorted(body.inertia), principal, atol=1e-12)


def test_yourdfpy_loads_it_and_finds_nothing_to_complain_about(text):
    urdf = yourdfpy.URDF.load(BytesIO(text.encode()))
    assert urdf.validate(), urdf.errors
    assert (urdf.base_link, urdf.num_dofs) == ("root_link", 32)
