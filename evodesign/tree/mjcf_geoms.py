"""The geoms of a body in a compiled MJCF model, as visuals and collisions of a URDF link.

    visual      geoms of groups 0 to 2, which MuJoCo's viewer shows; not those that touch where a mesh that
                touches nothing shows the body
    collision   geoms that touch anything (`contype` or `conaffinity`)

Spheres, cylinders and boxes are shapes; meshes, capsules and ellipsoids become meshes. MuJoCo keeps the
vertices of a mesh scaled, and in axes of its own in which the geom stands: these go into the file.

Source: MuJoCo XML reference (geom, asset/mesh).
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import Any

import numpy as np
from lxml import etree

from evodesign.body.placement import Placement, vector
from evodesign.body.shape import Box, Cylinder, Shape, Sphere
from evodesign.tree.mesh_write import stl
from evodesign.tree.triangulation import capsule, ellipsoid
from evodesign.tree.urdf_write import add_mesh, add_shape

SHOWN_GROUPS = 3
"""Groups below this are those that MuJoCo's viewer shows unless it is told otherwise."""


def placement(position: Sequence[float], wxyz: Sequence[float]) -> Placement:
    """A place in a model by position and quaternion."""
    return Placement.from_xyz_wxyz(vector(position), [float(part) for part in wxyz])


def is_left_out(mujoco: Any, model: Any, geom: int) -> bool:
    """Whether a geom is none that a link can have."""
    kinds = mujoco.mjtGeom
    return int(model.geom_type[geom]) in (int(kinds.mjGEOM_PLANE), int(kinds.mjGEOM_HFIELD))


def add_geoms(
    link: etree._Element, mujoco: Any, model: Any, body: int, touching: Collection[int]
) -> dict[str, bytes]:
    """Add the geoms of a body, of which some are touching ones, to its <link>.

    Returns:
        The meshes among its visuals as binary STL, by name.
    """
    first, meshes = int(model.body_geomadr[body]), dict[str, bytes]()
    geoms = [
        geom
        for geom in range(first, first + int(model.body_geomnum[body]))
        if not is_left_out(mujoco, model, geom)
    ]
    shown = {geom for geom in geoms if model.geom_group[geom] < SHOWN_GROUPS}
    if any(model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_MESH for geom in shown.difference(touching)):
        shown.difference_update(touching)
    for role, chosen in (("visual", shown), ("collision", touching)):
        for geom in (geom for geom in geoms if geom in chosen):
            name, content = _add_geom(link, role, mujoco, model, geom)
            if name and role == "visual":
                meshes[name] = content
    return meshes


def _add_geom(link: etree._Element, role: str, mujoco: Any, model: Any, geom: int) -> tuple[str, bytes]:
    """A geom under one role; the name and content of its mesh, if it needs one."""
    kinds, kind = mujoco.mjtGeom, model.geom_type[geom]
    place = placement(model.geom_pos[geom], model.geom_quat[geom])
    a, b, c = vector(model.geom_size[geom])
    shapes: dict[int, Shape] = {
        int(kinds.mjGEOM_SPHERE): Sphere(a),
        int(kinds.mjGEOM_CYLINDER): Cylinder(a, 2.0 * b),
        int(kinds.mjGEOM_BOX): Box(2.0 * a, 2.0 * b, 2.0 * c),
    }
    if int(kind) in shapes:
        add_shape(link, role, shapes[int(kind)], place)
        return "", b""
    if kind == kinds.mjGEOM_CAPSULE:
        name, content = f"capsule_{a!r}_{b!r}.stl", stl(*capsule(a, 2.0 * b))
    elif kind == kinds.mjGEOM_ELLIPSOID:
        name, content = f"ellipsoid_{a!r}_{b!r}_{c!r}.stl", stl(*ellipsoid(a, b, c))
    else:
        name, content = _mesh(model, int(model.geom_dataid[geom]))
    add_mesh(link, role, name, place)
    return name, content


def _mesh(model: Any, mesh: int) -> tuple[str, bytes]:
    vertices, faces = (
        getattr(model, f"mesh_{part}")[start : start + count]
        for part, start, count in (
            ("vert", model.mesh_vertadr[mesh], model.mesh_vertnum[mesh]),
            ("face", model.mesh_faceadr[mesh], model.mesh_facenum[mesh]),
        )
    )
    name = f"{model.mesh(mesh).name or f'mesh_{mesh}'}.stl"
    return name, stl(np.asarray(vertices, float), np.asarray(faces, np.int64))
