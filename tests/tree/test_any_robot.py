"""A robot that nobody has seen: everything that a URDF may hold, read, resized, written and mirrored.

The oracle of kinematics is pinocchio reading the file as it lies here, not as we write it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given
from hypothesis import strategies as st

from evodesign.body.inertia import Inertia
from evodesign.body.placement import Placement, Vector, mirrored_point, scale
from evodesign.body.shape import Box, Cylinder, Solid, Sphere
from evodesign.errors import ModelError
from evodesign.tree.kinematics import Pose, forward
from evodesign.tree.model import Joint, JointKind, Link, Tree
from evodesign.tree.resize import growth_of, resize
from evodesign.tree.urdf_read import InertiaRule, read_urdf
from evodesign.tree.urdf_write import urdf_text
from problems.robots.write_icub import URDF
from tests.oracles.pinocchio_model import floating_model
from tests.tree.test_icub_robot import reference_text
from tests.tree.test_urdf_write import assert_mujoco_has, assert_same_tree, floating_in_mujoco

TENSOR = '<inertia ixx="0.02" ixy="0.001" ixz="0" iyy="0.03" iyz="-0.002" izz="0.025"/>'


def inertial(mass: float, xyz: str = "0 0 0") -> str:
    return f'<inertial><origin xyz="{xyz}" rpy="0.1 0 0.2"/><mass value="{mass}"/>{TENSOR}</inertial>'


def part(shape: str, xyz: str = "0 0 0", rpy: str = "0 0 0", role: str = "visual") -> str:
    return f'<{role}><origin xyz="{xyz}" rpy="{rpy}"/><geometry>{shape}</geometry></{role}>'


MESH = '<mesh filename="package://walker/no/such/file.stl"/>'
WALKER = f"""
<robot name="walker">
  <link name="pelvis">{inertial(8)}
    {part('<box size="0.2 0.3 0.1"/>')}{part('<cylinder radius="0.05" length="0.3"/>', rpy="1.5708 0 0")}
  </link>
  <link name="mast">{inertial(4)}
    {part('<box size="0.4 0.1 0.1"/>', "0 0 0.2", "0 1.5707963267948966 0")}
    {part('<sphere radius="0.07"/>', "0 0 0.4")}
  </link>
  <link name="lift">{inertial(2)}
    {part('<cylinder radius="0.04" length="0.3"/>', "0.1 0 0.1", "0.3 0.2 0.1")}
  </link>
  <link name="wheel">{inertial(1.5, "0 0.01 0")}
    {part(MESH)}{part('<cylinder radius="0.1" length="0.04"/>', "0 0.02 0", "1.5708 0 0", "collision")}
  </link>
  <link name="claw">{inertial(0.7, "0.05 0 0.02")}{part(MESH)}{part(MESH, role="collision")}</link>
  <link name="camera">{part('<sphere radius="0.01"/>')}</link>
  <link name="tool"/>
  <joint name="turn" type="revolute"><origin xyz="0 0 0.06" rpy="0.1 0 0"/><parent link="pelvis"/>
    <child link="mast"/><axis xyz="1 2 2"/><limit lower="-1" upper="1.2" effort="90" velocity="2"/></joint>
  <joint name="rise" type="prismatic"><origin xyz="0.02 0 0.42" rpy="0 0.2 0.3"/><parent link="mast"/>
    <child link="lift"/><axis xyz="0 0.6 0.8"/>
    <limit lower="-0.1" upper="0.4" effort="200" velocity="1"/></joint>
  <joint name="roll" type="continuous"><origin xyz="0.1 0.2 0" rpy="0 0 0"/><parent link="pelvis"/>
    <child link="wheel"/><axis xyz="0 -1 0"/></joint>
  <joint name="grip" type="revolute"><origin xyz="0.2 0.05 0.3" rpy="0.4 0.5 0.6"/><parent link="lift"/>
    <child link="claw"/><axis xyz="0 0 1"/><limit lower="-2" upper="0.1" effort="3" velocity="9"/></joint>
  <joint name="eye" type="fixed"><origin xyz="0 0 0.3"/><parent link="lift"/><child link="camera"/></joint>
  <joint name="hold" type="fixed"><origin xyz="0.1 0 0" rpy="0 1 0"/><parent link="claw"/><child link="tool"/>
  </joint>
  <transmission name="motor"><type>anything</type></transmission>
  <gazebo reference="wheel"><mu1>0.9</mu1></gazebo>
</robot>"""
CHANGING = ("pelvis", "mast", "lift", "wheel")


@pytest.fixture(scope="module")
def walker() -> Tree:
    return read_urdf(WALKER, "walker.urdf", InertiaRule.SHAPES)


@pytest.fixture(scope="module", params=["walker", "icub_shapes.urdf", "robot_reference.urdf"])
def robot(request: pytest.FixtureRequest) -> Tree:
    """Ours, the published one, and the one above."""
    name = request.param
    text = {"walker": lambda: WALKER, URDF.name: lambda: URDF.read_text(encoding="utf-8")}.get(
        name, lambda: reference_text(name)
    )()
    return read_urdf(text, name, InertiaRule.SHAPES)


def poses(tree: Tree, positions: Mapping[str, float]) -> dict[str, Pose]:
    """Poses of all links, the root in the world's place."""
    return forward(tree, Pose(ca.DM.eye(3), ca.DM.zeros(3)), positions)


