"""How a tree answers to length multipliers and densities."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evodesign.body.inertia import Inertia
from evodesign.body.placement import Placement
from evodesign.body.shape import Box, Cylinder, Shape, Solid, Sphere
from evodesign.errors import ModelError
from evodesign.tree.model import Joint, JointKind, Link, Tree
from evodesign.tree.resize import growth_of, resize

DOWN = Placement(translation=(0.0, 0.0, -0.1))


def chain(shape: Shape, place: Placement, child: tuple[float, float, float]) -> Tree:
    """base -> middle (with the shape) -> tip."""
    return Tree(
        "chain",
        (
            Link("base", (Solid(Box(0.1, 0.1, 0.2), Placement(), 1000.0),)),
            Link("middle", (Solid(shape, place, 500.0),)),
            Link("tip"),
        ),
        (
            Joint("hip", JointKind.REVOLUTE, "base", "middle", Placement(), (0.0, 1.0, 0.0), -1.0, 1.0),
            Joint("end", JointKind.FIXED, "middle", "tip", Placement(translation=child)),
        ),
    )


def tip(tree: Tree) -> tuple[float, float, float]:
    return tree.joint_by_name["end"].parent_from_child.translation


@given(st.floats(0.5, 2.0))
def test_longer_shank_lowers_the_sole_by_what_the_solid_grows(factor: float) -> None:
    tree = chain(Cylinder(0.05, 0.2), DOWN, (0.0, 0.0, -0.25))
    longer = resize(tree, {"middle": factor}, {})
    assert tip(longer) == pytest.approx((0.0, 0.0, -0.25 - (factor - 1.0) * 0.2))
    solid = longer.link_by_name["middle"].solids[0]
    assert solid.shape.length == pytest.approx(0.2 * factor)
    near_end = solid.link_from_solid.translation[2] + solid.shape.length / 2.0
    assert near_end == pytest.approx(0.0), "the end at the parent joint must stay"


def test_child_joint_before_the_middle_stays() -> None:
    tree = chain(Cylinder(0.05, 0.2), DOWN, (0.0, 0.03, -0.02))
    assert tip(resize(tree, {"middle": 1.5}, {})) == (0.0, 0.03, -0.02)


def test_child_joint_a_hair_before_the_middle_moves() -> None:
    tree = chain(Box(0.1, 0.1, 0.1338), Placement(translation=(0.0, 0.0, 0.0669)), (0.0, 0.0, 0.06447))
    assert tip(resize(tree, {"middle": 2.0}, {}))[2] == pytest.approx(0.06447 + 0.1338)


def test_root_grows_to_both_sides_and_leaves_what_stands_at_its_centre() -> None:
    root = Link("root", (Solid(Box(0.1, 0.1, 0.2), Placement(), 1000.0),))
    heights = {"above": 0.05, "below": -0.05, "at": 0.0}
    joints = tuple(
        Joint(name, JointKind.FIXED, "root", name, Placement(translation=(0.0, 0.0, z)))
        for name, z in heights.items()
    )
    tree = Tree("root", (root, *(Link(name) for name in heights)), joints)
    longer = resize(tree, {"root": 1.5}, {})
    moved = {name: longer.joint_by_name[name].parent_from_child.translation[2] for name in heights}
    assert moved == pytest.approx({"above": 0.1, "below": -0.1, "at": 0.0})
    assert longer.link_by_name["root"].solids[0].link_from_solid == Placement()


def test_box_grows_along_the_side_nearest_to_the_chain() -> None:
    turned = Placement.from_xyz_rpy((0.0, 0.0, -0.1), (0.0, 1.5707963267948966, 0.0))
    tree = chain(Box(0.2, 0.07, 0.05), turned, (0.0, 0.0, -0.2))
    growth = growth_of(tree, "middle")
    assert growth.axis == pytest.approx((0.0, 0.0, -1.0), abs=1e-12)
    assert growth.dimension == 0.2


def test_sphere_grows_by_its_radius() -> None:
    tree = chain(Sphere(0.04), Placement(translation=(0.0, 0.0, -0.05)), (0.0, 0.0, -0.1))
    longer = resize(tree, {"middle": 1.5}, {})
    assert longer.link_by_name["middle"].solids[0].shape.radius == pytest.approx(0.06)
    assert tip(longer)[2] == pytest.approx(-0.12)


@given(st.floats(0.5, 2.0), st.floats(100.0, 8000.0))
def test_mass_follows_shape_and_density(factor: float, density: float) -> None:
    tree = chain(Cylinder(0.05, 0.2), DOWN, (0.0, 0.0, -0.25))
    inertia = resize(tree, {"middle": factor}, {"middle": density}).link_by_name["middle"].inertia
    assert inertia.mass == pytest.approx(density * 3.141592653589793 * 0.05**2 * 0.2 * factor)


def test_unit_multipliers_and_the_files_densities_give_the_same_tree() -> None:
    tree = chain(Cylinder(0.05, 0.2), DOWN, (0.0, 0.0, -0.25))
    assert resize(tree, {"middle": 1.0, "base": 1.0}, {"middle": 500.0}) == tree


def test_link_without_shape_cannot_change() -> None:
    tree = Tree("bare", (Link("base", own_inertia=Inertia(1.0)),), ())
    with pytest.raises(ModelError, match="length of link base"):
        resize(tree, {"base": 1.2}, {})
    with pytest.raises(ModelError, match="density of link base"):
        resize(tree, {}, {"base": 1000.0})


def test_unknown_link_names_the_nearest() -> None:
    tree = chain(Cylinder(0.05, 0.2), DOWN, (0.0, 0.0, -0.25))
    with pytest.raises(ModelError, match="did you mean 'middle'"):
        resize(tree, {"midle": 1.2}, {})
