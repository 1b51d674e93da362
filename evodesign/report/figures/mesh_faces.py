"""The triangles of a mesh that a camera sees, all at once: a robot has tens of thousands of them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from evodesign.body.placement import Placement
from evodesign.tree.mesh_write import triangles_of, vertices_of
from evodesign.tree.model import Mesh

Array = NDArray[np.float64]


def in_world(mesh: Mesh, world_from_link: Placement) -> Array:
    """Vertices of a mesh in the world [m], shape (n, 3)."""
    rotation: Array = np.array(world_from_link.rotation, float)
    found: Array = vertices_of(mesh) @ rotation.T + np.array(world_from_link.translation, float)
    return found


def seen_triangles(mesh: Mesh, world_from_link: Placement, towards: Array) -> tuple[Array, Array]:
    """Corners [m], shape (m, 3, 3), and unit normals, shape (m, 3), of the triangles that face a camera.

    Of a mesh that is not watertight both sides are seen: its triangles need not agree on what is outside.

    Args:
        mesh: with its triangles.
        world_from_link: of the link that it shows.
        towards: unit vector to the camera, in the world.
    """
    corners = in_world(mesh, world_from_link)[triangles_of(mesh)]
    areas = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    facing = areas @ towards
    if not mesh.encloses:
        areas, facing = areas * np.sign(facing)[:, None], np.abs(facing)
    seen = facing > 0.0
    normals = areas[seen] / np.linalg.norm(areas[seen], axis=1, keepdims=True)
    return corners[seen], normals