def draw_positions(tree: Tree, rng: np.random.Generator) -> dict[str, float]:
    """A position of each joint within its limits [rad or m], in the order of the tree."""
    limits = [(tree.joint_by_name[name].lower, tree.joint_by_name[name].upper) for name in tree.actuated]
    return {
        name: float(rng.uniform(max(low, -3.0), min(high, 3.0)))
        for name, (low, high) in zip(tree.actuated, limits, strict=True)
    }


# Reading


def test_each_link_is_what_its_file_says(walker: Tree) -> None:
    shapes = {link.name: [solid.shape for solid in link.solids] for link in walker.links}
    assert shapes == {
        "pelvis": [Box(0.2, 0.3, 0.1), Cylinder(0.05, 0.3)],
        "mast": [Box(0.4, 0.1, 0.1), Sphere(0.07)],
        "lift": [Cylinder(0.04, 0.3)],
        "wheel": [Cylinder(0.1, 0.04)],
        "claw": [],
        "camera": [],
        "tool": [],
    }
    masses = {link.name: link.inertia.mass for link in walker.links if link.inertia.mass > 0.0}
    assert masses == pytest.approx({"pelvis": 8, "mast": 4, "lift": 2, "wheel": 1.5, "claw": 0.7}, rel=1e-14)
    kinds = {joint.name: joint.kind.value for joint in walker.joints if joint.kind is not JointKind.FIXED}
    assert kinds == {"turn": "revolute", "rise": "prismatic", "roll": "continuous", "grip": "revolute"}


def test_links_stand_where_pinocchio_puts_them_from_the_file_itself(walker: Tree) -> None:
    model = floating_model(WALKER)
    data = model.createData()
    rng = np.random.default_rng(5)
    for _ in range(20):
        positions = draw_positions(walker, rng)
        q = pin.neutral(model)
        for name, position in positions.items():
            joint = model.joints[model.getJointId(name)]
            turns = joint.nq == 2
            q[joint.idx_q : joint.idx_q + joint.nq] = (
                [math.cos(position), math.sin(position)] if turns else position
            )
        pin.framesForwardKinematics(model, data, q)
        for name, pose in poses(walker, positions).items():
            found = data.oMf[model.getFrameId(name, pin.FrameType.BODY)]
            assert np.allclose(np.array(pose.position).ravel(), found.translation, atol=1e-12)
            assert np.allclose(np.array(pose.rotation), found.rotation, atol=1e-12)


def test_a_mesh_keeps_the_inertia_that_pinocchio_reads(walker: Tree) -> None:
    model = floating_model(WALKER)
    claw, found = walker.link_by_name["claw"].inertia, model.inertias[model.getJointId("grip")]
    assert claw.mass == found.mass
    assert np.allclose(claw.center, found.lever, atol=1e-15)
    assert np.allclose(claw.about_center, found.inertia, atol=1e-15)


# Resizing


def test_growth_directions_follow_from_the_placement_of_the_shapes(walker: Tree) -> None:
    growths = {name: growth_of(walker, name) for name in CHANGING}
    assert growths["pelvis"].about_centre, "the root"
    assert growths["pelvis"].axis == pytest.approx((0.0, 0.0, 1.0))
    assert growths["mast"].axis == pytest.approx((0.0, 0.0, 1.0), abs=1e-12)
    assert growths["mast"].dimension == 0.4
    assert growths["wheel"].axis == pytest.approx((0.0, 1.0, 0.0), abs=1e-5)
    slanted = Placement.from_xyz_rpy((0, 0, 0), (0.3, 0.2, 0.1)).apply((0.0, 0.0, 1.0))
    assert growths["lift"].axis == pytest.approx(slanted)


@pytest.mark.parametrize("name", ["camera", "tool"])
def test_what_has_no_mass_cannot_get_longer(walker: Tree, name: str) -> None:
    with pytest.raises(ModelError, match=f"length of link {name}: wanted a link with mass, found"):
        growth_of(walker, name)


def test_unit_multipliers_are_the_identity_on_every_link(robot: Tree) -> None:
    solid = [link for link in robot.links if link.solids]
    assert len(solid) >= len(CHANGING)
    ones = {link.name: 1.0 for link in solid}
    assert resize(robot, ones, {link.name: link.solids[0].density for link in solid}) == robot


def designs(tree: Tree, count: int) -> list[Tree]:
    rng = np.random.default_rng(6)
    names = [link.name for link in tree.links if link.solids]
    return [
        resize(
            tree,
            dict(zip(names, rng.uniform(0.6, 1.8, len(names)).tolist(), strict=True)),
            dict(zip(names, rng.uniform(500.0, 4000.0, len(names)).tolist(), strict=True)),
        )
        for _ in range(count)
    ]


