"""Links stretched along their main axis, against Table I, meshes integrated by trimesh, and pinocchio."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
import trimesh
from scipy.spatial.transform import Rotation

from evodesign.body.inertia import Inertia
from evodesign.body.placement import Placement
from evodesign.body.shape import Box, Cylinder, Solid
from evodesign.errors import ModelError
from evodesign.tree.model import Joint, JointKind, Link, Look, Mesh, Tree
from evodesign.tree.resize import growth_of, resize

KNEE = (0.02, -0.03, -0.4)
FIXED, MOVING = JointKind.FIXED, JointKind.REVOLUTE


def leg(thigh: Link, knee: tuple[float, float, float] = KNEE) -> Tree:
    """A thigh below a pelvis, with a shank, a cover and a bare frame."""
    shank = Inertia(2.0, (0.0, 0.0, -0.1), ((0.1, 0.0, 0.0), (0.0, 0.1, 0.0), (0.0, 0.0, 0.1)))
    links = (
        Link("pelvis", own_inertia=shank),
        thigh,
        Link("shank", own_inertia=shank),
        Link("cover", own_inertia=shank),
        Link("frame"),
    )
    place = Placement(translation=knee)
    joints = (
        Joint("hip", MOVING, "pelvis", "thigh", Placement(translation=(0.0, 0.1, -0.1)), (0.0, 1.0, 0.0)),
        Joint("knee", MOVING, "thigh", "shank", place, (0.0, 1.0, 0.0)),
        Joint("screws", FIXED, "thigh", "cover", Placement(translation=(0.1, 0.0, 0.0))),
        Joint("mark", FIXED, "thigh", "frame", Placement(translation=(0.0, 0.3, -0.2))),
    )
    return Tree("leg", links, joints)


def about(link: Link) -> np.ndarray:
    return np.array(link.inertia.about_center)


def thigh_of(tree: Tree) -> Link:
    return tree.link_by_name["thigh"]


def placed(rng: np.random.Generator) -> Placement:
    rows = Rotation.random(random_state=rng).as_matrix().tolist()
    return Placement(tuple(map(tuple, rows)), tuple(rng.uniform(-0.1, 0.1, 3).tolist()))


@pytest.mark.parametrize("shape", [Box(0.06, 0.09, 0.4), Cylinder(0.05, 0.4)], ids=["box", "cylinder"])
@pytest.mark.parametrize("factor", [0.4, 1.0, 1.7])
def test_a_primitive_below_its_joint_is_stretched_as_in_table_1(shape: Box | Cylinder, factor: float) -> None:
    solid = Solid(shape, Placement(translation=(0.0, 0.0, -0.2)), 900.0)
    of_solids = resize(leg(Link("thigh", solids=(solid,)), (0.0, 0.0, -0.4)), {"thigh": factor}, {})
    own = Link("thigh", own_inertia=solid.inertia, looks=(Look(shape, solid.link_from_solid),))
    of_file = resize(leg(own, (0.0, 0.0, -0.4)), {"thigh": factor}, {})
    one, other = thigh_of(of_solids).inertia, thigh_of(of_file).inertia
    assert other.mass == pytest.approx(one.mass, rel=1e-12)
    assert np.allclose(other.center, one.center, rtol=0.0, atol=1e-12)
    assert np.allclose(other.about_center, one.about_center, rtol=1e-12, atol=1e-15)
    knees = [tree.joint_by_name["knee"].parent_from_child.translation for tree in (of_solids, of_file)]
    assert np.allclose(*knees, atol=1e-12)
    assert thigh_of(of_file).looks[0].shape == shape.lengthened(factor, (0.0, 0.0, -1.0))


def surfaces(rng: np.random.Generator) -> list[trimesh.Trimesh]:
    """Watertight meshes of no symmetry."""
    return [
        trimesh.convex.convex_hull(rng.normal(size=(40, 3)) * (0.05, 0.08, 0.2)),
        trimesh.creation.torus(0.1, 0.03),
        trimesh.creation.annulus(0.05, 0.09, 0.3),
    ]


@pytest.mark.parametrize("factor", [0.5, 1.0, 1.8])
def test_mass_centre_and_inertia_are_those_of_the_stretched_mesh(factor: float) -> None:
    rng = np.random.default_rng(7)
    for surface in surfaces(rng):
        surface.apply_transform(trimesh.transformations.random_rotation_matrix(rng.random(3)))
        surface.apply_translation(rng.uniform(-0.2, 0.2, 3))
        surface.density = 700.0
        assert surface.is_watertight
        place = placed(rng)
        turn, origin = np.array(place.rotation), np.array(place.translation)
        matrix = np.eye(4)
        matrix[:3, :3], matrix[:3, 3] = turn, origin
        in_link = surface.copy().apply_transform(matrix)
        in_link.density = 700.0
        center, moments = in_link.center_mass.tolist(), in_link.moment_inertia.tolist()
        inertia = Inertia(float(in_link.mass), tuple(center), tuple(map(tuple, moments)))
        tree = leg(Link("thigh", own_inertia=inertia, meshes=(Mesh("a.stl", link_from_mesh=place),)))
        found = thigh_of(resize(tree, {"thigh": factor}, {}))

        (mesh,) = found.meshes
        vertices = surface.vertices @ (np.array(mesh.stretch) @ np.array(mesh.link_from_mesh.rotation)).T
        longer = trimesh.Trimesh(vertices + mesh.link_from_mesh.translation, surface.faces, process=False)
        longer.density = 700.0
        assert found.inertia.mass == pytest.approx(longer.mass, rel=1e-6)
        assert np.allclose(found.inertia.center, longer.center_mass, atol=1e-6)
        assert np.allclose(about(found), longer.moment_inertia, rtol=1e-6, atol=1e-9)

        axis = np.array(KNEE) / np.linalg.norm(KNEE)
        stretch = np.eye(3) + (factor - 1.0) * np.outer(axis, axis)
        assert np.allclose(longer.vertices, in_link.vertices @ stretch.T, atol=1e-12), "points move as said"


def test_children_move_with_the_points_where_they_are() -> None:
    inertia = Inertia(3.0, (0.0, 0.0, -0.2), ((0.1, 0.0, 0.0), (0.0, 0.1, 0.0), (0.0, 0.0, 0.02)))
    tree = leg(Link("thigh", own_inertia=inertia))
    growth = growth_of(tree, "thigh")
    assert growth.axis == pytest.approx(np.array(KNEE) / np.linalg.norm(KNEE)), (
        "neither cover nor frame count"
    )
    assert growth.dimension == pytest.approx(np.linalg.norm(KNEE))
    longer = resize(tree, {"thigh": 1.5}, {})
    for name in ("knee", "screws", "mark"):
        before, after = (
            np.array(t.joint_by_name[name].parent_from_child.translation) for t in (tree, longer)
        )
        along = before @ np.array(growth.axis)
        assert np.allclose(after, before + 0.5 * along * np.array(growth.axis), atol=1e-15)
    assert resize(tree, {"thigh": 1.0}, {}).joint_by_name["knee"].parent_from_child.translation == KNEE


def test_a_link_without_moving_children_grows_towards_its_centre_of_mass_and_a_root_upwards() -> None:
    inertia = Inertia(3.0, (0.0, 0.3, -0.4), ((0.1, 0.0, 0.0), (0.0, 0.1, 0.0), (0.0, 0.0, 0.02)))
    tree = leg(Link("thigh", own_inertia=inertia))
    assert growth_of(tree, "shank").axis == (0.0, 0.0, -1.0)
    assert growth_of(tree, "pelvis").axis == (0.0, 0.0, 1.0)
    turned = Placement(((1.0, 0.0, 0.0), (0.0, 0.0, -1.0), (0.0, 1.0, 0.0)))
    below = Tree(
        "leg", (Link("base"), *tree.links), (Joint("turn", FIXED, "base", "pelvis", turned), *tree.joints)
    )
    assert growth_of(below, "pelvis").axis == (0.0, 1.0, 0.0), "the base's z axis in the pelvis"


def test_a_link_without_any_direction_is_refused() -> None:
    point = Inertia(1.0)
    tree = Tree(
        "r",
        (Link("a", own_inertia=point), Link("b", own_inertia=point)),
        (Joint("j", MOVING, "a", "b", Placement()),),
    )
    with pytest.raises(ModelError, match="length of link b: wanted a link with a joint or a centre of mass"):
        growth_of(tree, "b")


def test_expressions_give_what_numbers_give() -> None:
    rng = np.random.default_rng(3)
    spread = rng.normal(size=(3, 3))
    moments = spread @ spread.T
    tensor = np.trace(moments) * np.eye(3) - moments
    thigh = Link("thigh", own_inertia=Inertia(4.0, (0.01, 0.02, -0.2), tuple(map(tuple, tensor.tolist()))))
    factor = ca.SX.sym("l")
    symbolic, numeric = (
        thigh_of(resize(leg(thigh), {"thigh": value}, {})).inertia for value in (factor, 1.4)
    )
    parts = ca.vertcat(
        symbolic.mass, *symbolic.center, *(entry for row in symbolic.about_center for entry in row)
    )
    found = np.array(ca.Function("f", [factor], [parts])(1.4)).ravel()
    wanted = [numeric.mass, *numeric.center, *np.ravel(numeric.about_center)]
    assert np.allclose(found, wanted, rtol=1e-13)


def test_density_of_a_link_of_the_file_scales_its_inertia_where_the_volume_is_known() -> None:
    box = Box(0.1, 0.1, 0.4)
    inertia = Inertia(3.0, (0.0, 0.0, -0.2), ((0.1, 0.0, 0.0), (0.0, 0.1, 0.0), (0.0, 0.0, 0.02)))
    tree = leg(Link("thigh", own_inertia=inertia, looks=(Look(box, Placement()),)))
    found = thigh_of(resize(tree, {}, {"thigh": 1500.0})).inertia
    assert found.mass == pytest.approx(1500.0 * box.volume)
    assert np.allclose(found.about_center, np.array(inertia.about_center) * found.mass / 3.0)
    with pytest.raises(ModelError, match=r"density of link shank: .* whose volume is known, found no shape"):
        resize(tree, {}, {"shank": 1500.0})
