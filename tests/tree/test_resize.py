"""How a tree answers to length multipliers and densities."""

from __future__ import annotations

import math
from dataclasses import replace

import casadi
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from evodesign.body.inertia import total
from evodesign.body.placement import Placement, mirrored_point
from evodesign.body.shape import Box, Cylinder, Shape, Solid, Sphere
from evodesign.errors import ModelError
from evodesign.tree.model import Joint, JointKind, Link, Look, Tree
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


@pytest.mark.parametrize(
    ("link", "found"),
    [
        (Link("base"), "none"),
        (Link("base", looks=(Look(Sphere(0.1), Placement()),)), "a shape that is only seen, without mass"),
    ],
)
def test_link_without_mass_cannot_change(link: Link, found: str) -> None:
    tree = Tree("bare", (link,), ())
    for lengths, densities, key in (({"base": 1.2}, {}, "length"), ({}, {"base": 900.0}, "density")):
        with pytest.raises(ModelError, match="wanted a link with mass") as refusal:
            resize(tree, lengths, densities)
        assert (refusal.value.key, refusal.value.found) == (f"{key} of link base", found)


def test_unknown_link_names_the_nearest() -> None:
    tree = chain(Cylinder(0.05, 0.2), DOWN, (0.0, 0.0, -0.25))
    with pytest.raises(ModelError, match="did you mean 'middle'"):
        resize(tree, {"midle": 1.2}, {})


# Links that lie across the chain, or have none


ALONG_Y = Placement.from_xyz_rpy((0.0, 0.0, 0.05), (math.pi / 2.0, 0.0, 0.0))


def test_cylinder_across_the_chain_grows_to_both_sides() -> None:
    tree = chain(Cylinder(0.03, 0.1), ALONG_Y, (0.0, 0.0, 0.1))
    growth = growth_of(tree, "middle")
    assert growth.about_centre
    assert [abs(x) for x in growth.axis] == pytest.approx([0.0, 1.0, 0.0], abs=1e-12)
    longer = resize(tree, {"middle": 1.5}, {}).link_by_name["middle"].solids[0]
    assert longer.shape == Cylinder(0.03, pytest.approx(0.15))
    assert longer.link_from_solid == ALONG_Y


def test_cylinder_across_the_way_to_its_centre_grows_towards_its_child_joint() -> None:
    for side in (1.0, -1.0):
        tree = chain(Cylinder(0.03, 0.1), ALONG_Y, (0.0, side * 0.05, 0.05))
        assert not growth_of(tree, "middle").about_centre
        assert tip(resize(tree, {"middle": 2.0}, {})) == pytest.approx((0.0, side * 0.15, 0.05))


def test_solid_that_nothing_gives_a_direction_grows_about_its_centre() -> None:
    tree = chain(Box(0.1, 0.2, 0.02), Placement(), (0.0, 0.0, 0.0))
    longer = resize(tree, {"middle": 3.0}, {})
    assert longer.link_by_name["middle"].solids[0] == Solid(
        Box(0.1, 0.2, pytest.approx(0.06)), Placement(), 500
    )
    assert tip(longer) == (0.0, 0.0, 0.0)


# Composites


def composite(*parts: tuple[Shape, tuple[float, float, float]], rolls: tuple[float, ...] = ()) -> Tree:
    """As `chain`, the middle link made of several solids; rolls turn them about x."""
    turns = rolls or (0.0,) * len(parts)
    solids = tuple(
        Solid(shape, Placement.from_xyz_rpy(xyz, (roll, 0.0, 0.0)), 500.0)
        for (shape, xyz), roll in zip(parts, turns, strict=True)
    )
    tree = chain(Sphere(1.0), DOWN, (0.0, 0.0, -0.25))
    links = tuple(Link("middle", solids) if link.name == "middle" else link for link in tree.links)
    return replace(tree, links=links)


def centres(tree: Tree) -> list[float]:
    return [solid.link_from_solid.translation[2] for solid in tree.link_by_name["middle"].solids]


