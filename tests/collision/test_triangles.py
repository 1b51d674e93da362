"""Meshes by their triangles: hollow ones are apart from what their hulls hold; depths are those of solids."""

from __future__ import annotations

import coal
import numpy as np
import pytest
import trimesh
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from evodesign.body.inertia import Inertia
from evodesign.body.placement import Placement
from evodesign.collision.clearance import BodyDistance, PlacedSolids, SolidBodies
from evodesign.collision.triangles import triangles_in_link
from evodesign.tree.model import Link, Mesh
from evodesign.tree.surface import Surface, surface_of
from tests.collision.chains import two_links

SIDES = (0.1, 0.06, 0.04)
PAIR = np.array([[0, 1]])


def surface(*meshes: trimesh.Trimesh) -> Surface:
    mesh = trimesh.util.concatenate(meshes)
    return surface_of(np.asarray(mesh.vertices), np.asarray(mesh.faces), float(mesh.volume))


def box(
    sides: tuple[float, float, float], place: tuple[float, float, float] = (0.0, 0.0, 0.0)
) -> trimesh.Trimesh:
    return trimesh.creation.box(sides, trimesh.transformations.translation_matrix(place))


FORK = surface(
    box((0.1, 0.1, 0.02)),
    box((0.1, 0.01, 0.1), (0.0, -0.045, 0.05)),
    box((0.1, 0.01, 0.1), (0.0, 0.045, 0.05)),
)
"""Two cheeks on a plate, with 8 cm between them."""


def placed(one: Surface, other: Surface, place: Placement) -> PlacedSolids:
    """Two meshes, the other one somewhere in the one's frame."""
    links = [
        Link(name, own_inertia=Inertia(1.0), meshes=(Mesh(name, surface=each),))
        for name, each in (("one", one), ("other", other))
    ]
    return SolidBodies.of_tree(two_links(*links)).placed({"one": Placement(), "other": place})


def distance(one: Surface, other: Surface, place: Placement) -> float:
    """Of two meshes [m]."""
    return placed(one, other, place).nearest(PAIR).distance


def overlapping(one: Surface, other: Surface, place: Placement) -> list[BodyDistance]:
    """What the check finds."""
    return placed(one, other, place).overlapping(PAIR)


def test_a_pin_in_a_fork_is_apart_from_its_cheeks_though_not_from_its_hull() -> None:
    pin = surface(box((0.02, 0.02, 0.02)))
    place = Placement(translation=(0.0, 0.0, 0.06))
    assert distance(FORK, pin, place) == pytest.approx(0.03, abs=1e-5)
    hull = ConvexHull(FORK.vertices).equations
    assert (hull[:, :3] @ place.translation + hull[:, 3]).max() < 0.0, "the pin's middle is inside"


def test_a_pin_in_a_cheek_is_as_deep_as_it_has_to_be_moved() -> None:
    """By 4 mm outwards; the hulls are 54 mm deep in each other."""
    pin = surface(box((0.02, 0.02, 0.02)))
    found = -distance(FORK, pin, Placement(translation=(0.0, 0.034, 0.06)))
    assert 0.004 - 1e-5 < found < 0.054


def test_an_overlap_of_meshes_within_their_accuracy_is_none() -> None:
    one = surface(box((0.1, 0.1, 0.1)))
    for depth, count in ((0.0015, 0), (0.0025, 1)):
        assert len(overlapping(one, one, Placement(translation=(0.1 - depth, 0.0, 0.0)))) == count
        both = placed(one, one, Placement(translation=(0.1 - depth, 0.0, 0.0)))
        assert len(both.in_each_other(PAIR)) == count
        assert both.in_each_other(PAIR, least=0.0) == {(0, "one", "other")}
        assert distance(one, one, Placement(translation=(0.1 - depth, 0.0, 0.0))) == pytest.approx(
            -depth, abs=3e-4
        )


def test_a_mesh_within_another_one_is_found_though_no_triangles_cross() -> None:
    large, small = surface(box((0.2, 0.2, 0.2))), surface(box((0.02, 0.02, 0.02)))
    for one, other in ((large, small), (small, large)):
        assert distance(one, other, Placement()) == pytest.approx(-0.11, abs=3e-4)


def test_boxes_of_triangles_are_as_far_apart_as_solid_boxes() -> None:
    """Coal's boxes, in any posture: overlaps are the same ones, distances agree, depths are no less."""
    rng, sides = np.random.default_rng(3), np.array(SIDES)
    mesh, solid = surface(box(SIDES)), coal.Box(*sides)
    overlaps = 0
    for turn in Rotation.random(60, rng=rng):
        position, rows = rng.uniform(-0.08, 0.08, 3), turn.as_matrix()
        there = coal.Transform3s(rows, position)
        exact = coal.distance(
            solid, coal.Transform3s(), solid, there, coal.DistanceRequest(), coal.DistanceResult()
        )
        place = Placement(tuple(map(tuple, rows.tolist())), tuple(position.tolist()))
        found = distance(mesh, mesh, place)
        overlaps += exact < 0.0
        assert bool(placed(mesh, mesh, place).in_each_other(PAIR, least=0.0)) == (exact < 0.0)
        assert found == pytest.approx(exact, abs=4e-4)
    assert 10 < overlaps < 50


def test_points_are_inside_of_a_mesh_as_of_the_solid() -> None:
    """The winding number against the inequalities of a box, a mirrored mesh as well."""
    points = np.random.default_rng(4).uniform(-0.06, 0.06, (200, 3))
    inside = (np.abs(points) < np.array(SIDES) / 2.0).all(axis=1)
    for scale in ((1.0, 1.0, 1.0), (1.0, -1.0, 1.0)):
        triangles = triangles_in_link(Mesh("box", scale, surface=surface(box(SIDES))))
        assert [triangles.is_around(point) for point in points] == inside.tolist()
