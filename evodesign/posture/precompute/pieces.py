"""What is worked out once per problem, before any robot is evaluated: the pieces of a `Precomputed`.

A piece is a function of the problem alone and is kept, as JSON, under a digest of all of the setting, the
piece and the code but for named exceptions; so a score depends neither on a cache nor on who worked it out.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

import msgspec

from evodesign.design.space import DesignSpace
from evodesign.identity import Exceptions, code_digest, digest
from evodesign.mechanics.disturbance import Disturbances
from evodesign.mechanics.scene import Agent, Grasp, Payload, Scene
from evodesign.nlp.solver import IpoptOptions
from evodesign.nlp.start_portfolio import StartPortfolio, Training, spread_designs, start_portfolio
from evodesign.posture.allocation import EffortWeights
from evodesign.posture.formulations.base import Setting
from evodesign.posture.formulations.human_value import HumanProblem, HumanValue
from evodesign.posture.formulations.reach import HIGHEST, LOWEST, ReachProblem
from evodesign.posture.person_reach import person_reach
from evodesign.posture.postures import PostureProblem, Symmetry
from evodesign.posture.precompute.precomputed import Precomputed
from evodesign.posture.precompute.stored import (
    StoredPersonReach,
    StoredStartPortfolio,
    StoredValue,
    human_value_of_stored,
    person_reach_of_stored,
    portfolio_of,
    stored_person_reach,
    stored_portfolio,
    stored_value,
)
from evodesign.posture.symmetry import symmetric_forms

__all__ = ["Piece", "PrecomputeSetting", "Subject", "compute_piece", "key_of", "stages", "with_piece"]

REACH_TRAINING = Training(designs=32, starts=8)
HALF_TRAINING = Training(designs=48, starts=8)
DISTURBED_TRAINING = Training(designs=24, starts=6, rounds=2)
WHOLE_TRAINING = Training(designs=16, starts=6)

ITERATIONS = 80
"""Limit of a training solve; those that succeed mostly take 15 to 40."""

LOOKED_AT = 12
"""Designs looked at for each one that training asks for, where only some hold the load at a height."""


class Subject(StrEnum):
    """What a piece is about; the value is how it is told."""

    PERSON = "the person's part"
    PERSON_REACH = "the person's reach"
    HIGHEST = "starts of the highest load"
    LOWEST = "starts of the lowest load"
    POSTURE = "starts of postures"


@dataclass(frozen=True, slots=True)
class Piece:
    """A part of a preparation.

    Args:
        subject: what it is about.
        height: of the load [m]; 0 if it belongs to none.
        scene: which of the problem's scenes it is of, or is worked out in, from zero.
        label: who and what that is where there are several.
    """

    subject: Subject
    height: float = 0.0
    scene: int = 0
    label: str = ""

    def __str__(self) -> str:
        name = f"{self.subject} at {self.height:g} m" if self.height else str(self.subject)
        return f"{name}, {self.label}" if self.label else name


@dataclass(frozen=True, slots=True)
class PrecomputeSetting:
    """What the pieces of a problem follow from; as for `PostureProblem`.

    Args:
        scenes: every person with every load.
        middle: the scene that portfolios are made in.
    """

    scenes: tuple[Scene, ...]
    middle: int
    space: DesignSpace
    weights: EffortWeights
    options: IpoptOptions
    symmetry: Symmetry

    @property
    def symmetric(self) -> bool:
        """Whether symmetric postures are looked for, at least at first."""
        return self.symmetry is not Symmetry.OFF


NO_PART_OF_PIECES: Exceptions = {
    PrecomputeSetting: {
        "scenes": "the one that a piece is worked out in counts",
        "middle": "says which scene that is",
        "symmetry": "polishing comes later: whether postures are symmetric counts",
    },
    Piece: {"scene": "says which scene that is", "label": "is a word for messages"},
    Agent: {"label": "is a word for results"},
    Payload: {"label": "is a word for results"},
    IpoptOptions: {"compiled": "machine code gives the same bits"},
}

NO_PART_OF_A_PERSONS: Exceptions = {
    **NO_PART_OF_PIECES,
    PrecomputeSetting: {
        **NO_PART_OF_PIECES[PrecomputeSetting],
        "space": "a person stands behind the load, whatever the robot's hardware",
    },
    Scene: {"robot": "a person stands behind the load, whoever holds the other side"},
}

NO_PART_OF: Mapping[Subject, Exceptions] = {
    Subject.PERSON: NO_PART_OF_A_PERSONS,
    Subject.PERSON_REACH: NO_PART_OF_A_PERSONS,
    Subject.HIGHEST: NO_PART_OF_PIECES,
    Subject.LOWEST: NO_PART_OF_PIECES,
    Subject.POSTURE: NO_PART_OF_PIECES,
}
"""Fields on which a piece does not depend, by its subject, with the reason."""


def stages(
    setting: PrecomputeSetting, heights: Sequence[float], *, portfolios: bool, person_reaches: bool
) -> list[list[Piece]]:
    """The pieces of a problem, stage after stage; those of a stage need only what earlier ones gave.

    Args:
        setting: of the problem.
        heights: of the load's centre [m].
        portfolios: whether solves begin at portfolios of starts.
        person_reaches: whether the people's own reach is asked for.
    """
    people = [
        Piece(Subject.PERSON_REACH, scene=number, label=scene.label)
        for number, scene in enumerate(setting.scenes)
        if person_reaches
    ]
    people += [
        Piece(Subject.PERSON, height, number, scene.label)
        for number, scene in enumerate(setting.scenes)
        for height in heights
        if setting.symmetric and _push_alone(scene, setting.space)
    ]
    if not portfolios:
        return [people]
    middle = setting.middle
    return [
        [Piece(Subject.HIGHEST, scene=middle), Piece(Subject.LOWEST, scene=middle), *people],
        [Piece(Subject.POSTURE, height, middle) for height in heights],
    ]


def _push_alone(scene: Scene, space: DesignSpace) -> bool:
    """Whether the push is all that the load passes on, and no design weighs the person's effort anew."""
    shared = scene.robot_share is not None or space.allocation_names
    alone = scene.payload.grasp is Grasp.POINT and scene.stance.push > 0.0
    return alone and not shared and not scene.disturbances


