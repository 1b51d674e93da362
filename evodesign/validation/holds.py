"""People who hold something still above hip height, beside a person who is predicted there.

Their statures, sexes and loads are unknown, so one person of middling figures stands for all; forces were not
measured. These very rows, rounded by hand, are behind the measured postures above 0.54 of stature: the
comparison shows how far torques pull a person from the mean, not how well somebody else is predicted.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from evodesign.human.anthropometry import Person
from evodesign.human.anthropometry_tables import Sex, ShoulderWidth
from evodesign.human.measured_posture import HumanPosture
from evodesign.validation.compare import POSTURES, Holder
from evodesign.validation.measured import data_rows
from evodesign.validation.posed import PosedPerson

SOMEONE = Person(1.75, 75.0, Sex.MALE, ShoulderWidth.JOINT_CENTRES)
LOAD = 5.0
"""What is held [kg]: an assumption."""

HOLD_ANGLES = ("trunk_low", "trunk_up", "knee", "shank", "arm", "elbow")


@dataclass(frozen=True, slots=True)
class ComparedHold:
    """A person at one height of the palms.

    Args:
        source: as in the data file.
        who: of the source's people.
        eta: height of the palms over stature.
        measured: angles [degrees]; without those that were not measured.
        predicted: likewise, by what decides the posture; None where there is none.
    """

    source: str
    who: str
    eta: float
    measured: Mapping[str, float]
    predicted: Mapping[HumanPosture, Mapping[str, float] | None]


def compare_holds() -> list[ComparedHold]:
    """All rows of `data/settled_holds.csv`."""
    person = PosedPerson(SOMEONE)
    holders = {kind: Holder(person, kind) for kind in POSTURES}
    found = []
    for row in data_rows("settled_holds.csv"):
        eta, cells = float(row["eta"]), {name: row[f"{name}_deg"] for name in HOLD_ANGLES}
        measured = {name: float(cell) for name, cell in cells.items() if cell}
        predicted = {kind: _angles(holder, eta) for kind, holder in holders.items()}
        found.append(ComparedHold(row["source"], row["person"], eta, measured, predicted))
    return found


def _angles(holder: Holder, eta: float) -> Mapping[str, float] | None:
    posture = holder.hold(eta * SOMEONE.stature, LOAD)
    if posture is None:
        return None
    angles = holder.posed.posed(posture, 0.0).angles
    return {name: angles[name] for name in HOLD_ANGLES}


def hold_differences(of: Sequence[ComparedHold], posture: HumanPosture) -> Mapping[str, float]:
    """Root mean square difference of each angle [degrees], over holds in which it was measured."""
    found = {}
    for name in HOLD_ANGLES:
        pairs = [(each.predicted[posture], each.measured) for each in of if name in each.measured]
        off = [ours[name] - measured[name] for ours, measured in pairs if ours is not None]
        if off:
            found[name] = math.hypot(*off) / math.sqrt(len(off))
    return found
