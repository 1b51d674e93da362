"""How long a person can hold a posture: the joint whose strength tires first.

    time = b0 share^b1 [s]        share = |torque| / strength of the joint in that direction

with b0 and b1 of the joint's region of the body. The least time of all joints of known strength counts; it is
not always that of the joint with the largest share, since shoulders tire sooner than ankles. Below a share of
0.10 the curve is continued beyond most of its data, below 0.01 it is held constant.

Source: Frey Law and Avin 2010, Ergonomics 53(1): 109-129, Table 2 (`data/endurance.toml`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

from evodesign.human.anthropometry_tables import figures
from evodesign.human.body import LEFT, RIGHT
from evodesign.human.strength import JointStrength, RelativeTorque, relative_torques
from evodesign.records import Record


class EnduranceCurve(Record, frozen=True):
    """A power model: seconds at full strength, and the exponent of the share."""

    seconds: float
    exponent: float

    def at(self, share: float) -> float:
        """The holding time [s] at a share of the strength."""
        return float(self.seconds * max(share, endurance_tables().drawn_from) ** self.exponent)


class Region(EnduranceCurve, frozen=True):
    """A region of the body: how the names of its joints begin, the left one for both sides."""

    name: str
    joints: tuple[str, ...]


class EnduranceTables(Record, frozen=True):
    """The whole data file."""

    citation: str
    checked: str
    measured_from: float
    drawn_from: float
    general: EnduranceCurve
    regions: tuple[Region, ...]


@cache
def endurance_tables() -> EnduranceTables:
    """The figures of `data/endurance.toml`."""
    return figures("endurance.toml", EnduranceTables)


@cache
def _curve(joint: str) -> EnduranceCurve:
    name, tables = joint.replace(RIGHT, LEFT), endurance_tables()
    return next((region for region in tables.regions if name.startswith(region.joints)), tables.general)


def holding_time(joint: str, share: float) -> float:
    """How long a joint can hold a share of its strength [s]."""
    return _curve(joint).at(share)


@dataclass(frozen=True, slots=True)
class Endurance:
    """The joint that tires first.

    Args:
        joint: with its torque and share of the strength.
        seconds: how long it can hold them.
    """

    joint: RelativeTorque
    seconds: float

    @property
    def measured(self) -> bool:
        """Whether the share is one at which times were measured."""
        return endurance_tables().measured_from <= self.joint.share <= 1.0

    @property
    def known_seconds(self) -> float:
        """The time [s] at the lowest share at which times were measured, if the joint's is lower."""
        return holding_time(self.joint.joint, max(self.joint.share, endurance_tables().measured_from))

    @property
    def by_torque(self) -> float:
        """The derivative of the seconds by the torque [s/N m]."""
        if self.joint.share <= endurance_tables().drawn_from:
            return 0.0
        return _curve(self.joint.joint).exponent * self.seconds / self.joint.torque


def endurance(torques: Mapping[str, float], strengths: Mapping[str, JointStrength]) -> Endurance | None:
    """How long torques can be held; None where no torque has a strength.

    Args:
        torques: [N m] by joint name.
        strengths: of the person.
    """
    found = [
        Endurance(joint, holding_time(joint.joint, joint.share))
        for joint in relative_torques(torques, strengths)
    ]
    return min(found, key=lambda each: each.seconds, default=None)
