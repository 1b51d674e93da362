"""What was measured, what our statics give in the same postures, and what we predict in their place.

A lift passes through each height; what is compared is how the person would hold the load there at rest.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property
from statistics import fmean

import numpy as np

from evodesign.human.anthropometry import Person
from evodesign.human.measured_posture import ASSUMPTION, HumanPosture, PostureRow, posture_rows
from evodesign.mechanics.agent import HUMAN, ROBOT, Role
from evodesign.mechanics.balance import GRAVITY
from evodesign.mechanics.payload import Payload
from evodesign.mechanics.scene import Scene
from evodesign.nlp.method import SolverOptions
from evodesign.nlp.solver import SolverCache
from evodesign.posture.formulations.person import PersonProblem
from evodesign.posture.results import AgentPosture
from evodesign.posture.symmetry import Form, half
from evodesign.posture.warm_start import instants_of, layout_of
from evodesign.validation.measured import HANGING, HOLDING, Frame, MeasuredCase, box_lifts
from evodesign.validation.posed import ANGLES, MOMENTS, Posed, PosedPerson, agent_of

POSTURES = (HumanPosture.MEASURED, HumanPosture.LEAST_TORQUE)

MEN_OF_PRIOR = "box lift"
"""The lift whose people are behind the measured postures: each is predicted from the others."""

LARGE = (0.5, 0.5, 0.025)
"""Size of the load [m]: as thin as it must be for palms at the height that was measured."""


@dataclass(frozen=True, slots=True)
class ComparedCase:
    """One case, and what we make of it.

    Args:
        case: what was measured.
        palms: height of the palms [m], mean of the frames.
        hand_force: weight in the hands [N], likewise.
        moments: measured [N m], likewise; empty where there are none.
        ours: our statics in the measured postures, their angles and places, likewise.
        predicted: a hold at this height with this weight, by what decides the posture; None: there is none.
    """

    case: MeasuredCase
    palms: float
    hand_force: float
    moments: Mapping[str, float]
    ours: Posed
    predicted: Mapping[HumanPosture, Posed | None]

    def given(self, posture: HumanPosture | None) -> Posed | None:
        """Our statics in the measured postures, or a prediction, if there is one."""
        return self.ours if posture is None else self.predicted.get(posture)


@dataclass(frozen=True)
class Holder:
    """A person who holds loads alone: each of twice its weight, which two hold by point grasps.

    Args:
        posed: the person.
        posture: what decides how the person stands.
        rows: of measured postures, in place of those of the data file.
    """

    posed: PosedPerson
    posture: HumanPosture
    rows: Sequence[PostureRow] | None = None

    @cached_property
    def _form(self) -> Form:
        return half(agent_of(self.posed.person, self.posture, self.rows))

    @cached_property
    def _solvers(self) -> SolverCache:
        return SolverCache()

    def hold(self, palms: float, load: float) -> AgentPosture | None:
        """How the person stands with a load [kg] in the palms at a height [m], ankles at x = 0."""
        agent = self._form.agent
        scene = Scene(
            (replace(agent, name=ROBOT, role=Role.ROBOT, quarters=0), agent), Payload(LARGE, 2.0 * load)
        )
        problem = PersonProblem(self._form, scene, 1.0, SolverOptions(compiled=False), self._solvers)
        raw = problem.best_of_many(palms - LARGE[2] / 2.0, 0.0)
        if raw is None:
            return None
        layout = layout_of(problem.program, HUMAN)
        (instant,) = instants_of(layout, (self._form,), scene, raw.values)
        posture = instant.postures[HUMAN]
        base = posture.base_position.copy()
        base[0] -= self.posed.places(self.posed.model.at(posture))["ankle"][0]
        return replace(posture, base_position=base)


def compare(
    cases: Iterable[MeasuredCase], progress: Callable[[MeasuredCase], None] = lambda _: None
) -> list[ComparedCase]:
    """All cases, one after the other; each person is built once."""
    people: dict[Person, PosedPerson] = {}
    holders: dict[tuple[Person, str], dict[HumanPosture, Holder]] = {}
    found = []
    for case in cases:
        progress(case)
        person = people.setdefault(case.person, PosedPerson(case.person))
        left_out = case.who if case.lift == MEN_OF_PRIOR else ""
        rows = rows_without(left_out) if left_out else None
        own = holders.setdefault(
            (case.person, left_out), {kind: Holder(person, kind, rows) for kind in POSTURES}
        )
        found.append(_compared(case, person, own))
    return found


def _compared(
    case: MeasuredCase, person: PosedPerson, holders: Mapping[HumanPosture, Holder]
) -> ComparedCase:
    pairs = [
        (person.from_places(each.places) if each.places else person.from_angles(each.features), each)
        for each in case.frames
    ]
    ours = _mean([person.posed(posture, frame.hand_force) for posture, frame in pairs])
    palms = fmean(palms_of(person, frame) for frame in case.frames)
    force = fmean(frame.hand_force for frame in case.frames)
    measured = [_moments(person, *pair) for pair in pairs]
    moments = {name: fmean(each[name] for each in measured) for name in measured[0]}
    shown = {HANGING: (), HOLDING: POSTURES}.get(case.hands, POSTURES[:1])
    holds = {kind: holders[kind].hold(palms, force / GRAVITY) for kind in shown}
    predicted = {
        kind: None if posture is None else person.posed(posture, force) for kind, posture in holds.items()
    }
    return ComparedCase(case, palms, force, moments, ours if case.has_legs else ours.above_legs(), predicted)


def palms_of(person: PosedPerson, frame: Frame) -> float:
    """Height of a frame's palms [m]."""
    if frame.places:
        (x, z), (to_x, to_z) = frame.places["elbow"], frame.places["wrist"]
        fore = math.atan2(to_x - x, z - to_z)
    else:
        fore = frame.features["arm"] + frame.features["elbow"]
    return palm_height(frame.wrist, fore, person.person.stature)


