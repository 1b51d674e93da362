"""What was compared, as the JSON that `validate --json` prints."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from evodesign.validation.agreement import WAYS, Agreement, Agreements, agreements
from evodesign.validation.compare import ComparedCase
from evodesign.validation.holds import ComparedHold
from evodesign.validation.posed import Posed

DIGITS = 3


def validation_json(compared: Sequence[ComparedCase], holds: Sequence[ComparedHold]) -> dict[str, Any]:
    """Every case, how far figures agree, and holds that were settled."""
    return {
        "lifts": [_case(each) for each in compared],
        "agreement": [_agreements(each) for each in agreements(compared)],
        "holds": [_hold(each) for each in holds],
    }


def way_name(posture: str | None) -> str:
    """What is compared: statics in the measured postures, or what decides a prediction."""
    return "statics" if posture is None else str(posture)


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
    ways = {way_name(way): _agreement(found) for way, found in zip(WAYS, each.by_way, strict=True)}
    return {
        "lift": each.lift, "quantity": each.quantity, "unit": each.unit, "cases": each.cases, **ways
    }  # fmt: skip


def _agreement(found: Agreement | None) -> dict[str, float | None] | None:
    if found is None:
        return None
    slope = None if found.slope is None else round(found.slope, DIGITS)
    return {"slope": slope, "rms": round(found.off, DIGITS)}


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
