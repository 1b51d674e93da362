"""How much shorter and longer links may get: as far as no body comes into another that was clear of it.

    from 0.6 to 1.6, and nearer to 1 where in steps of 0.05 with all joints at zero two bodies overlap by more
    than 3 mm that are clear of each other in the robot as it is

Counted are bodies with two or three joints between them: one joint joins its bodies, and what is farther
away, as a hand from a thigh, is kept clear by the posture.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

from evodesign.body.placement import Placement
from evodesign.collision.clearance import PlacedSolids, Places, SolidBodies, places_of
from evodesign.tree.frames import link_frames
from evodesign.tree.model import JointKind, Tree
from evodesign.tree.resize import resize

LOWER, UPPER, STEP = 0.6, 1.6, 0.05
"""Bounds of length multipliers where nothing is in the way, and how finely others are found."""

NEAR = (2, 3)
"""Joints between two bodies that their build keeps clear of each other."""

DEEPEST = 0.003
"""Overlap of two bodies [m] that is a matter of their accuracy."""


@dataclass(frozen=True, slots=True)
class LengthBound:
    """A bound of a multiplier, and the two bodies that would overlap beyond it; none if none would."""

    multiplier: float
    overlap: tuple[str, str] | None = None


def length_bounds(tree: Tree, links: Sequence[str]) -> tuple[LengthBound, LengthBound]:
    """The lower and the upper bound of a length multiplier.

    Args:
        tree: the robot, unscaled.
        links: that share the multiplier; without any, or without shapes, both bounds are the farthest.
    """
    if not links or not SolidBodies.of_tree(tree).names:
        return LengthBound(LOWER), LengthBound(UPPER)
    clear = _clear(tree)
    return _bound(tree, links, clear, LOWER, -STEP), _bound(tree, links, clear, UPPER, STEP)


def _bound(tree: Tree, links: Sequence[str], clear: Places, farthest: float, step: float) -> LengthBound:
    """The last multiplier on the way from 1 with which nothing overlaps."""
    for number in range(1, round((farthest - 1.0) / step) + 1):
        resized = resize(tree, dict.fromkeys(links, 1.0 + number * step), {})
        if overlaps := _placed(resized).overlapping(clear, within=-DEEPEST):
            deepest = min(overlaps, key=lambda gap: gap.distance)
            return LengthBound(round(1.0 + (number - 1) * step, 2), (deepest.first, deepest.second))
    return LengthBound(farthest)


def _placed(tree: Tree) -> PlacedSolids:
    """The solids of a tree with all joints at zero."""
    return SolidBodies.of_tree(tree).placed(link_frames(tree, Placement(), {}))


def _clear(tree: Tree) -> Places:
    """Pairs of bodies that are near each other in the tree, and clear of each other."""
    placed = _placed(tree)
    names = tuple(dict.fromkeys(placed.names))
    near = [pair for pair in combinations(names, 2) if _joints_between(tree, *pair) in NEAR]
    touching = {(gap.first, gap.second) for gap in placed.overlapping(places_of(placed.names, near))}
    return places_of(placed.names, [pair for pair in near if pair not in touching])


def _joints_between(tree: Tree, first: str, second: str) -> int:
    """Joints, fixed ones aside, on the way from one link to another."""
    ways = [{link for link in tree.to_root(name) if link != tree.root} for name in (first, second)]
    return sum(tree.parent_joint[link].kind is not JointKind.FIXED for link in ways[0] ^ ways[1])
