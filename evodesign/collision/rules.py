"""What an agent's bodies must keep clear of, as a problem asks for it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from evodesign.body.placement import Vector

BodyPair = tuple[str, str]
"""Names of two links; the second may be the load, the floor or the partner."""

LOAD, FLOOR, PARTNER = "load", "floor", "partner"
"""What a link may meet beside other links; a partner is anybody else who holds the load."""

PLANES = (FLOOR, PARTNER)
"""Those of them that planes through the origin part from an agent."""


def partner_side(size: Vector, quarters: int) -> Vector:
    """Direction towards a partner's side of the plane that parts both, a unit vector in the agent's frame.

    The plane is half-way between two who face each other, and cuts through the load's edge between two who
    stand at neighbouring sides.

    Args:
        size: depth, width and height of the load as the agent sees it [m].
        quarters: quarter turns from the agent's frame to the partner's.
    """
    depth, width, _ = size
    x, y = {1: (width, -depth), 2: (1.0, 0.0), 3: (width, depth)}[quarters % 4]
    return (x / math.hypot(x, y), y / math.hypot(x, y), 0.0)


@dataclass(frozen=True, slots=True)
class CollisionRules:
    """Pairs of an agent's links, and of links with load, floor and partner.

    Args:
        margin: least distance that programs ask for [m].
        checked: pairs that must not overlap.
        parted: those of them that have rows in programs: the ones that come near each other in postures.
        parted_at_reach: those that have rows in their place where the load is as high or low as it can be.
        built_in: pairs of links that some design's build brings together (`collision.pairs`).
        narrow: margins [m] of pairs that are built nearer to each other, or whose shapes in programs are
            coarse (`collision.margins`); minus infinity for pairs without rows.
    """

    margin: float
    checked: tuple[BodyPair, ...]
    parted: tuple[BodyPair, ...] = ()
    parted_at_reach: tuple[BodyPair, ...] = ()
    built_in: tuple[BodyPair, ...] = ()
    narrow: Mapping[BodyPair, float] = field(default_factory=dict)

    def margin_of(self, pair: BodyPair) -> float:
        """The least distance that programs ask for of a pair [m]."""
        return self.narrow.get(pair, self.narrow.get(pair[::-1], self.margin))

    @property
    def at_reach(self) -> CollisionRules:
        """With the rows of extreme heights in place of the others."""
        return replace(self, parted=self.parted_at_reach)
