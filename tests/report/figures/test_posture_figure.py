"""Faces enclose their shape's volume, and a camera sees what it should."""

from __future__ import annotations

import math

import numpy as np
import pytest
import trimesh

from evodesign.body.placement import Placement
from evodesign.body.shape import Box, Cylinder, Shape, Sphere
from evodesign.report.figures.faces import AROUND, Face, faces_of, seen_triangles
from evodesign.report.figures.posture_figure import Camera
from evodesign.tree.model import Mesh
from evodesign.tree.surface import surface_of

PLACE = Placement.from_xyz_rpy((0.3, -0.2, 0.9), (0.4, -0.7, 1.9))


def enclosed(faces: list[Face]) -> float:
    """Volume by the divergence theorem: a third of face area times distance from the origin, summed."""
    total = 0.0
    for face in faces:
        area = 0.5 * np.cross(face.corners, np.roll(face.corners, -1, axis=0)).sum(axis=0)
        total += float(area @ face.corners[0]) / 3.0
    return total


PRISM = AROUND / (2.0 * math.pi) * math.sin(2.0 * math.pi / AROUND)
"""Area of a regular polygon over that of its circle."""


@pytest.mark.parametrize(
    ("shape", "share"), [(Box(0.1, 0.2, 0.3), 1.0), (Cylinder(0.05, 0.4), PRISM), (Sphere(0.2), 0.95)]
)
def test_faces_enclose_the_volume(shape: Shape, share: float) -> None:
    tolerance = 0.01 if isinstance(shape, Sphere) else 1e-9
    assert enclosed(faces_of(shape, PLACE)) / shape.volume == pytest.approx(share, rel=tolerance)


@pytest.mark.parametrize("shape", [Box(0.1, 0.2, 0.3), Cylinder(0.05, 0.4), Sphere(0.2)])
def test_normals_point_outward(shape: Shape) -> None:
    for face in faces_of(shape, PLACE):
        outward = face.corners.mean(axis=0) - np.array(PLACE.translation)
        assert float(face.normal @ outward) > 0.0
        assert float(np.linalg.norm(face.normal)) == pytest.approx(1.0)


def test_camera_from_the_side_sees_the_robot_on_the_left_and_the_head_on_top() -> None:
    seen = Camera(azimuth=-math.pi / 2.0, elevation=0.0).seen(np.array([[1.0, 2.0, 3.0]]))
    assert seen[0] == pytest.approx([1.0, 3.0, -2.0])


def test_camera_keeps_lengths() -> None:
    axes = Camera(0.3, 0.8).axes
    assert np.allclose(axes @ axes.T, np.eye(3))
    assert np.linalg.det(axes) == pytest.approx(1.0)


def ball(*, watertight: bool) -> Mesh:
    found = trimesh.creation.icosphere(3, 0.2)
    return Mesh(
        "ball.stl",
        scale=(1.0, -1.0, 1.0),
        link_from_mesh=Placement(translation=(0.1, 0.0, 0.0)),
        surface=surface_of(found.vertices, found.faces, found.volume if watertight else 0.0),
    )


def test_a_camera_sees_the_near_half_of_a_closed_mesh_and_all_of_an_open_one() -> None:
    towards = Camera().axes[2]
    centre = PLACE.apply((0.1, 0.0, 0.0))
    corners, normals = seen_triangles(ball(watertight=True), PLACE, towards)
    outward = corners.mean(axis=1) - np.array(centre)
    assert ((outward * normals).sum(axis=1) > 0.19).all()
    assert ((normals @ towards) > 0.0).all()
    both, _ = seen_triangles(ball(watertight=False), PLACE, towards)
    assert len(both) == pytest.approx(2 * len(corners), rel=0.02)
    flat = view_area(corners, towards)
    assert flat == pytest.approx(math.pi * 0.2**2, rel=0.02), "its silhouette is a disc"


def view_area(corners: np.ndarray, towards: np.ndarray) -> float:
    crossed = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return 0.5 * float((crossed @ towards).sum())