def _moments(person: PosedPerson, posture: AgentPosture, frame: Frame) -> Mapping[str, float]:
    """Measured moments: as they are given, or that at L5/S1 from the plate."""
    if frame.moments or frame.plate is None:
        return frame.moments
    plate = frame.plate
    return {"l5s1": person.l5s1_from_below(posture, frame.hand_force, (plate.forward, plate.up), plate.x)}


def _mean(of: Sequence[Posed]) -> Posed:
    return Posed(
        {name: fmean(each.moments[name] for each in of) for name in MOMENTS},
        {name: fmean(each.angles[name] for each in of) for name in ANGLES},
        {
            name: (fmean(each.places[name][0] for each in of), fmean(each.places[name][1] for each in of))
            for name in of[0].places
        },
    )


HAND = 0.0495
"""From wrist to palm, over stature: that of the generated man."""

USED = ((1, "empty"), (2, "box"), (3, "box"), (4, "box"), (5, "box"))
"""Ranges of height, from number times 0.15 m, and what the hands hold there."""

SIDEWAYS = (0.15, 0.2)
"""Mean and deviation of the upper arm's sine outwards: an assumption."""


def palm_height(wrist: float, fore: float, stature: float) -> float:
    """Height of the palms [m] from that of the wrists, with the forearm at an angle [rad] from hanging."""
    return wrist - HAND * stature * math.cos(fore)


@cache
def rows_without(who: str) -> tuple[PostureRow, ...]:
    """The rows of measured postures, those of the box lifts computed from all men but one, who is predicted.

    Source: the rows `boxlift` of `human/data/measured_posture.csv`, again from `data/box_lifts.csv`.
    """
    others = [case for case in box_lifts() if case.who != who]
    by_range = [[_features(c) for c in others if (c.bin, c.hands) == used] for used in USED]
    names = [name for name in by_range[0][0] if name != "eta"]
    spread = {
        name: float(np.sqrt(np.mean([np.var([man[name] for man in of], ddof=1) for of in by_range])))
        for name in names
    }
    found = []
    for of in by_range:
        mean = {name: float(np.mean([man[name] for man in of])) for name in of[0]}
        found += [
            PostureRow(name, "both", mean["eta"], mean[name], spread[name], len(of), "measured", "boxlift")
            for name in names
        ]
        found.append(PostureRow("sideways", "both", mean["eta"], *SIDEWAYS, 0, ASSUMPTION, "none"))
    return (*found, *(row for row in posture_rows() if row.task != "both" or math.isnan(row.eta)))


def _features(case: MeasuredCase) -> Mapping[str, float]:
    """Of a man in one range of height, as the data file has them."""
    (frame,), stature = case.frames, case.person.stature
    fore = frame.features["arm"] + frame.features["elbow"]
    angles = {name: math.degrees(value) for name, value in frame.features.items() if name != "ahead"}
    ahead = frame.features["ahead"] + HAND * math.sin(fore)
    return {**angles, "ahead": ahead, "eta": palm_height(frame.wrist, fore, stature) / stature}
