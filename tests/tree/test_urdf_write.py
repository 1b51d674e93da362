from __future__ import annotations

import math
from io import BytesIO

import casadi
import mujoco
import numpy as np
import pinocchio
import pytest
import yourdfpy
from hypothesis import given, settings
from hypothesis import strategies as st
from lxml import etree

from evodesign.body.inertia import Inertia
from evodesign.body.placement import Placement
from evodesign.body.shape import Box, Cylinder, Solid, Sphere
from evodesign.tree.model import Joint, JointKind, Link, Look, Tree
from evodesign.tree.urdf_read import InertiaRule, read_urdf
from evodesign.tree.urdf_write import UNLIMITED, urdf_text
from tests.oracles.pinocchio_model import carried_inertia, carriers, floating_model
from tests.pitches import pitches

TOLERANCE = 1e-12
INFINITE = math.inf

angle = st.floats(-math.pi, math.pi)
length = st.floats(0.01, 1.0)
offset = st.floats(-1.0, 1.0)
placements = st.builds(
    Placement.from_xyz_rpy, st.tuples(offset, offset, offset), st.tuples(angle, pitches, angle)
)
shapes = (
    st.builds(Sphere, length) | st.builds(Cylinder, length, length) | st.builds(Box, length, length, length)
)
looks = st.lists(st.builds(Look, shapes, placements), max_size=2).map(tuple)
densities = st.floats(100.0, 8000.0)
inertias = st.builds(Solid, shapes, placements, densities).map(lambda solid: solid.inertia)
limits = st.just(INFINITE) | st.floats(0.0, 1000.0)


@st.composite
def robot_links(draw, name):
    """A link as a robot has it: solids of one density, or an inertia of its own, or looks, or nothing."""
    if draw(st.booleans()):
        density = draw(densities)
        bodies = draw(st.lists(st.tuples(shapes, placements), min_size=1, max_size=4))
        return Link(name, solids=tuple(Solid(shape, place, density) for shape, place in bodies))
    if draw(st.booleans()):
        return Link(name, own_inertia=draw(inertias))
    return Link(name, looks=draw(looks))


@st.composite
def heavy_links(draw, name):
    """A link of a robot for a simulator: solids, or an inertia of its own."""
    return draw(robot_links(name).filter(lambda link: link.inertia.mass > 0.0))


@st.composite
def person_links(draw, name):
    """A link as a person has it: an inertia of its own, and looks."""
    return Link(name, own_inertia=draw(st.just(Inertia()) | inertias), looks=draw(looks))


@st.composite
def joints(draw, name, parent, child):
    kind = draw(st.sampled_from(JointKind))
    place = draw(placements)
    if kind is JointKind.FIXED:
        return Joint(name, kind, parent, child, place)
    raw = draw(st.tuples(*[st.integers(-5, 5)] * 3).filter(any))
    axis = tuple(x / math.hypot(*raw) for x in raw)
    lower, upper = sorted(draw(st.tuples(st.floats(-3.0, 3.0), st.floats(-3.0, 3.0))))
    if kind is JointKind.CONTINUOUS:
        lower, upper = -INFINITE, INFINITE
    return Joint(name, kind, parent, child, place, axis, lower, upper, draw(limits), draw(limits))


@st.composite
def trees(draw, links):
    names = [f"link {i} <é & 'ö'>" for i in range(draw(st.integers(1, 6)))]
    joined = tuple(
        draw(joints(f"joint {i}", draw(st.sampled_from(names[:i])), name))
        for i, name in enumerate(names)
        if i > 0
    )
    return Tree("anybody", tuple(draw(links(name)) for name in names), joined)


def assert_near(found, wanted):
    """The same to rounding, of which zeros beside large figures have as much as these."""
    numbers = np.array(wanted, float)
    least = TOLERANCE * max(1.0, np.abs(numbers).max(initial=0.0))
    np.testing.assert_allclose(np.array(found, float), numbers, rtol=TOLERANCE, atol=least)


def assert_same_place(found: Placement, wanted: Placement):
    assert_near(found.rotation, wanted.rotation)
    assert found.translation == wanted.translation


def assert_same_link(found: Link, wanted: Link):
    assert found.name == wanted.name
    assert [solid.shape for solid in found.solids] == [solid.shape for solid in wanted.solids]
    assert_near([solid.density for solid in found.solids], [solid.density for solid in wanted.solids])
    assert [look.shape for look in found.looks] == [look.shape for look in wanted.looks]
    for mine, other in zip(found.solids, wanted.solids, strict=True):
        assert_same_place(mine.link_from_solid, other.link_from_solid)
    for mine, other in zip(found.looks, wanted.looks, strict=True):
        assert_same_place(mine.link_from_look, other.link_from_look)
    assert_near(found.own_inertia.mass, wanted.own_inertia.mass)
    assert_near(found.own_inertia.center, wanted.own_inertia.center)
    assert_near(found.own_inertia.about_center, wanted.own_inertia.about_center)