def test_every_design_is_physical(robot: Tree) -> None:
    for design in designs(robot, 5):
        for link in design.links:
            moments = np.linalg.eigvalsh(np.array(link.inertia.about_center))
            assert link.inertia.mass >= 0.0
            if link.solids:
                assert moments[0] > 0.0
            assert moments[0] + moments[1] >= moments[2] * (1.0 - 1e-9)


# Writing


def test_a_resized_robot_written_and_read_is_the_same_robot(robot: Tree) -> None:
    for design in designs(robot, 5):
        assert_same_tree(read_urdf(urdf_text(design), "written.urdf", InertiaRule.SHAPES), design)


def test_mujoco_and_pinocchio_find_the_resized_robot(walker: Tree) -> None:
    for design in designs(walker, 5):
        assert_mujoco_has(floating_in_mujoco(design).compile(), design, 1e-9)
        model = floating_model(urdf_text(design))
        assert pin.computeTotalMass(model) == pytest.approx(sum(link.inertia.mass for link in design.links))


# Turning and mirroring

sizes = st.floats(0.05, 1.0)
spots = st.tuples(*[st.floats(-1.0, 1.0)] * 3)
turns = st.tuples(*[st.floats(-3.0, 3.0)] * 3)
bodies = st.lists(
    st.builds(
        Solid,
        st.builds(Sphere, sizes) | st.builds(Cylinder, sizes, sizes) | st.builds(Box, sizes, sizes, sizes),
        st.builds(Placement.from_xyz_rpy, spots, turns),
        st.just(800.0),
    ),
    min_size=1,
    max_size=3,
)


@given(bodies, spots, turns)
def test_a_link_that_is_turned_keeps_its_principal_moments(
    solids: list[Solid], xyz: Vector, rpy: Vector
) -> None:
    place = Placement.from_xyz_rpy(xyz, rpy)
    here = Link("body", tuple(solids)).inertia
    moved = [replace(solid, link_from_solid=place @ solid.link_from_solid) for solid in solids]
    there = Link("body", tuple(moved)).inertia
    moments = np.linalg.eigvalsh(np.array(here.about_center))
    assert there.mass == pytest.approx(here.mass, rel=1e-14)
    assert np.allclose(place.apply(here.center), there.center, atol=1e-12)
    assert np.allclose(np.linalg.eigvalsh(np.array(there.about_center)), moments, rtol=1e-9)


def mirrored(tree: Tree) -> Tree:
    """The tree in the mirror y = 0: equal joint positions give mirror images.

    Turns have the pseudovector -M a as axis, slides M a.
    """
    return Tree(
        tree.name,
        tuple(Link(link.name, own_inertia=link.inertia.mirrored()) for link in tree.links),
        tuple(
            replace(
                joint,
                parent_from_child=joint.parent_from_child.mirrored(),
                axis=scale(1.0 if joint.kind is JointKind.PRISMATIC else -1.0, mirrored_point(joint.axis)),
            )
            for joint in tree.joints
        ),
    )


def test_a_mirrored_robot_stands_in_the_mirror(robot: Tree) -> None:
    rng, flip = np.random.default_rng(7), np.diag([1.0, -1.0, 1.0])
    other = mirrored(robot)
    for _ in range(5):
        positions = draw_positions(robot, rng)
        here, there = poses(robot, positions), poses(other, positions)
        for link in robot.links:
            place = np.array(here[link.name].position).ravel(), np.array(here[link.name].rotation)
            image = np.array(there[link.name].position).ravel(), np.array(there[link.name].rotation)
            assert np.allclose(flip @ place[0], image[0], atol=1e-12)
            assert np.allclose(flip @ place[1] @ flip, image[1], atol=1e-12)
            mine, its = link.inertia, other.link_by_name[link.name].inertia
            assert np.allclose(flip @ world(here, link.name, mine), world(there, link.name, its), atol=1e-12)


def world(where: Mapping[str, Pose], link: str, inertia: Inertia) -> np.ndarray:
    """Centre of mass of a link in the world [m]."""
    return np.array(where[link].point(ca.DM(list(inertia.center)))).ravel()


def test_a_hand_raised_on_the_left_is_raised_on_the_right_in_the_mirror() -> None:
    """The rule for axes in a case that needs no arithmetic: with M a for a turn the other hand would sink."""
    arm = Tree(
        "arm",
        (Link("base"), Link("hand")),
        (Joint("j", JointKind.REVOLUTE, "base", "hand", Placement(), (1.0, 0.0, 0.0), -1.0, 1.0),),
    )
    left = poses(arm, {"j": 0.5})["hand"].point(ca.DM([0.0, 1.0, 0.0]))
    right = poses(mirrored(arm), {"j": 0.5})["hand"].point(ca.DM([0.0, -1.0, 0.0]))
    assert np.array(left).ravel() == pytest.approx([0.0, math.cos(0.5), math.sin(0.5)])
    assert np.array(right).ravel() == pytest.approx([0.0, -math.cos(0.5), math.sin(0.5)])
