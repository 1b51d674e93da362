"""The meshes of a tree as binary STL files, with their scale and stretch in the vertices.

A vertex v of a mesh's own file is in the link's frame at

    stretch R diag(scale) v + t        R, t of link_from_mesh

so a file that is placed by link_from_mesh alone holds  R' stretch R diag(scale) v,  R' the transpose of R.
Meshes that come out alike share a file. Triangles of a mirrored mesh are turned, so that their normals point
outwards.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import PurePosixPath
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from evodesign.body.placement import Placement
from evodesign.tree.model import Link, Mesh, Tree

MeshNames = Mapping[tuple[str, int], str]
"""Files by link and by the mesh's position among the link's."""

NO_MESHES: MeshNames = MappingProxyType({})

THINNEST = 1e-5
"""A mesh less thick [m] is flat, and has no hull."""

FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])

Array = NDArray[np.float64]


def mesh_files(tree: Tree, folder: str) -> tuple[dict[tuple[str, int], str], dict[str, bytes]]:
    """Names for the files of a tree's meshes, as URDF and MJCF name them, and what they hold by name.

    Args:
        tree: of numbers. Meshes without triangles have no file.
        folder: which the names begin with.
    """
    names: dict[tuple[str, int], str] = {}
    contents: dict[str, bytes] = {}
    of_content: dict[bytes, str] = {}
    for link in tree.links:
        for position, mesh in enumerate(link.shown):
            if mesh.surface is None:
                continue
            turned = np.array(mesh.link_from_mesh.rotation, float).T @ _linear(mesh)
            content = stl(mesh.surface.vertices @ turned.T, triangles_of(mesh))
            if content not in of_content:
                of_content[content] = _free_name(mesh.file, folder, contents)
                contents[of_content[content]] = content
            names[link.name, position] = of_content[content]
    return names, contents


def _free_name(file: str, folder: str, taken: Mapping[str, bytes]) -> str:
    """A name of plain letters after a mesh's own, numbered where it is taken."""
    stem = re.sub(r"[^A-Za-z0-9_-]+", "_", PurePosixPath(file).stem)[:60].strip("_") or "mesh"
    name, number = f"{folder}/{stem}.stl", 1
    lower = {each.lower() for each in taken}
    while name.lower() in lower:
        number += 1
        name = f"{folder}/{stem}_{number}.stl"
    return name


def named_meshes(link: Link, names: MeshNames) -> list[tuple[Mesh, str]]:
    """The meshes of a link that have a file, with its name."""
    found = ((mesh, names.get((link.name, position))) for position, mesh in enumerate(link.meshes))
    return [(mesh, name) for mesh, name in found if name is not None]


def link_from_vertex(mesh: Mesh) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """The affine map from a mesh's file to its link's frame: a matrix by rows, and a translation [m]."""
    x, y, z = mesh.link_from_mesh.translation
    return tuple(_linear(mesh).reshape(-1).tolist()), (float(x), float(y), float(z))


def vertices_of(mesh: Mesh) -> Array:
    """Vertices in the link's frame [m], shape (n, 3); none without triangles."""
    if mesh.surface is None:
        return np.zeros((0, 3))
    found: Array = mesh.surface.vertices @ _linear(mesh).T + np.array(mesh.link_from_mesh.translation, float)
    return found


def in_frame(points: Array, outer_from_inner: Placement) -> Array:
    """Points of shape (n, 3) in an outer frame."""
    turn, offset = np.array(outer_from_inner.rotation, float), np.array(outer_from_inner.translation, float)
    found: Array = points @ turn.T + offset
    return found


def triangles_of(mesh: Mesh) -> NDArray[np.int64]:
    """Indices of the vertices of each triangle, counter-clockwise seen from outside, shape (m, 3)."""
    if mesh.surface is None:
        return np.zeros((0, 3), np.int64)
    return mesh.surface.faces if np.linalg.det(_linear(mesh)) > 0.0 else mesh.surface.faces[:, ::-1]


def has_hull(mesh: Mesh) -> bool:
    """Whether a mesh is thick enough for a convex hull."""
    vertices = vertices_of(mesh)
    if len(vertices) < 4:
        return False
    spread = np.linalg.svd(vertices - vertices.mean(axis=0), compute_uv=False)
    return bool(spread[-1] > THINNEST * np.sqrt(len(vertices)))


def _linear(mesh: Mesh) -> Array:
    scaled = np.array(mesh.link_from_mesh.rotation, float) * np.array(mesh.scale, float)
    found: Array = np.array(mesh.stretch, float) @ scaled
    return found


def stl(vertices: Array, triangles: NDArray[np.int64]) -> bytes:
    """Triangles as binary STL.

    Args:
        vertices: shape (n, 3) [m].
        triangles: indices of vertices, shape (m, 3).
    """
    facets = np.zeros(len(triangles), FACET)
    corners = vertices[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    facets["normal"] = normals / np.where(lengths > 0.0, lengths, 1.0)
    facets["corners"] = corners
    return b"evodesign".ljust(80) + len(triangles).to_bytes(4, "little") + facets.tobytes()
