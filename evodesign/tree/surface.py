"""The triangles of a mesh, few enough to be kept with a problem, as text.

    vertex = low + step * q        q in 0 .. 65535 along each axis

Vertices are whole numbers of 16 bits in the mesh's box, so half a metre is told to 8 micrometres; a triangle
is three indices of vertices. Both stand as base64 of little-endian numbers: a thousand triangles take 12 kB.

A surface may come with a run from elsewhere, so whoever reads one sees that its indices are those of vertices
and its sizes are bounded.
"""

from __future__ import annotations

import base64
import binascii
import math

import msgspec
import numpy as np
from numpy.typing import NDArray

from evodesign.body.placement import Vector, vector
from evodesign.errors import InputError

MOST_VERTICES, MOST_TRIANGLES = 65_536, 20_000
"""Of a surface that is read."""

LARGEST = 1e9
"""Coordinate, or edge of a box, and its cube: the largest volume."""

STEPS = 65_535


class Surface(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Triangles in a mesh file's own coordinates, and what volume the file's mesh encloses.

    Attributes:
        low: least coordinates of the vertices.
        step: what one of `points` stands for, along each axis.
        points: x, y, z of each vertex in steps, as base64 of 16-bit numbers.
        triangles: three vertices each, counter-clockwise seen from outside, as base64 of 16-bit numbers.
        volume: of the mesh before it was simplified, in the cube of its unit; 0 if it is not watertight.
    """

    low: Vector
    step: Vector
    points: str
    triangles: str
    volume: float = 0.0

    @property
    def vertices(self) -> NDArray[np.float64]:
        """Vertices in the file's coordinates, shape (n, 3)."""
        found: NDArray[np.float64] = np.array(self.low) + np.array(self.step) * _numbers(self.points)
        return found

    @property
    def faces(self) -> NDArray[np.int64]:
        """Indices of the vertices of each triangle, shape (m, 3)."""
        return _numbers(self.triangles).astype(np.int64)


def surface_of(vertices: NDArray[np.float64], faces: NDArray[np.int64], volume: float) -> Surface:
    """A surface of vertices, shape (n, 3), at most `MOST_VERTICES`, and triangles, shape (m, 3)."""
    low = vertices.min(axis=0)
    step = (vertices.max(axis=0) - low) / STEPS
    steps = np.rint((vertices - low) / np.where(step > 0.0, step, 1.0))
    return Surface(vector(low), vector(step), _base64(steps), _base64(faces), volume)


def surface_text(surface: Surface) -> str:
    """The surface as JSON."""
    return msgspec.json.encode(surface).decode()


def read_surface(text: str, source: str, key: str) -> Surface:
    """A surface from its text.

    Args:
        text: as `surface_text` writes it.
        source: who names it, for messages.
        key: where in the source.
    Raises:
        InputError: the text is no surface, or one of more than `MOST_VERTICES` or `MOST_TRIANGLES`.
    """
    try:
        surface = msgspec.json.decode(text, type=Surface)
        points, triangles = _numbers(surface.points), _numbers(surface.triangles)
    except (ValueError, binascii.Error, RecursionError) as error:  # among them msgspec's own
        raise InputError(source, key, "the triangles of a mesh", f"{error}") from error
    figures = (*surface.low, *surface.step, surface.volume ** (1.0 / 3.0) if surface.volume > 0.0 else 0.0)
    if not all(math.isfinite(figure) and abs(figure) <= LARGEST for figure in figures):
        raise InputError(source, key, f"a mesh within {LARGEST:g}", "larger numbers")
    if surface.volume < 0.0 or min(surface.step) < 0.0:
        raise InputError(source, key, "a mesh of positive size", "a negative one")
    if not 0 < len(triangles) <= MOST_TRIANGLES or len(points) > MOST_VERTICES:
        found = f"{len(triangles)} triangles"
        raise InputError(source, key, f"a mesh of at most {MOST_TRIANGLES} triangles", found)
    if int(triangles.max()) >= len(points):
        raise InputError(source, key, "triangles of the mesh's own vertices", "others")
    return surface


def _numbers(text: str) -> NDArray[np.uint16]:
    """Triples of 16-bit numbers."""
    return np.frombuffer(base64.b64decode(text, validate=True), dtype="<u2").reshape(-1, 3)


def _base64(numbers: NDArray[np.float64] | NDArray[np.int64]) -> str:
    return base64.b64encode(numbers.astype("<u2").tobytes()).decode()
