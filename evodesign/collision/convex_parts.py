"""A mesh as a few convex parts: where a hull would fill a hollow, planes cut it, and each part has its hull.

Each cut is the one that leaves the hulls of the two halves the least volume together, of planes across the
file's axes and the part's principal ones; the part that gains most is cut next, up to `MOST` parts. Of these
numbers of parts the least is taken whose hulls have nearly as little volume as those of all. A mesh whose
parts keep most of the volume of its hull is not cut. Every triangle is within the parts' hulls.

Source: planes chosen greedily by the concavity that they leave: Wei et al., CoACD (2022); hulls: Qhull, by
scipy; cuts: trimesh.
"""

from __future__ import annotations

import functools
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from evodesign.tree.surface import Surface

__all__ = ["convex_parts"]

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

MOST = 4
"""Parts of a mesh."""

HOLLOW, NEARLY = 0.7, 1.1
"""The largest share of a hull's volume that parts may keep, and the share of the volume of `MOST` parts that
fewer may have."""

PLACES = np.arange(1, 6) / 6.0
"""Of planes, as shares of a part's length."""


@functools.lru_cache(maxsize=1024)
def convex_parts(surface: Surface) -> tuple[Array, ...]:
    """The corners of the hulls of a surface's parts, in the file's coordinates, shape (n, 3) each.

    Scaling and stretching keep the hulls' corners. What is hardly hollow is one part.
    """
    parts = [_Part.of(np.array(surface.vertices, float), surface.faces)]
    found = [parts]
    while len(parts) < MOST:
        gains = [part.volume - part.cut_volume for part in parts]
        at = int(np.argmax(gains))
        if gains[at] <= 0.0:
            break
        parts = [*parts[:at], *parts[at].halves(), *parts[at + 1 :]]
        found.append(parts)
    volumes = [sum(part.volume for part in parts) for parts in found]
    if volumes[-1] > HOLLOW * volumes[0]:
        return (found[0][0].corners,)
    fewest = next(
        parts for parts, volume in zip(found, volumes, strict=True) if volume <= NEARLY * volumes[-1]
    )
    return tuple(part.corners for part in fewest)


@dataclass(frozen=True, eq=False)
class _Part:
    """Triangles and their hull.

    Args:
        vertices: shape (n, 3).
        faces: shape (m, 3).
        corners: of the hull; of what is flat, all vertices.
        volume: of the hull.
    """

    vertices: Array
    faces: Indices
    corners: Array
    volume: float

    @classmethod
    def of(cls, vertices: Array, faces: Indices) -> _Part:
        """That of some triangles."""
        corners, volume = _hull(vertices)
        return cls(vertices, faces, corners, volume)

    @functools.cached_property
    def _best(self) -> tuple[float, Array, float]:
        """What the best plane n . x = c leaves of the volume, n and c."""
        return min(self._planes(), key=lambda plane: plane[0], default=(np.inf, np.zeros(3), 0.0))

    @property
    def cut_volume(self) -> float:
        """What the best cut leaves of the volume."""
        return self._best[0]

    def halves(self) -> list[_Part]:
        """The two that the best plane leaves."""
        from trimesh.intersections import slice_faces_plane

        _, normal, height = self._best
        found = []
        for side in (normal, -normal):
            plane = side, height * normal
            kept = slice_faces_plane(self.vertices, self.faces, *plane)  # type: ignore[no-untyped-call]
            vertices, faces = kept[:2]
            used, places = np.unique(faces, return_inverse=True)
            found.append(_Part.of(vertices[used], places.reshape(-1, 3)))
        return found

    def _planes(self) -> Iterator[tuple[float, Array, float]]:
        """Volume, normal and place of each plane to try."""
        sides = np.concatenate([self.faces[:, [0, 1]], self.faces[:, [1, 2]], self.faces[:, [2, 0]]])
        first, second = np.unique(np.sort(sides, axis=1), axis=0).T
        _, _, rows = np.linalg.svd(self.corners - self.corners.mean(axis=0), full_matrices=False)
        for normal in (*np.eye(3), *rows):
            along = self.vertices @ normal
            for height in along.min() + np.ptp(along) * PLACES:
                below, above = along[first] - height, along[second] - height
                crossed = below * above < 0.0
                share = (below[crossed] / (below[crossed] - above[crossed]))[:, None]
                ends = self.vertices[first[crossed]], self.vertices[second[crossed]]
                on = ends[0] + share * (ends[1] - ends[0])
                halves = [
                    np.concatenate([self.vertices[own], on]) for own in (along <= height, along >= height)
                ]
                if min(map(len, halves)) > 3:
                    yield sum(_hull(half)[1] for half in halves), normal, float(height)


def _hull(points: Array) -> tuple[Array, float]:
    """The corners of a convex hull, and its volume."""
    from scipy.spatial import ConvexHull, QhullError  # takes a fifth of a second to load

    try:
        hull = ConvexHull(points)
    except QhullError:  # in a plane, or on a line
        return np.unique(points, axis=0), 0.0
    return np.asarray(points[np.sort(hull.vertices)]), float(hull.volume)
