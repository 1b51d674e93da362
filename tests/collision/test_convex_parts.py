"""Meshes cut into convex parts: what is hollow, what is not, and that nothing is lost."""

from __future__ import annotations

import numpy as np
import trimesh
from scipy.spatial import ConvexHull

from evodesign.body.inertia import Inertia
from evodesign.body.placement import Placement
from evodesign.collision.clearance import SolidBodies
from evodesign.collision.convex_parts import MOST, convex_parts
from evodesign.collision.shapes import hull_corners
from evodesign.tree.frames import link_frames
from evodesign.tree.model import Joint, JointKind, Link, Mesh, Tree
from evodesign.tree.surface import Surface, surface_of


def surface(*meshes: trimesh.Trimesh) -> Surface:
    mesh = trimesh.util.concatenate(meshes)
    return surface_of(np.asarray(mesh.vertices), np.asarray(mesh.faces), float(mesh.volume))


def box(sides: tuple[float, float, float], place: tuple[float, float, float]) -> trimesh.Trimesh:
    return trimesh.creation.box(sides, trimesh.transformations.translation_matrix(place))


FORK = surface(
    box((0.1, 0.1, 0.02), (0.0, 0.0, 0.0)),
    box((0.1, 0.01, 0.1), (0.0, -0.045, 0.05)),
    box((0.1, 0.01, 0.1), (0.0, 0.045, 0.05)),
)
"""Two cheeks on a plate, with 8 cm between them."""


def test_a_solid_mesh_is_one_part_with_the_corners_of_its_hull() -> None:
    for mesh in (box((0.1, 0.2, 0.3), (0.0, 0.0, 0.1)), trimesh.creation.icosphere(subdivisions=2)):
        one = surface(mesh)
        (corners,) = convex_parts(one)
        np.testing.assert_array_equal(corners, hull_corners(one))


def test_a_fork_is_cut_into_its_plate_and_cheeks() -> None:
    """Planes are tried at sixths of a part's length: close to the cheeks, not at them."""
    parts = convex_parts(FORK)
    assert 1 < len(parts) <= MOST
    volume = sum(ConvexHull(part).volume for part in parts)
    exact = 0.1 * 0.1 * 0.02 + 2 * 0.1 * 0.01 * 0.09
    assert exact <= volume * (1.0 + 1e-6)
    assert volume < 0.6 * ConvexHull(FORK.vertices).volume


def test_every_triangle_is_within_the_parts() -> None:
    hulls = [ConvexHull(part).equations for part in convex_parts(FORK)]
    triangles = FORK.vertices[FORK.faces]
    weights = np.random.default_rng(1).dirichlet(np.ones(3), (len(triangles), 20))
    points = np.einsum("tpk,tkx->tpx", weights, triangles).reshape(-1, 3)
    outside = np.array([(points @ h[:, :3].T + h[:, 3]).max(axis=1) for h in hulls]).min(axis=0)
    assert outside.max() < 1e-9


def test_a_flat_mesh_is_one_part() -> None:
    flat = surface_of(
        np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]), np.array([[0, 1, 2]]), 0.0
    )
    assert len(convex_parts(flat)) == 1


def test_a_pin_in_a_fork_is_apart_from_its_parts_and_not_from_its_hull() -> None:
    pin = surface(box((0.02, 0.02, 0.02), (0.0, 0.0, 0.0)))
    links = tuple(
        Link(name, own_inertia=Inertia(1.0), meshes=(Mesh(name, surface=each),))
        for name, each in (("fork", FORK), ("pin", pin))
    )
    place = Placement(translation=(0.0, 0.0, 0.06))
    joint = Joint("turn", JointKind.REVOLUTE, "fork", "pin", place, (0.0, 1.0, 0.0), -1.0, 1.0)
    tree = Tree("two", links, (joint,))
    bodies = SolidBodies.of_tree(tree)
    placed = bodies.placed(link_frames(tree, Placement(), {}))
    names = bodies.names
    pairs = np.array([(i, len(names) - 1) for i in range(len(names) - 1)])
    assert placed.nearest(pairs).distance > 0.019
    hull = ConvexHull(FORK.vertices).equations
    assert (hull[:, :3] @ place.translation + hull[:, 3]).max() < 0.0, "the pin's middle is inside"
