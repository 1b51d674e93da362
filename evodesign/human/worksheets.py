"""RULA and REBA: scores of a posture as an observer gives them with a worksheet.

Both look up a score of arm and wrist and one of neck, trunk and legs, add what is held and for how long, and
look up the whole. RULA ends at 7, REBA at 15; more is worse.

What the worksheets leave to the observer's eye is our choice: up to 5 degrees count as none, and an upper arm
is abducted from 20 degrees on.

Source: McAtamney and Corlett 1993; Hignett and McAtamney 2000 (`data/worksheets.toml`).
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

from evodesign.human.anthropometry_tables import figures
from evodesign.records import Record

UNSEEN = 5.0
"""Angle [degrees] that an observer takes for none."""

ABDUCTED = 20.0
"""From how many degrees on an upper arm counts as abducted."""

Rows = tuple[tuple[int, ...], ...]


class Worksheet(Record, frozen=True):
    """Tables of a worksheet.

    `arm` and `body` are looked up by posture scores, `whole` by the scores of both. RULA's `body` has no
    rows within rows; its columns hold two scores.
    """

    citation: str
    checked: str
    arm: tuple[Rows, ...]
    whole: Rows


class Rula(Worksheet, frozen=True):
    """Those of RULA."""

    body: Rows


class Reba(Worksheet, frozen=True):
    """Those of REBA."""

    body: tuple[Rows, ...]


class Worksheets(Record, frozen=True):
    """The whole data file."""

    rula: Rula
    reba: Reba


@cache
def worksheets() -> Worksheets:
    """The figures of `data/worksheets.toml`."""
    return figures("worksheets.toml", Worksheets)


@dataclass(frozen=True, slots=True)
class ArmSeen:
    """An arm as an observer sees it, angles in degrees.

    Args:
        upper: flexion of the upper arm against the trunk; negative: extension.
        abduction: of the upper arm.
        elbow: flexion.
        wrist: flexion or extension.
        deviation: of the wrist from the midline.
        raised: whether the shoulder is.
        aside: whether the forearm works across the midline or out to the side.
        twisted: whether the forearm is near the end of its rotation.
        supported: whether the arm is, or the person leans.
    """

    upper: float = 0.0
    abduction: float = 0.0
    elbow: float = 90.0
    wrist: float = 0.0
    deviation: float = 0.0
    raised: bool = False
    aside: bool = False
    twisted: bool = False
    supported: bool = False


@dataclass(frozen=True, slots=True)
class BodySeen:
    """Neck, trunk and legs as an observer sees them, angles in degrees.

    Args:
        neck: flexion against the trunk; negative: extension.
        trunk: flexion against the vertical; negative: extension.
        knee: flexion of the more bent one.
        neck_bent, neck_twisted, trunk_bent, trunk_twisted: to the side, and about the long axis.
        balanced: whether both feet carry the person.
    """

    neck: float = 0.0
    trunk: float = 0.0
    knee: float = 0.0
    neck_bent: float = 0.0
    neck_twisted: float = 0.0
    trunk_bent: float = 0.0
    trunk_twisted: float = 0.0
    balanced: bool = True


@dataclass(frozen=True, slots=True)
class HeldLoad:
    """What is held, and how.

    Args:
        load: [kg].
        still: whether the posture is held for longer than a minute.
        coupling: REBA's score of the grip: 0 good, 1 fair, 2 poor, 3 unacceptable.
    """

    load: float
    still: bool = True
    coupling: int = 2


@dataclass(frozen=True, slots=True)
class Score:
    """Scores of a worksheet.

    Args:
        arm: of arm and wrist, with what is added.
        body: of neck, trunk and legs, likewise.
        whole: what they are looked up as.
    """

    arm: int
    body: int
    whole: int


def _seen(*angles: float) -> int:
    """How many of some angles an observer sees."""
    return sum(abs(angle) > UNSEEN for angle in angles)


def _band(value: float, ends: Sequence[float]) -> int:
    """One for a value up to the first end, two up to the second, and so on."""
    return 1 + bisect_left(ends, value)


def _upper_arm(arm: ArmSeen) -> int:
    position = _band(arm.upper, (20.0, 45.0, 90.0)) if arm.upper >= -20.0 else 2
    return min(max(position + arm.raised + (arm.abduction > ABDUCTED) - arm.supported, 1), 6)


def _lower_arm(arm: ArmSeen) -> int:
    return 1 if 60.0 <= arm.elbow <= 100.0 else 2


def rula(arm: ArmSeen, body: BodySeen, held: HeldLoad) -> Score:
    """The grand score of RULA: 1 or 2 acceptable, 3 or 4 look into, 5 or 6 change soon, 7 change now.

    Args:
        arm: the one that is scored.
        body: the rest.
        held: what the hands hold; more than 2 kg, and more than 10 kg, count more if held still.
    """
    tables = worksheets().rula
    lower = _lower_arm(arm) + arm.aside
    wrist = _band(abs(arm.wrist), (UNSEEN, 15.0)) + _seen(arm.deviation)
    neck = 4 if body.neck < -UNSEEN else _band(body.neck, (10.0, 20.0))
    neck = min(neck + _seen(body.neck_twisted) + _seen(body.neck_bent), 6)
    trunk = _band(abs(body.trunk), (UNSEEN, 20.0, 60.0))
    trunk = min(trunk + _seen(body.trunk_twisted) + _seen(body.trunk_bent), 6)
    force = (0, 1, 2)[_band(held.load, (2.0, 10.0)) - 1]
    added = held.still + force + (held.still and force > 0)
    of_arm = tables.arm[_upper_arm(arm) - 1][lower - 1][2 * (wrist - 1) + arm.twisted] + added
    of_body = tables.body[neck - 1][2 * (trunk - 1) + (not body.balanced)] + added
    return Score(of_arm, of_body, tables.whole[min(of_arm, 8) - 1][min(of_body, 7) - 1])


def reba(arm: ArmSeen, body: BodySeen, held: HeldLoad) -> Score:
    """The score of REBA: 1 negligible, 2 or 3 low, 4 to 7 medium, 8 to 10 high, 11 to 15 very high risk.

    Args:
        arm: the one that is scored.
        body: the rest.
        held: what the hands hold; 5 kg count, and more than 10 kg count double.
    """
    tables = worksheets().reba
    neck = 1 if -UNSEEN <= body.neck <= 20.0 else 2
    neck += _seen(body.neck_twisted, body.neck_bent) > 0
    ends = (UNSEEN, 20.0) if body.trunk < 0.0 else (UNSEEN, 20.0, 60.0)
    trunk = _band(abs(body.trunk), ends) + (_seen(body.trunk_twisted, body.trunk_bent) > 0)
    knees = 0 if body.knee < 30.0 else 1 if body.knee <= 60.0 else 2
    legs = (1 if body.balanced else 2) + knees
    wrist = (1 if abs(arm.wrist) <= 15.0 else 2) + (_seen(arm.deviation) > 0 or arm.twisted)
    load = 0 if held.load < 5.0 else 1 if held.load <= 10.0 else 2
    of_body = tables.body[neck - 1][trunk - 1][legs - 1] + load
    of_arm = tables.arm[_upper_arm(arm) - 1][_lower_arm(arm) - 1][wrist - 1] + held.coupling
    return Score(of_arm, of_body, tables.whole[of_body - 1][of_arm - 1] + held.still)
