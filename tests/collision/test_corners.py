"""Which corners of hulls decide how far two links of meshes are apart, against coal on the whole hulls."""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
import trimesh

from evodesign.body.inertia import Inertia
from evodesign.body.placement import Placement
from evodesign.collision.clearance import SolidBodies
from evodesign.collision.corners import TOLERANCE, deciding_corners
from evodesign.collision.rules import CollisionRules
from evodesign.collision.shapes import hull_corners
from evodesign.collision.supports import corner_shapes_of
from evodesign.posture.placed_shape import placed_shape
from evodesign.tree.frames import link_poses
from evodesign.tree.kinematics import Pose
from evodesign.tree.model import Joint, JointKind, Link, Mesh, Tree
from evodesign.tree.surface import surface_of

PAIR = ("chest", "arm")


def mesh_link(name: str, sides: tuple[float, float, float], place: Placement) -> Link:
    """An ellipsoid of 320 triangles."""
    ball = trimesh.creation.icosphere(subdivisions=2)
    surface = surface_of(ball.vertices * np.array(sides), np.asarray(ball.faces), float(ball.volume))
    return Link(name, own_inertia=Inertia(1.0), meshes=(Mesh(name, (1.0, 1.0, 1.1), place, surface=surface),))


@pytest.fixture(scope="module")
def tree() -> Tree:
    """An arm that turns about two axes beside a chest, with 4 mm between them at zero."""
    quarter = Placement(((0.0, -1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)))
    links = (
        mesh_link("chest", (0.1, 0.1, 0.2), quarter),
        Link("shoulder"),
        mesh_link("arm", (0.04, 0.05, 0.03), Placement()),
    )
    joints = (
        Joint("pitch", JointKind.REVOLUTE, "chest", "shoulder", Placement(), (0.0, 1.0, 0.0), -0.4, 0.4),
        Joint(
            "roll", JointKind.REVOLUTE, "shoulder", "arm", Placement(translation=(0.144, 0.0, 0.0)),
            (0.0, 0.0, 1.0), -0.5, 0.5,
        ),
    )  # fmt: skip
    return Tree("two", links, joints)


def test_few_corners_tell_how_far_hulls_are_apart(tree: Tree) -> None:
    """In other postures than those that they were chosen in, to twice the tolerance."""
    joints = ("pitch", "roll")
    found = deciding_corners([tree], joints, [PAIR, ("arm", "arm")])
    assert set(found) == {PAIR}
    assert all(2 < len(own) < 60 for (own,) in found[PAIR]), found
    rng = np.random.default_rng(3)
    drawn = dict(zip(joints, rng.uniform(-0.4, 0.4, (2, 200)), strict=True))
    poses, bodies = link_poses(tree, drawn), SolidBodies.of_tree(tree)
    for sample in range(200):
        turns, origins = (np.array([poses[name][part][sample] for name in bodies.names]) for part in (0, 1))
        placed = bodies.placed_at(turns, origins)
        whole, normal, *_ = placed.parted(0, 1)
        parts = []
        for place, (name, (own,)) in enumerate(zip(PAIR, found[PAIR], strict=True)):
            mesh = tree.link_by_name[name].meshes[0]
            assert mesh.surface is not None
            points = hull_corners(mesh.surface)[[*own]] * np.array(mesh.scale)
            points = points @ np.array(mesh.link_from_mesh.rotation).T
            parts.append(points @ turns[place].T + origins[place])
        along = float((parts[1] @ normal).min() - (parts[0] @ normal).max())
        if -0.03 < whole < 0.02:
            assert whole - 1e-6 <= along <= whole + 2.5 * TOLERANCE


def test_rows_of_a_pair_know_the_corners_in_either_order() -> None:
    rules = CollisionRules(0.005, (PAIR,), corners={PAIR: (((1, 2),), ((3,),))})
    assert rules.corners_of(PAIR) == (((1, 2),), ((3,),))
    assert rules.corners_of(PAIR[::-1]) == (((3,),), ((1, 2),))
    assert rules.corners_of(("chest", "leg")) == ((), ())


def test_hulls_of_corners_follow_the_stretch_of_their_mesh(tree: Tree) -> None:
    stretch = ((1.5, 0.1, 0.0), (0.1, 0.8, 0.0), (0.0, 0.0, 1.2))
    (mesh,) = tree.link_by_name["chest"].meshes
    stretched = replace(mesh, stretch=stretch)
    corners = (tuple(range(0, 160, 3)),)
    (shape,) = corner_shapes_of(Link("chest", own_inertia=Inertia(1.0), meshes=(stretched,)), corners, 1e-3)
    placed = placed_shape(shape, Pose(ca.SX.eye(3), ca.SX.zeros(3)))
    assert mesh.surface is not None
    points = hull_corners(mesh.surface)[[*corners[0]]] * np.array(mesh.scale)
    points = points @ np.array(mesh.link_from_mesh.rotation).T @ np.array(stretch).T
    for unit in np.random.default_rng(4).standard_normal((20, 3)):
        unit /= np.linalg.norm(unit)
        reach = float(ca.evalf(ca.dot(placed.centre, ca.DM(unit)) + placed.support(ca.DM(unit))))
        farthest = float((points @ unit).max())
        ball = 1e-3 * float(np.linalg.norm(np.array(stretch).T @ unit))
        assert farthest + ball - 1e-9 <= reach <= farthest + 1.01 * ball + 1e-3
