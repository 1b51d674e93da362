"""The folder of CAD files of a robot, as bytes by name."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from evodesign.report.cad import kernel
from evodesign.report.cad.agreement import agreements
from evodesign.report.cad.clashes import motor_clashes, neighbour_clashes
from evodesign.report.cad.parts import AXIS_LENGTH, Parts, parts_of
from evodesign.report.cad.readme import readme_text
from evodesign.report.cad.seats import seated_links
from evodesign.report.cad.sheet import drawing_svg
from evodesign.tree.mesh_write import stl, triangles_of, vertices_of
from evodesign.tree.model import Link, Tree


def cad_files(tree: Tree, materials: Mapping[str, str], title: str, stamp: str) -> dict[str, bytes]:
    """The CAD files of a robot, by name in their folder.

    Args:
        tree: of a design, numbers.
        materials: names by link, of those that have one.
        title: of the drawing.
        stamp: time that STEP files bear, ISO 8601; equal arguments give equal files.
    """
    parts = parts_of(tree, materials)
    seated = seated_links(parts)
    files = {}
    products = []
    for part in parts.links:
        body = kernel.together(seated[part.name].bodies)
        product = kernel.Product(part.name, body, part.root_from_link)
        files[f"{part.file}.step"] = kernel.step_file(part.name, [product], stamp)
        files[f"{part.file}.stl"] = _stl(*kernel.triangles(product.body))
        products.append(product)
    for name, stem in parts.meshes.items():
        files[f"{stem}.stl"] = _mesh_stl(parts.tree.link_by_name[name])
    products += _motors_and_axes(parts)
    if products:
        files["assembly.step"] = kernel.step_file(tree.name, products, stamp)
    files["drawing.svg"] = drawing_svg(parts, title)
    clashes = list(motor_clashes(parts, seated)), list(neighbour_clashes(parts))
    readme = readme_text(parts, agreements(parts, seated), seated, *clashes)
    return {"README.md": readme.encode(), **files}


def _motors_and_axes(parts: Parts) -> Iterator[kernel.Product]:
    for motor in parts.motors:
        body = kernel.solid_body(motor.solid.shape, None)
        yield kernel.Product(motor.name, body, motor.root_from_motor)
    for axis in parts.axes:
        yield kernel.Product(axis.name, kernel.line(AXIS_LENGTH), axis.root_from_axis)


def _stl(vertices: kernel.Array, corners: np.ndarray[tuple[int, ...], np.dtype[np.int64]]) -> bytes:
    """Triangles as STL in millimetres, from vertices in metres."""
    return stl(kernel.MILLIMETRES * vertices, corners)


def _mesh_stl(link: Link) -> bytes:
    """The meshes of a link in its frame, as one STL in millimetres."""
    vertices, corners, count = [], [], 0
    for mesh in link.meshes:
        vertices.append(vertices_of(mesh))
        corners.append(triangles_of(mesh) + count)
        count += len(vertices[-1])
    return _stl(np.concatenate(vertices), np.concatenate(corners))
