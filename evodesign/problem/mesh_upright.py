"""COLLADA meshes whose files say that y is up.

ROS and its viewers take coordinates as they stand, so that `<up_axis>` means nothing to most robots. To some
it does: their meshes lie beside their links unless they are turned, v' = (x, -z, y). Which one holds for a
robot is told by its centres of mass: those files are turned, all of them, if that halves the distances from
the middles of the meshes.

Source: COLLADA 1.4.1, <up_axis>; pull request 24 of ros/robot_model and issue 1305 of gazebo-classic (what
programs make of it).
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from evodesign.tree.mesh_write import vertices_of
from evodesign.tree.model import Link, Tree
from evodesign.tree.surface import Surface, surface_of

HEAD = 100_000
"""Bytes in which a file says what is up."""


def says_y_up(path: Path) -> bool:
    """Whether a mesh file says that y is up."""
    if path.suffix.lower() != ".dae":
        return False
    with path.open("rb") as file:
        return b"Y_UP" in file.read(HEAD)


def stood_upright(tree: Tree, surfaces: Mapping[str, Surface], y_up: Collection[str]) -> dict[str, Surface]:
    """The surfaces of a robot's meshes, turned as far as its files ask for it and its masses agree.

    Args:
        tree: of the robot's URDF, with the file's inertias.
        surfaces: by the mesh's name in the URDF, in the coordinates of the files.
        y_up: names of those whose files say that y is up.
    """
    turned = {name: _turned(surfaces[name]) for name in y_up}
    before, after = (sum(_distances(tree, found)) for found in ({n: surfaces[n] for n in y_up}, turned))
    return {**surfaces, **turned} if after < before / 2.0 else dict(surfaces)


def _turned(surface: Surface) -> Surface:
    x, y, z = surface.vertices.T
    return surface_of(np.stack([x, -z, y], axis=1), surface.faces, surface.volume)


def _distances(tree: Tree, surfaces: Mapping[str, Surface]) -> Iterator[float]:
    """From the centre of mass of each link to the middle of each of its meshes [m]."""
    for link in tree.links:
        for middle in _middles(link, surfaces) if link.inertia.mass > 0.0 else ():
            yield math.dist(middle, link.inertia.center)


def _middles(link: Link, surfaces: Mapping[str, Surface]) -> Iterator[list[float]]:
    for mesh in link.meshes:
        if mesh.file in surfaces:
            vertices = vertices_of(replace(mesh, surface=surfaces[mesh.file]))
            yield ((vertices.min(axis=0) + vertices.max(axis=0)) / 2.0).tolist()
