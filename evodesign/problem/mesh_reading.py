"""Mesh files, simplified to few triangles.

A file is STL, COLLADA, OBJ or PLY; COLLADA's own unit is heeded, its upward axis is not, as in ROS (but see
`mesh_upright`). Nothing that a mesh file names, such as a texture, is opened. Simplified meshes are kept in
the user's cache, as every command reads the problem: found again by the file's content.

Source: Garland and Heckbert 1997 (quadric error metric), by way of fast-simplification.
"""

from __future__ import annotations

import io
import os
import struct
import warnings
from contextlib import suppress
from pathlib import Path, PurePath
from typing import Any

import numpy as np
from numpy.typing import NDArray

from evodesign.errors import InputError
from evodesign.identity import code_digest, digest
from evodesign.nlp.disk_cache import Cache, user_cache
from evodesign.tree.placeholder import placeholder
from evodesign.tree.surface import Surface, read_surface, surface_of, surface_text

KINDS = (".stl", ".dae", ".obj", ".ply")
"""Suffixes of the files that are read."""

MOST_BYTES, MOST_READ = 100_000_000, 5_000_000
"""Of a mesh file, and triangles in it; those of public robots have 1 MB and 20,000."""

LARGEST = 1e8
"""Coordinate of a mesh, in its unit."""

FINEST = 512
"""Cells along a mesh in which vertices are merged at first."""

MANY = 16
"""Times as many triangles as are wanted, of which vertices are merged at once: collapsing edges of more takes
seconds, only to find that many small pieces stand in the way."""

CAREFUL, SIZE = 3, 0.2
"""From 0 (slow and good) to 10, and the largest side that meshes are given before, as what the library bears
is no share of it. On meshes of a G1, of about this size [m], with 2,000 triangles each, a surface then moves
by 2 mm; by 6 to 14 mm, with spikes, at the library's own 7."""

Vertices = NDArray[np.float64]
Faces = NDArray[np.int64]


def read_mesh(path: Path, most: int, source: str, key: str) -> Surface:
    """A mesh file as at most so many triangles, in the file's coordinates [m, in COLLADA's unit].

    Args:
        path: of a regular file.
        most: triangles, at least 12.
        source: who names it, for messages.
        key: where in the source.
    Raises:
        InputError: the file cannot be read, is of another kind, too large, or holds no triangles.
    """
    kind = path.suffix.lower()
    if kind not in KINDS:
        wanted = f"a mesh file ({', '.join(KINDS)}); [robot] meshes = false leaves meshes out"
        raise InputError(source, key, wanted, f"'{path}'")
    try:
        with path.open("rb") as file:
            content = file.read(MOST_BYTES + 1)
    except OSError as error:
        raise InputError(source, key, "a readable file", f"'{path}' ({error.strerror})") from error
    if len(content) > MOST_BYTES:
        raise InputError(source, key, f"a file of at most {MOST_BYTES} bytes", f"a larger '{path}'")
    return few_triangles(content, str(path), most, source, key)


def few_triangles(content: bytes, name: str, most: int, source: str, key: str) -> Surface:
    """The bytes of a mesh file of a kind that is read, as in `read_mesh`.

    Raises:
        InputError: they hold no triangles.
    """
    kind, missing = PurePath(name).suffix.lower(), placeholder(content)
    if missing:
        raise InputError(source, key, "a mesh of triangles", f"'{name}', which {missing}")
    cache = _cache()
    entry = digest((kind, most, content, code_digest(__name__)))
    kept = cache.read(entry) if cache else None
    if kept is not None:
        with suppress(InputError, UnicodeDecodeError):
            return read_surface(kept.decode(), source, key)
    try:
        surface = _simplified(content, kind, most)
    except ValueError as error:
        raise InputError(source, key, "a mesh of triangles", f"'{name}' ({error})") from error
    if cache:
        with suppress(OSError):
            cache.store(entry, surface_text(surface).encode())
    return surface


def _cache() -> Cache | None:
    try:
        return user_cache("meshes", os.environ)
    except OSError:
        return None


