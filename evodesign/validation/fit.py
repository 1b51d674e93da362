"""A generated person fitted to a recording: stature by limbs, mass by a plate, posture beside the mean.

    stature = sum of measured lengths / sum of the same lengths of a person of stature 1
    mass = median of (F_plate - F_hands) / g

Lengths are means over frames of upper arm, forearm, thigh and shank; those of a generated person grow with
stature alone.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from statistics import fmean, median

from evodesign.human.anthropometry import Person
from evodesign.human.measured_posture import FEATURES, HumanPosture, measured_posture
from evodesign.mechanics.balance import GRAVITY
from evodesign.validation.agreement import WAYS, Agreement, agreements
from evodesign.validation.compare import ComparedCase, palms_of
from evodesign.validation.measured import HOLDING, Frame
from evodesign.validation.posed import OF_LEGS, PosedPerson

LIMBS = (("shoulder", "elbow"), ("elbow", "wrist"), ("hip", "knee"), ("knee", "ankle"))
BESIDE_MEAN = ("trunk_low", "trunk_up", "knee", "shank", "arm", "elbow")


@dataclass(frozen=True, slots=True)
class Fit:
    """Figures of a person who was measured.

    Args:
        stature: [m]; None where the legs were not placed: arms alone tell too little.
        mass: [kg]; None where no plate tells it apart from the hands' force.
        l5s1: height of L5/S1 above the hips over stature; None where it was not placed.
        offsets: mean of measured angles less the mean of measured people at the same height [degrees], while
            the load is held; empty where it never is.
    """

    stature: float | None
    mass: float | None
    l5s1: float | None
    offsets: Mapping[str, float]


def fit(person: Person, compared: Sequence[ComparedCase]) -> Fit:
    """The person of a recording.

    Args:
        person: as it was described, from whom lengths and mean postures are taken.
        compared: cases of the recording.
    """
    frames = [frame for each in compared for frame in each.case.frames]
    stature = _stature(person, frames) if {"knee", "ankle"} <= frames[0].places.keys() else None
    weights = [f.plate.up - f.hand_force for f in frames if f.plate is not None and f.hand_measured]
    mass = median(weights) / GRAVITY if weights else None
    height = stature or person.stature
    fitted = PosedPerson(replace(person, stature=height, mass=mass or person.mass))
    return Fit(
        stature,
        mass,
        _length(frames, "hip", "l5s1") / height if "l5s1" in frames[0].places else None,
        _offsets(fitted, [f for each in compared if each.case.hands == HOLDING for f in each.case.frames]),
    )


def _stature(person: Person, frames: Sequence[Frame]) -> float:
    posed = PosedPerson(person)
    places = posed.places(posed.model.at(posed.from_angles(dict.fromkeys(FEATURES, 0.0))))
    measured = math.fsum(_length(frames, *limb) for limb in LIMBS)
    return person.stature * measured / math.fsum(math.dist(places[a], places[b]) for a, b in LIMBS)


def _length(frames: Iterable[Frame], a: str, b: str) -> float:
    return fmean(math.dist(frame.places[a], frame.places[b]) for frame in frames)


def _offsets(person: PosedPerson, held: Iterable[Frame]) -> Mapping[str, float]:
    stature, found = person.person.stature, dict[str, list[float]]()
    given = measured_posture(stature)
    for frame in held:
        mean = given.hold.mean(palms_of(person, frame) / stature)
        posed = person.posed(person.from_places(frame.places), frame.hand_force)
        for name in BESIDE_MEAN:
            if {"ankle", "knee"} <= frame.places.keys() or name not in OF_LEGS:
                found.setdefault(name, []).append(posed.angles[name] - math.degrees(mean[name]))
    return {name: fmean(values) for name, values in found.items()}


def fitted_person(person: Person, found: Fit) -> Person:
    """The person with the stature and the mass that were measured."""
    return replace(person, stature=found.stature or person.stature, mass=found.mass or person.mass)


def fit_lines(
    person: Person, found: Fit, before: Sequence[ComparedCase], after: Sequence[ComparedCase]
) -> list[str]:
    """The person's table of a problem file, with what has no key as remarks.

    Args:
        person: as it was described.
        found: its figures.
        before: cases of the recording beside the person as it was described.
        after: the same beside the fitted one.
    """
    fitted = fitted_person(person, found)
    stature, mass = fitted.stature, fitted.mass
    lines = [
        "[human]",
        f"stature_m = {stature:.3f}" + ("" if found.stature else "  # as given: no knees and ankles"),
        f"mass_kg = {mass:.1f}" + ("" if found.mass else "  # as given: no plate beside hand_force_n"),
        f'sex = "{person.sex}"',
        'posture = "measured"',
    ]
    if found.l5s1 is not None:
        lines.append(f"# L5/S1 is {found.l5s1:.3f} of stature above the hips")
    if found.offsets:
        words = ", ".join(f"{name} {value:+.0f}" for name, value in found.offsets.items())
        lines.append(f"# beside the mean of measured people [degrees]: {words}")
    for old, new in zip(agreements(before), agreements(after), strict=True):
        for way, given, now in zip(WAYS, old.by_way, new.by_way, strict=True):
            if given is not None and now is not None and way is not HumanPosture.LEAST_TORQUE:
                what = f"{old.quantity}, {'predicted' if way else 'statics'}"
                lines.append(
                    f"# {what}: {_words(given, old.unit)} as described, {_words(now, old.unit)} fitted"
                )
    return lines


def _words(found: Agreement, unit: str) -> str:
    slope = "" if found.slope is None else f"slope {found.slope:.2f}, "
    return f"{slope}{found.off:.0f} {unit} rms"