def _scene_of(setting: PrecomputeSetting, piece: Piece) -> Scene:
    """The scene that a piece is worked out in.

    Where a robot reaches without disturbances its reach with them is found too, for three times less work.
    """
    scene = setting.scenes[piece.scene]
    if piece.subject in (Subject.HIGHEST, Subject.LOWEST):
        return replace(scene, disturbances=Disturbances())
    return scene


def key_of(setting: PrecomputeSetting, piece: Piece) -> str:
    """The digest under which a piece is kept: of all that it may follow from, and of the code."""
    data = (setting, setting.symmetric, _scene_of(setting, piece), piece)
    return digest((data, code_digest(__name__)), without=NO_PART_OF[piece.subject])


def compute_piece(setting: PrecomputeSetting, piece: Piece, known: Precomputed) -> bytes:
    """A piece, as it is kept.

    Args:
        setting: of the problem.
        piece: which one.
        known: what earlier stages gave.
    """
    if piece.subject is Subject.PERSON:
        return msgspec.json.encode(stored_value(_person(setting, piece)))
    if piece.subject is Subject.PERSON_REACH:
        scene = setting.scenes[piece.scene]
        found = person_reach(scene, setting.options, symmetric=setting.symmetric)
        return msgspec.json.encode(stored_person_reach(found))
    return msgspec.json.encode(stored_portfolio(_portfolio(setting, piece, known)))


def with_piece(known: Precomputed, piece: Piece, content: bytes) -> Precomputed | None:
    """What is known with one more piece; None when its content cannot be read."""
    try:
        if piece.subject is Subject.PERSON:
            value = human_value_of_stored(msgspec.json.decode(content, type=StoredValue))
            others = (*known.values, *([replace(value, scene=piece.scene)] if value else []))
            return replace(known, values=tuple(sorted(others, key=lambda value: (value.scene, value.height))))
        if piece.subject is Subject.PERSON_REACH:
            stretch = person_reach_of_stored(msgspec.json.decode(content, type=StoredPersonReach))
            several = (*known.person_reaches, *([replace(stretch, scene=piece.scene)] if stretch else []))
            return replace(known, person_reaches=tuple(sorted(several, key=lambda stretch: stretch.scene)))
        found = portfolio_of(msgspec.json.decode(content, type=StoredStartPortfolio))
    except msgspec.DecodeError:
        return None
    if piece.subject is Subject.HIGHEST:
        return replace(known, highest=found)
    if piece.subject is Subject.LOWEST:
        return replace(known, lowest=found)
    return replace(known, postures={**known.postures, piece.height: found})


def _person(setting: PrecomputeSetting, piece: Piece) -> HumanValue | None:
    scene = setting.scenes[piece.scene]
    form = symmetric_forms(scene)[1]
    return HumanProblem(form, scene, setting.weights.human, setting.options).value(piece.height)


def _portfolio(setting: PrecomputeSetting, piece: Piece, known: Precomputed) -> StartPortfolio:
    scene, space, known = _scene_of(setting, piece), setting.space, known.of_scene(piece.scene)
    options = replace(setting.options, iterations=min(ITERATIONS, setting.options.iterations))
    own = Setting(scene, space, setting.weights, options)
    reach = ReachProblem(own, symmetric=setting.symmetric, known=known)
    if piece.subject is not Subject.POSTURE:
        landscape = reach.landscape(HIGHEST if piece.subject is Subject.HIGHEST else LOWEST)
        return start_portfolio(
            landscape, _designs(space, REACH_TRAINING, lambda design: True), REACH_TRAINING
        )
    problem = PostureProblem(own, setting.symmetry, known)
    training = DISTURBED_TRAINING if scene.disturbances else HALF_TRAINING
    training = training if setting.symmetric else WHOLE_TRAINING
    designs = _designs(space, training, lambda design: reach.solve(design).distance(piece.height) == 0.0)
    return start_portfolio(problem.landscape(piece.height), designs, training)


def _designs(
    space: DesignSpace, training: Training, wanted: Callable[[tuple[float, ...]], bool]
) -> Iterator[tuple[float, ...]]:
    return spread_designs(len(space.parameters), space.values, wanted, LOOKED_AT * training.designs)
