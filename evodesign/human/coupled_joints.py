"""Joints of a person that depend on each other: the spine bends as a whole, not each of its joints by itself.

    lower <= sum of the positions of some joints <= upper        a shared range
    q_i = s_i Q,    sum s_i = 1,    lower <= Q <= upper          a rhythm: one movement in the joints' place

The joints are those of the generated person; a person from a URDF can have both where it has joints of these
names, with zero upright and flexion positive about y.

Source: the `sources` of `data/coupled_joints.toml`; docs/person.md.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

from evodesign.human.anthropometry_tables import figures
from evodesign.records import Record


class SharedRange(Record, frozen=True):
    """A range of the sum of joints' positions [degrees], and the key of its source."""

    name: str
    joints: tuple[str, ...]
    range_deg: tuple[float, float]
    source: str


class RhythmRow(Record, frozen=True):
    """A movement that joints make together, each a share of it, and the key of its source."""

    name: str
    joints: tuple[str, ...]
    shares: tuple[float, ...]
    source: str


class SharedRanges(Record, frozen=True):
    """The whole data file."""

    sources: dict[str, str]
    ranges: tuple[SharedRange, ...]
    rhythms: tuple[RhythmRow, ...]


@cache
def shared_ranges() -> SharedRanges:
    """The figures of `data/coupled_joints.toml`."""
    return figures("coupled_joints.toml", SharedRanges)


@dataclass(frozen=True, slots=True)
class CoupledJoints:
    """Joints whose positions sum to no less than `lower` and no more than `upper` [rad].

    Args:
        name: of the movement that they make together.
        joints: their names.
        lower, upper: of the sum; zero lies between.
    """

    name: str
    joints: tuple[str, ...]
    lower: float
    upper: float


def coupled_joints() -> tuple[CoupledJoints, ...]:
    """All published ranges that a person's joints share."""
    return tuple(
        CoupledJoints(each.name, each.joints, *(math.radians(limit) for limit in each.range_deg))
        for each in shared_ranges().ranges
    )


@dataclass(frozen=True, slots=True)
class Rhythm:
    """One movement in the place of several joints.

    Args:
        name: of the movement.
        joints: their names.
        shares: of the movement, one per joint; they sum to one.
        lower, upper: of the movement [rad]; zero lies between.
    """

    name: str
    joints: tuple[str, ...]
    shares: tuple[float, ...]
    lower: float
    upper: float


def rhythms() -> tuple[Rhythm, ...]:
    """All movements that a person's spine makes as a whole, within the ranges that its joints share."""
    return tuple(
        Rhythm(row.name, row.joints, row.shares, *_limits(row.joints, row.shares))
        for row in shared_ranges().rhythms
    )


def _limits(joints: tuple[str, ...], shares: tuple[float, ...]) -> tuple[float, float]:
    """Of a movement [rad]: where the first of the ranges of its joints ends."""
    share = dict(zip(joints, shares, strict=True))
    ranges = [
        (each.lower / part, each.upper / part)
        for each in coupled_joints()
        if (part := math.fsum(share.get(name, 0.0) for name in each.joints)) > 0.0
    ]
    return max(lower for lower, _ in ranges), min(upper for _, upper in ranges)