def shapes_of(tree: Tree) -> list[Shape]:
    return [solid.shape for solid in tree.link_by_name["middle"].solids]


KNEE, MOTOR, ANKLE = Sphere(0.06), Sphere(0.05), Box(0.1, 0.1, 0.05)


@given(st.floats(0.5, 2.0))
def test_middle_of_a_composite_gets_longer_and_its_ends_keep_their_size(factor: float) -> None:
    rod = Cylinder(0.03, 0.2)
    tree = composite(
        (KNEE, (0.0, 0.0, -0.01)), (rod, (0.0, 0.0, -0.1)), (MOTOR, (0.02, 0, -0.105)), (ANKLE, (0, 0, -0.2))
    )
    longer, e = resize(tree, {"middle": factor}, {}), (factor - 1.0) * 0.2
    assert growth_of(tree, "middle").dimension == 0.2
    assert shapes_of(longer) == [KNEE, Cylinder(0.03, pytest.approx(0.2 * factor)), MOTOR, ANKLE]
    assert centres(longer) == pytest.approx([-0.01, -0.1 - e / 2.0, -0.105 - e / 2.0, -0.2 - e])
    assert tip(longer)[2] == pytest.approx(-0.25 - e)


def test_the_solid_that_spans_most_along_the_chain_is_the_main_one() -> None:
    """Not the ball, which is wider than the rod is long; not the bar, which is longer but lies across."""
    rod, ball, bar = Cylinder(0.02, 0.2), Sphere(0.15), Cylinder(0.02, 0.5)
    tree = composite(
        (ball, (0, 0, -0.1)), (bar, (0, 0, -0.1)), (rod, (0, 0, -0.1)), rolls=(0.0, math.pi / 2, 0)
    )
    growth = growth_of(tree, "middle")
    assert (growth.stretched, growth.dimension) == ({2}, 0.2)
    assert growth.axis == pytest.approx((0.0, 0.0, -1.0), abs=1e-12)


def test_two_rods_side_by_side_both_get_longer() -> None:
    rods = (Cylinder(0.02, 0.2), Cylinder(0.03, 0.204))
    tree = composite((rods[0], (0.0, 0.04, -0.1)), (rods[1], (0.0, -0.04, -0.1)), rolls=(0.0, math.pi))
    longer = resize(tree, {"middle": 1.5}, {})
    assert [shape.length for shape in shapes_of(longer)] == pytest.approx([0.3, 0.306])
    assert centres(longer) == pytest.approx([-0.1 - 0.051] * 2)


def test_a_rod_that_is_shorter_or_lies_elsewhere_keeps_its_size() -> None:
    main = (Cylinder(0.02, 0.2), (0.0, 0.0, -0.1))
    for other in ((Cylinder(0.02, 0.17), (0.0, 0.05, -0.1)), (Cylinder(0.02, 0.2), (0.0, 0.05, -0.12))):
        assert growth_of(composite(main, other), "middle").stretched == {0}


def test_a_hollow_leg_gets_longer_walls_between_the_same_lids() -> None:
    wall, side, lid = Box(0.01, 0.1, 0.2), Box(0.08, 0.01, 0.2), Box(0.1, 0.1, 0.01)
    tree = composite(
        (lid, (0, 0, 0.005)),
        (wall, (0.045, 0, -0.1)),
        (wall, (-0.045, 0, -0.1)),
        (side, (0, 0.045, -0.1)),
        (side, (0, -0.045, -0.1)),
        (lid, (0, 0, -0.205)),
    )
    longer = resize(tree, {"middle": 2.0}, {})
    assert [shape.z for shape in shapes_of(longer)] == [0.01, 0.4, 0.4, 0.4, 0.4, 0.01]
    assert centres(longer) == pytest.approx([0.005, -0.2, -0.2, -0.2, -0.2, -0.405])