def _simplified(content: bytes, kind: str, most: int) -> Surface:
    """The surface in a file's bytes."""
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")  # what libraries say about odd geometry
        mesh = _loaded(content, kind)
        vertices, faces = np.asarray(mesh.vertices, float), np.asarray(mesh.faces, np.int64)
        if not 0 < len(faces) <= MOST_READ:
            raise ValueError(f"{len(faces)} triangles, of at most {MOST_READ}")
        if not (np.isfinite(vertices).all() and np.abs(vertices).max() <= LARGEST):
            raise ValueError(f"coordinates beyond {LARGEST:g}")
        volume = abs(float(mesh.volume)) if mesh.is_volume else 0.0
        return surface_of(*_fewer(vertices, faces, most), volume)


def _loaded(content: bytes, kind: str) -> Any:
    """The parts of a file as one mesh of trimesh, equal vertices merged [m]."""
    import trimesh  # here: what is kept needs neither, and commands start without
    from collada.common import DaeError
    from trimesh.exchange.stl import HeaderError

    unreadable = (
        *(ArithmeticError, AttributeError, AssertionError, LookupError, NotImplementedError, OSError),
        *(RecursionError, SyntaxError, TypeError, ValueError, struct.error, DaeError, HeaderError),
    )
    try:
        scene = trimesh.load_scene(io.BytesIO(content), file_type=kind[1:], resolver=None)
        if not scene.geometry:
            raise ValueError("no triangles in it")
        units = {_metres(geometry.units) for geometry in scene.geometry.values()}
        mesh = scene.to_mesh()
        mesh.apply_scale(max(units))
        mesh.merge_vertices(merge_tex=True, merge_norm=True)
        mesh.update_faces(_of_three(np.asarray(mesh.faces)))  # thin ones stay: without them it is open
        mesh.remove_unreferenced_vertices()
    except unreadable as error:
        raise ValueError(f"{type(error).__name__}: {error}") from error
    return mesh


def _metres(unit: str | None) -> float:
    """COLLADA's unit, which trimesh notes as `0.001 * meters`; 1 for formats without units."""
    factor, times, _ = (unit or "").partition(" * ")
    return float(factor) if times else 1.0


def _fewer(vertices: Vertices, faces: Faces, most: int) -> tuple[Vertices, Faces]:
    """At most so many triangles, of nearly the same form.

    Of many small pieces each keeps some triangles, so their vertices are then merged first.
    """
    points, kept, cells = vertices, faces, FINEST
    while True:
        if len(kept) <= MANY * most:
            points, kept = _collapsed(points, kept, most)
        if len(kept) <= most:
            break
        points, kept = _clustered(vertices, faces, cells)
        cells = 2 * cells // 3
    used, renamed = np.unique(kept, return_inverse=True)
    if not len(used):
        raise ValueError("nothing of any size")
    return points[used], renamed.reshape(-1, 3)


def _collapsed(vertices: Vertices, faces: Faces, most: int) -> tuple[Vertices, Faces]:
    """Edges collapsed until few triangles are left, or until the form would suffer."""
    if len(faces) <= most:
        return vertices, faces
    import fast_simplification

    low = vertices.min(axis=0)
    unit = float((vertices.max(axis=0) - low).max()) / SIZE
    points, kept = fast_simplification.simplify(
        (vertices - low) / unit, np.ascontiguousarray(faces, np.int32), target_count=most, agg=CAREFUL
    )
    return low + unit * np.asarray(points, float), np.asarray(kept, np.int64)


def _clustered(vertices: Vertices, faces: Faces, cells: int) -> tuple[Vertices, Faces]:
    """Vertices of one cell of a grid made one, their mean; triangles within two cells go."""
    low = vertices.min(axis=0)
    size = float((vertices.max(axis=0) - low).max()) / cells
    _, cell = np.unique(np.floor((vertices - low) / size), axis=0, return_inverse=True)
    cell = cell.reshape(-1)
    count = np.bincount(cell)
    means = np.stack([np.bincount(cell, column) / count for column in vertices.T], axis=1)
    merged = cell[faces]
    merged = merged[_of_three(merged)]
    _, first = np.unique(np.sort(merged, axis=1), axis=0, return_index=True)
    return means, merged[np.sort(first)]


def _of_three(faces: Faces) -> NDArray[np.bool_]:
    """Which triangles have three different vertices."""
    differ: NDArray[np.bool_] = (faces != np.roll(faces, 1, axis=1)).all(axis=1)
    return differ
