"""Which corners of meshes decide how far two links are apart, where fitted shapes are too coarse to tell.

Links with two joints between them are built into each other, with a few millimetres between a shoulder and
its chest: the box or cylinder that fits such a mesh is coarser than the gap. Only a few corners of their
hulls ever face the other link: of all directions n along which random postures are parted, in robots of
least, own and largest size, those corners are kept that reach, up to a tolerance, as far as the hull does,

    max over n of  (max_all c . n  -  max_kept c . n)  <=  `TOLERANCE`

and a ball of the tolerance about each makes up for the others. The corner that is missed most is added until
none is.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Mapping, Sequence

import numpy as np

from evodesign.collision.clearance import SolidBodies, places_of
from evodesign.collision.pairs import placed_in_postures
from evodesign.collision.rules import BodyPair, Corners
from evodesign.collision.shapes import Array, hull_corners, solids_of
from evodesign.tree.model import Mesh, Tree

__all__ = ["TOLERANCE", "deciding_corners"]

TOLERANCE = 5e-4
"""By how much a hull may reach farther than the corners that are kept [m]."""

DEEP, NEAR = 0.03, 0.02
"""Overlaps and distances [m] between which directions count."""


def deciding_corners(
    trees: Sequence[Tree], joints: Collection[str], pairs: Collection[BodyPair]
) -> Mapping[BodyPair, tuple[Corners, Corners]]:
    """The corners of each pair that rows know, of those pairs that ever come near each other.

    Args:
        trees: of the agent in some designs, with the same meshes.
        joints: that move.
        pairs: of links.
    """
    faced: defaultdict[tuple[BodyPair, int], list[Array]] = defaultdict(list)
    for tree in trees:
        bodies, meshes = SolidBodies.of_tree(tree, cut=False), _meshes(tree)
        places = {pair: places_of(bodies.names, [pair]) for pair in pairs}
        for placed in placed_in_postures(tree, joints, bodies):
            for pair, own in places.items():
                for one, other in placed.maybe_near(own, NEAR).tolist():
                    distance, normal, *_ = placed.parted(one, other)
                    if -DEEP < distance < NEAR:
                        for place, towards in ((one, normal), (other, -normal)):
                            local = placed.rotations[place].T @ towards
                            faced[pair, place].append(_in_mesh(meshes[place], local))
    names, meshes = SolidBodies.of_tree(trees[0], cut=False).names, _meshes(trees[0])

    def corners(pair: BodyPair, link: str) -> Corners:
        own = [(place, mesh) for place, mesh in enumerate(meshes) if mesh and names[place] == link]
        return tuple(_farthest(mesh, faced.get((pair, place), [])) for place, mesh in own)

    near = [pair for pair in pairs if any(pair == known for known, _ in faced)]
    return {pair: (corners(pair, pair[0]), corners(pair, pair[1])) for pair in near}


def _meshes(tree: Tree) -> list[Mesh | None]:
    """The mesh that each uncut solid of `SolidBodies.of_tree` is the hull of; None for simple shapes."""
    found: list[Mesh | None] = []
    for link in tree.links:
        shown = [] if link.solids else [mesh for mesh in link.shown if mesh.surface is not None]
        found += shown or [None] * len(solids_of(link))
    return found


def _in_mesh(mesh: Mesh | None, direction: Array) -> Array:
    """What a direction in a link's axes is in those of its scaled mesh, before that is stretched."""
    if mesh is None:
        return direction
    return np.asarray(
        direction @ np.array(mesh.stretch, float) @ np.array(mesh.link_from_mesh.rotation, float)
    )


def _farthest(mesh: Mesh, directions: Sequence[Array]) -> tuple[int, ...]:
    """Places of the corners of a mesh's hull that reach farthest along directions, up to the tolerance."""
    if mesh.surface is None or not directions:
        return ()
    reaches = hull_corners(mesh.surface) * np.array(mesh.scale, float) @ np.array(directions).T
    farthest, kept = reaches.max(axis=0), list[int]()
    missed = np.full(len(directions), np.inf)
    while missed.max() > TOLERANCE:
        kept.append(int(reaches[:, missed.argmax()].argmax()))
        missed = farthest - reaches[kept].max(axis=0)
    return tuple(kept)