def test_a_composite_root_grows_to_both_sides() -> None:
    parts = {0.0: Box(0.1, 0.1, 0.2), 0.11: Box(0.2, 0.2, 0.02), -0.11: Sphere(0.05)}
    solids = tuple(Solid(shape, Placement(translation=(0, 0, z)), 500.0) for z, shape in parts.items())
    tree = Tree("root", (Link("root", solids),), ())
    longer = resize(tree, {"root": 1.5}, {}).link_by_name["root"].solids
    assert [solid.link_from_solid.translation[2] for solid in longer] == pytest.approx([0.0, 0.16, -0.16])
    assert [solid.shape for solid in longer] == [Box(0.1, 0.1, pytest.approx(0.3)), *list(parts.values())[1:]]


sizes = st.floats(0.02, 0.3)
spots = st.tuples(*[st.floats(-0.3, 0.3)] * 3)
turns = st.tuples(*[st.floats(-3.0, 3.0)] * 3)
placed = st.builds(Placement.from_xyz_rpy, spots, turns)
anything = st.builds(Sphere, sizes) | st.builds(Cylinder, sizes, sizes) | st.builds(Box, sizes, sizes, sizes)
anybody = st.lists(st.builds(Solid, anything, placed, st.just(700.0)), min_size=1, max_size=4).map(tuple)


@st.composite
def trees(draw: st.DrawFn) -> Tree:
    """base -> middle -> tip, with the middle link of any solids and joints anywhere."""
    tree = chain(Sphere(0.1), DOWN, draw(spots))
    return replace(tree, links=(tree.links[0], Link("middle", draw(anybody)), tree.links[2]))


@given(trees())
def test_unit_multipliers_are_the_identity_on_any_composite(tree: Tree) -> None:
    assert resize(tree, {"middle": 1.0, "base": 1.0}, {"middle": 700.0}) == tree


@given(trees(), st.floats(0.4, 2.5), st.floats(100.0, 8000.0))
def test_every_design_of_a_composite_is_a_body(tree: Tree, factor: float, density: float) -> None:
    link = resize(tree, {"middle": factor}, {"middle": density}).link_by_name["middle"]
    assert link.inertia.mass == pytest.approx(density * math.fsum(s.shape.volume for s in link.solids))
    a, b, c = np.linalg.eigvalsh(np.array(link.inertia.about_center))
    assert a > 0.0
    assert a + b >= c * (1.0 - 1e-9)


@given(trees(), st.floats(0.4, 2.5))
def test_a_composite_in_the_mirror_grows_in_the_mirror(tree: Tree, factor: float) -> None:
    solids = tuple(
        replace(solid, link_from_solid=solid.link_from_solid.mirrored())
        for solid in tree.link_by_name["middle"].solids
    )
    joints = tuple(replace(j, parent_from_child=j.parent_from_child.mirrored()) for j in tree.joints)
    other = replace(tree, links=(tree.links[0], Link("middle", solids), tree.links[2]), joints=joints)
    mine, its = (resize(t, {"middle": factor}, {}) for t in (tree, other))
    assert np.allclose(mirrored_point(tip(mine)), tip(its), atol=1e-12)
    expected = mine.link_by_name["middle"].inertia.mirrored()
    found = its.link_by_name["middle"].inertia
    assert found.mass == pytest.approx(expected.mass, rel=1e-12)
    assert np.allclose(found.center, expected.center, atol=1e-12)
    assert np.allclose(found.about_center, expected.about_center, atol=1e-12 * found.mass)


