"""Joints of a person that share a range: the spine bends as a whole, not each of its joints as far as it can.

    lower <= sum of the positions of some joints <= upper

The joints are those of the generated person; a person from a URDF shares ranges where it has joints of these
names, with zero upright and flexion positive about y.

Source: the `sources` of `data/coupled_joints.toml`; docs/person.md.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

from evodesign.human.anthropometry_tables import figures
from evodesign.records import Record

__all__ = ["CoupledJoints", "SharedRanges", "coupled_joints", "shared_ranges"]


class SharedRange(Record, frozen=True):
    """A range of the sum of joints' positions [degrees], and the key of its source."""

    name: str
    joints: tuple[str, ...]
    range_deg: tuple[float, float]
    source: str


class SharedRanges(Record, frozen=True):
    """The whole data file."""

    sources: dict[str, str]
    ranges: tuple[SharedRange, ...]


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