def assert_same_joint(found: Joint, wanted: Joint):
    for field in ("name", "kind", "parent", "child", "lower", "upper", "effort", "velocity"):
        assert getattr(found, field) == getattr(wanted, field), field
    assert_same_place(found.parent_from_child, wanted.parent_from_child)
    assert_near(found.axis, wanted.axis)


def assert_same_tree(found: Tree, wanted: Tree):
    assert found.name == wanted.name
    for mine, other in zip(found.links, wanted.links, strict=True):
        assert_same_link(mine, other)
    for mine, other in zip(found.joints, wanted.joints, strict=True):
        assert_same_joint(mine, other)


@settings(max_examples=60, deadline=None)
@given(trees(robot_links))
def test_a_robot_written_and_read_is_the_same_robot(tree):
    assert_same_tree(read_urdf(urdf_text(tree), "written.urdf", InertiaRule.SHAPES), tree)


@settings(max_examples=40, deadline=None)
@given(trees(person_links))
def test_a_person_written_and_read_is_the_same_person(tree):
    assert_same_tree(read_urdf(urdf_text(tree), "written.urdf", InertiaRule.FILE), tree)


@settings(max_examples=20, deadline=None)
@given(trees(robot_links))
def test_writing_does_not_depend_on_who_wrote_before(tree):
    assert urdf_text(tree) == urdf_text(tree)
    assert "-0.0 " not in urdf_text(tree)
    assert '-0.0"' not in urdf_text(tree)


@settings(max_examples=40, deadline=None)
@given(trees(robot_links))
def test_pinocchio_finds_the_same_bodies_and_joints(tree):
    model = floating_model(urdf_text(tree))
    for name, inertia in carried_inertia(tree).items():
        found = model.inertias[model.getJointId(name)]
        assert_near(found.mass, inertia.mass)
        assert_near(found.inertia, inertia.about_center)
        assert_near(found.lever, inertia.center)
    places = carriers(tree)
    for joint in tree.joints:
        if joint.kind is not JointKind.FIXED:
            assert_pinocchio_has(model, joint, places[joint.parent][1] @ joint.parent_from_child)


def assert_pinocchio_has(model, joint: Joint, carrier_from_child: Placement):
    number = model.getJointId(joint.name)
    place = model.jointPlacements[number]
    assert_near(place.rotation, carrier_from_child.rotation)
    assert_near(place.translation, carrier_from_child.translation)
    column = model.idx_vs[number]
    jacobian = pinocchio.computeJointJacobian(model, model.createData(), pinocchio.neutral(model), number)
    linear = joint.kind is JointKind.PRISMATIC
    assert_near(jacobian[:3, column] if linear else jacobian[3:, column], joint.axis)
    assert model.effortLimit[column] == min(joint.effort, UNLIMITED)
    if joint.kind is not JointKind.CONTINUOUS:
        assert model.lowerPositionLimit[model.idx_qs[number]] == joint.lower
        assert model.upperPositionLimit[model.idx_qs[number]] == joint.upper


@settings(max_examples=20, deadline=None)
@given(trees(robot_links))
def test_yourdfpy_finds_nothing_to_complain_about(tree):
    urdf = yourdfpy.URDF.load(BytesIO(urdf_text(tree).encode()), build_scene_graph=False, load_meshes=False)
    assert urdf.validate(), urdf.errors


def floating_in_mujoco(tree: Tree) -> mujoco.MjSpec:
    """MuJoCo's description of a written tree, with every link a body of its own and a root that floats."""
    spec = mujoco.MjSpec.from_string(urdf_text(tree))
    spec.compiler.fusestatic = False
    spec.body(tree.root).add_freejoint()
    return spec


def assert_mujoco_has(model: mujoco.MjModel, tree: Tree, tolerance: float):
    """Places, masses, principal moments, axes and limits, within a tolerance [m, kg, kg m^2, rad, 1]."""
    for link in tree.links:
        body = model.body(link.name)
        assert body.mass[0] == pytest.approx(link.inertia.mass, rel=tolerance)
        if link.inertia.mass == 0.0:
            continue
        np.testing.assert_allclose(body.ipos, link.inertia.center, atol=tolerance)
        turn = np.zeros(9)
        mujoco.mju_quat2Mat(turn, body.iquat)
        axes = turn.reshape(3, 3)
        tensor = axes @ np.diag(body.inertia) @ axes.T
        scale = max(np.trace(np.array(link.inertia.about_center)), 1e-3)
        np.testing.assert_allclose(tensor, link.inertia.about_center, atol=tolerance * scale)
    for joint in tree.joints:
        body = model.body(joint.child)
        turn = np.zeros(9)
        mujoco.mju_quat2Mat(turn, body.quat)
        np.testing.assert_allclose(turn.reshape(3, 3), joint.parent_from_child.rotation, atol=tolerance)
        np.testing.assert_allclose(body.pos, joint.parent_from_child.translation, atol=tolerance)
        if joint.kind is JointKind.FIXED:
            assert body.jntnum[0] == 0
            continue
        found = model.joint(joint.name)
        slides = joint.kind is JointKind.PRISMATIC
        assert found.type[0] == (mujoco.mjtJoint.mjJNT_SLIDE if slides else mujoco.mjtJoint.mjJNT_HINGE)
        np.testing.assert_allclose(found.axis, joint.axis, atol=tolerance)
        if joint.kind is not JointKind.CONTINUOUS:
            np.testing.assert_allclose(found.range, [joint.lower, joint.upper], atol=tolerance)