@settings(max_examples=20)
@given(trees(), st.floats(0.4, 2.5), st.floats(100.0, 8000.0))
def test_symbols_give_what_numbers_give(tree: Tree, factor: float, density: float) -> None:
    symbols = casadi.SX.sym("l"), casadi.SX.sym("rho")
    symbolic, numeric = (
        resize(tree, {"middle": length}, {"middle": weight})
        for length, weight in (symbols, (factor, density))
    )
    figures = [
        casadi.vertcat(
            t.link_by_name["middle"].inertia.mass,
            *t.link_by_name["middle"].inertia.center,
            *(entry for row in t.link_by_name["middle"].inertia.about_center for entry in row),
            *tip(t),
        )
        for t in (symbolic, numeric)
    ]
    found = casadi.Function("found", symbols, [figures[0]])(factor, density)
    wanted = np.array(casadi.DM(figures[1]))
    assert np.allclose(np.array(found), wanted, rtol=1e-12, atol=1e-15 * np.abs(wanted).max())


@given(
    st.floats(1.0, 2.5), st.sampled_from([Cylinder(0.03, 0.2), Box(0.05, 0.07, 0.2)]), st.floats(0.02, 0.09)
)
def test_a_longer_link_is_one_cut_across_with_a_piece_put_in(
    factor: float, rod: Shape, radius: float
) -> None:
    """The inertia once more, from the near half, the piece, and the far half with the ball at its end."""
    tree = composite((rod, (0.01, 0.02, -0.1)), (Sphere(radius), (0.0, -0.01, -0.2)))
    e = (factor - 1.0) * 0.2
    pieces = [
        Solid(rod.lengthened(length / 0.2, (0.0, 0.0, 1.0)), Placement(translation=(0.01, 0.02, z)), 500.0)
        for length, z in ((0.1, -0.05), (e, -0.1 - e / 2.0), (0.1, -0.15 - e))
    ]
    ball = Solid(Sphere(radius), Placement(translation=(0.0, -0.01, -0.2 - e)), 500.0)
    wanted = total([solid.inertia for solid in (*pieces, ball)])
    found = resize(tree, {"middle": factor}, {}).link_by_name["middle"].inertia
    assert found.mass == pytest.approx(wanted.mass, rel=1e-12)
    assert np.allclose(found.center, wanted.center, rtol=1e-12)
    assert np.allclose(found.about_center, wanted.about_center, rtol=1e-10, atol=1e-13)


@given(st.floats(0.5, 2.0))
def test_a_longer_link_of_the_same_mass_has_that_masss_inertia_and_exact_slopes(factor: float) -> None:
    """Table I once more, with the old mass in the new shape; links without solids are no exception."""
    mass, length = 500.0 * math.pi * 0.05**2 * 0.2, 0.2 * factor
    tree = chain(Cylinder(0.05, 0.2), DOWN, (0.0, 0.0, -0.25))
    longer = resize(tree, {"middle": factor}, {}, kept={"middle"}).link_by_name["middle"].inertia
    across = mass * (3.0 * 0.05**2 + length**2) / 12.0
    assert longer.mass == pytest.approx(mass, rel=1e-12)
    assert longer.center[2] == pytest.approx(-length / 2.0)
    assert np.allclose(np.diag(longer.about_center), (across, across, mass * 0.05**2 / 2.0), rtol=1e-12)
    symbol = casadi.SX.sym("l")
    symbolic = resize(tree, {"middle": symbol}, {}, kept={"middle"}).link_by_name["middle"].inertia
    figures = casadi.vertcat(symbolic.mass, symbolic.center[2], symbolic.about_center[0][0])
    slopes = casadi.Function("slopes", [symbol], [casadi.jacobian(figures, symbol)])(factor)
    assert np.allclose(np.array(slopes).ravel(), (0.0, -0.1, mass * 0.2 * length / 6.0), atol=1e-12)
    whole = replace(tree.link_by_name["middle"], solids=(), own_inertia=tree.link_by_name["middle"].inertia)
    bare = replace(tree, links=(tree.links[0], whole, tree.links[2]))
    stretched = resize(bare, {"middle": factor}, {}, kept={"middle"}).link_by_name["middle"].inertia
    assert stretched.mass == pytest.approx(mass, rel=1e-12)
    assert np.allclose(stretched.about_center, longer.about_center, rtol=1e-9)
