"""How far our figures agree with those measured: slopes through zero, and root mean square differences.

    slope = sum(ours * measured) / sum(measured^2)        rms = sqrt(mean((ours - measured)^2))

Moments of people who were measured standing still as well are compared as changes from there: markers and
plates that are a few centimetres off change both alike.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from evodesign.human.measured_posture import HumanPosture
from evodesign.validation.compare import POSTURES, ComparedCase
from evodesign.validation.holds import ComparedHold
from evodesign.validation.measured import HANGING, HOLDING
from evodesign.validation.posed import Posed

WAYS: tuple[HumanPosture | None, ...] = (None, *POSTURES)
"""What is compared with measurements: statics in the measured postures, then predictions."""

LABELS = {"l5s1": "L5/S1", "hips": "hips", "knees": "knees", "ankles": "ankles"}

ANGLES = ("trunk_low", "trunk_up", "hip_flex", "knee", "shank")


@dataclass(frozen=True, slots=True)
class Agreement:
    """Of some figures with those measured.

    Args:
        slope: through zero; None of angles, and where all that was measured is zero.
        off: root mean square of the differences, in the figures' unit.
    """

    slope: float | None
    off: float


@dataclass(frozen=True, slots=True)
class Agreements:
    """Of one quantity of one lift.

    Args:
        lift: what was measured.
        quantity: a joint's moment, or angles.
        unit: of differences.
        cases: how many hold the load and can be compared.
        by_way: in the order of `WAYS`; None where there is nothing to compare.
    """

    lift: str
    quantity: str
    unit: str
    cases: int
    by_way: tuple[Agreement | None, ...]


def agreements(compared: Sequence[ComparedCase]) -> list[Agreements]:
    """Of each lift: moments as they were measured and as changes from standing, then angles."""
    found = []
    for lift in dict.fromkeys(each.case.lift for each in compared):
        own = [each for each in compared if each.case.lift == lift]
        held = [each for each in own if each.case.hands == HOLDING]
        standing = {each.case.who: each for each in own if each.case.hands == HANGING}
        for name, label in LABELS.items():
            known = [each for each in held if name in each.moments and name in each.ours.moments]
            if known and not standing:
                found.append(_moments(lift, label, name, known, {}))
            from_standing = [each for each in known if each.case.who in standing]
            if from_standing:
                if name == "l5s1":
                    found.append(_moments(lift, label, name, known, {}))
                found.append(_moments(lift, f"{label}, change from standing", name, from_standing, standing))
        if held:
            ways = (None, *(_angles(held, posture) for posture in POSTURES))
            what = "five angles" if held[0].case.has_legs else "two angles of the trunk"
            found.append(Agreements(lift, what, "degrees", len(held), ways))
    return found


def _moments(
    lift: str, label: str, name: str, of: Sequence[ComparedCase], standing: dict[str, ComparedCase]
) -> Agreements:
    def pairs(posture: HumanPosture | None) -> Iterable[tuple[float, float]]:
        for each in of:
            ours, still = each.given(posture), standing.get(each.case.who)
            if ours is not None:
                zero = (still.ours.moments[name], still.moments[name]) if still else (0.0, 0.0)
                yield ours.moments[name] - zero[0], each.moments[name] - zero[1]

    return Agreements(lift, label, "N m", len(of), tuple(_agreement([*pairs(way)]) for way in WAYS))


def _agreement(pairs: Sequence[tuple[float, float]]) -> Agreement | None:
    if not pairs:
        return None
    squares = math.fsum(b * b for _, b in pairs)
    slope = math.fsum(a * b for a, b in pairs) / squares if squares else None
    return Agreement(slope, _rms([a - b for a, b in pairs]))


def _angles(of: Iterable[ComparedCase], posture: HumanPosture) -> Agreement | None:
    off = [
        (ours.angles[name] - each.ours.angles[name] + 180.0) % 360.0 - 180.0
        for each in of
        for name in ANGLES
        if (ours := each.given(posture)) is not None and name in each.ours.angles
    ]
    return Agreement(None, _rms(off)) if off else None


def _rms(off: Sequence[float]) -> float:
    return math.hypot(*off) / math.sqrt(len(off))


DIGITS = 3
"""Of numbers in JSON, after the point."""


def validation_json(compared: Sequence[ComparedCase], holds: Sequence[ComparedHold]) -> dict[str, Any]:
    """Every case, how far figures agree, and holds that were settled, as `validate --json` prints them."""
    return {
        "lifts": [_case(each) for each in compared],
        "agreement": [_agreements(each) for each in agreements(compared)],
        "holds": [_hold(each) for each in holds],
    }


def _case(each: ComparedCase) -> dict[str, Any]:
    case = each.case
    return {
        "lift": case.lift,
        "who": case.who,
        "stature_m": case.person.stature,
        "mass_kg": case.person.mass,
        "sex": str(case.person.sex),
        "hands": case.hands,
        "wrists": case.range,
        "frames": len(case.frames),
        "palms_m": round(each.palms, DIGITS),
        "hand_force_n": round(each.hand_force, DIGITS),
        "measured_n_m": _rounded(each.moments),
        "measured_posture": _posed(each.ours),
        "predicted": {str(kind): _posed(posed) for kind, posed in each.predicted.items()},
    }


def _posed(posed: Posed | None) -> dict[str, Any] | None:
    if posed is None:
        return None
    places = {name: [round(value, DIGITS) for value in place] for name, place in posed.places.items()}
    return {
        "moments_n_m": _rounded(posed.moments),
        "angles_deg": _rounded(posed.angles),
        "places_x_z_m": places,
    }


def _agreements(each: Agreements) -> dict[str, Any]:
    told: dict[str, Any] = {
        "lift": each.lift,
        "quantity": each.quantity,
        "unit": each.unit,
        "cases": each.cases,
    }
    for way, found in zip(WAYS, each.by_way, strict=True):
        slope = None if found is None or found.slope is None else round(found.slope, DIGITS)
        told[way or "statics"] = found and {"slope": slope, "rms": round(found.off, DIGITS)}
    return told


def _hold(each: ComparedHold) -> dict[str, Any]:
    predicted = {
        str(kind): None if angles is None else _rounded(angles) for kind, angles in each.predicted.items()
    }
    return {
        "source": each.source,
        "who": each.who,
        "palms_over_stature": each.eta,
        "measured_deg": _rounded(each.measured),
        "predicted_deg": predicted,
    }


def _rounded(values: Any) -> dict[str, float]:
    return {name: round(value, DIGITS) for name, value in values.items()}