limited = trees(heavy_links).filter(
    lambda tree: all(
        joint.kind is JointKind.FIXED or joint.upper - joint.lower > 1e-3 for joint in tree.joints
    )
)


@settings(max_examples=40, deadline=None)
@given(limited)
def test_mujoco_finds_the_same_bodies_and_joints(tree):
    assert_mujoco_has(floating_in_mujoco(tree).compile(), tree, 1e-9)


@settings(max_examples=20, deadline=None)
@given(limited)
def test_mujocos_own_converter_gives_the_same_robot_to_six_digits(tree):
    """So MJCF needs no writer of ours: MuJoCo prints what it read, with six significant digits."""
    spec = floating_in_mujoco(tree)
    spec.compile()
    assert_mujoco_has(mujoco.MjModel.from_xml_string(spec.to_xml()), tree, 2e-5)


def pendulum(**changes) -> Tree:
    bob = Solid(Sphere(0.1), Placement(translation=(0.0, 0.0, -0.5)), 1000.0)
    fields = {
        "name": "hinge",
        "kind": JointKind.REVOLUTE,
        "parent": "wall",
        "child": "arm",
        "parent_from_child": Placement(),
        "axis": (0.0, 1.0, 0.0),
        "lower": -1.0,
        "upper": 1.0,
    }
    weld = Joint("weld", JointKind.FIXED, "arm", "tip", Placement(translation=(0.0, 0.0, -0.6)))
    links = (Link("wall", looks=(Look(Box(1.0, 2.0, 3.0), Placement()),)), Link("arm", (bob,)), Link("tip"))
    return Tree("pendulum", links, (Joint(**(fields | changes)), weld))


def xml(tree: Tree):
    return etree.fromstring(urdf_text(tree).encode())


def test_a_bare_frame_and_a_look_have_no_inertial():
    assert xml(pendulum()).xpath("link[inertial]/@name") == ["arm"]


def test_a_solid_is_seen_and_touched_but_a_look_is_only_seen():
    assert xml(pendulum()).xpath("link[visual]/@name") == ["wall", "arm"]
    assert xml(pendulum()).xpath("link[collision]/@name") == ["arm"]


def test_a_weld_has_neither_axis_nor_limit():
    assert {part.tag for part in xml(pendulum()).find("joint[@name='weld']")} == {"origin", "parent", "child"}


def test_inertial_is_at_the_centre_in_the_axes_of_the_link():
    (inertial,) = xml(pendulum()).xpath("link/inertial")
    mass = 1000.0 * 4.0 / 3.0 * math.pi * 0.001
    assert float(inertial.find("mass").get("value")) == pytest.approx(mass, rel=1e-14)
    assert inertial.find("origin").get("xyz") == "0.0 0.0 -0.5"
    assert inertial.find("origin").get("rpy") == "0.0 0.0 0.0"
    assert float(inertial.find("inertia").get("iyy")) == pytest.approx(0.4 * mass * 0.01, rel=1e-14)


def test_an_unlimited_effort_is_the_largest_double_and_reads_as_infinite():
    (limit,) = xml(pendulum()).xpath("joint/limit")
    assert float(limit.get("effort")) == np.finfo(float).max
    joint = read_urdf(urdf_text(pendulum()), "p", InertiaRule.SHAPES).joint_by_name["hinge"]
    assert joint.effort == joint.velocity == INFINITE


def test_an_unlimited_slide_reads_as_unlimited():
    tree = pendulum(kind=JointKind.PRISMATIC, lower=-INFINITE, upper=INFINITE)
    joint = read_urdf(urdf_text(tree), "p", InertiaRule.SHAPES).joint_by_name["hinge"]
    assert (joint.lower, joint.upper) == (-INFINITE, INFINITE)


def test_negative_zero_is_written_as_zero():
    tree = pendulum(axis=(-0.0, 1.0, -0.0), parent_from_child=Placement(translation=(-0.0, -0.0, 1.0)))
    assert xml(tree).find("joint/axis").get("xyz") == "0.0 1.0 0.0"
    assert xml(tree).find("joint/origin").get("xyz") == "0.0 0.0 1.0"


def test_numbers_of_numpy_are_written_like_any_other():
    tree = pendulum(lower=np.float64(-0.1))
    assert xml(tree).find("joint/limit").get("lower") == "-0.1"


def test_an_expression_is_not_written():
    tree = pendulum(parent_from_child=Placement(translation=(0.0, 0.0, casadi.SX.sym("z"))))
    with pytest.raises(TypeError, match="a robot file holds numbers, not SX"):
        urdf_text(tree)


def test_a_number_that_is_not_finite_is_not_written():
    tree = pendulum(parent_from_child=Placement(translation=(0.0, 0.0, math.nan)))
    with pytest.raises(ValueError, match="finite numbers, not nan"):
        urdf_text(tree)
