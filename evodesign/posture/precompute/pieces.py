"""What is worked out once per problem, before any robot is evaluated: the pieces of a `Precomputed`.

A piece is a function of the problem alone and is kept, as JSON, under a digest of all of the setting, the
piece and the code but for named exceptions; so a score depends neither on a cache nor on who worked it out.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from itertools import islice

import msgspec
import numpy as np

from evodesign.collision.rules import BodyPair
from evodesign.design.space import DesignSpace
from evodesign.identity import Exceptions, code_digest, digest
from evodesign.mechanics.scene import HUMAN, ROBOT, Agent, Grasp, Payload, Scene, scene_of
from evodesign.nlp.solver import SolverOptions
from evodesign.nlp.start_portfolio import StartPortfolio, Training, spread_designs, start_portfolio, widened
from evodesign.posture.allocation import EffortWeights
from evodesign.posture.formulations.base import Setting
from evodesign.posture.formulations.human_value import HumanProblem, HumanValue
from evodesign.posture.formulations.reach import HIGHEST, LOWEST, ReachProblem, person_reach
from evodesign.posture.postures import PostureProblem, Symmetry
from evodesign.posture.precompute.meetings import REACH, found_meetings, with_meetings
from evodesign.posture.precompute.precomputed import NO_STARTS, PersonReach, Precomputed
from evodesign.posture.symmetry import symmetric_forms
from evodesign.records import Case, Hold, Task

__all__ = [
    "OF_STARTS",
    "PROGRAMS",
    "Piece",
    "PrecomputeSetting",
    "Subject",
    "compute_piece",
    "key_of",
    "stages",
    "with_piece",
]

REACH_TRAINING = Training(designs=32, starts=16, crossed=12)
HALF_TRAINING = Training(designs=48, starts=16, crossed=12)
WHOLE_TRAINING = Training(designs=32, starts=3, crossed=12, portfolio=12)
WHOLE_REACH_TRAINING = Training(designs=48, starts=12, crossed=12, portfolio=8, rounds=2)

PARTED_SHARE = 0.5
"""Of the usual designs so many are trained with where bodies are kept apart: solves take twice as long."""

PARTED_STARTS = 1
"""Starts of the lowest load where bodies are kept apart, whose program is twice as large."""

STRICTER = 0.4
"""Share of the usual distance from the best optimum that whole starts are chosen with.

Whole postures have many optima that lie close to each other; from random starts the best one is rarely found,
but the optima of other designs lead there.
"""

WIDER_DESIGNS, MOST_WIDER = 48, 12
"""Designs for which starts of other heights are tried with everyone, and starts of a portfolio with them."""

ITERATIONS = 80
"""Limit of a training solve; those that succeed mostly take 15 to 40."""

LOOKED_AT = 12
"""Designs looked at for each one that training asks for, where only some hold the load at a height."""


class Subject(StrEnum):
    """What a piece is about; the value is how it is told."""

    MEETINGS = "bodies that come near each other"
    PERSON = "the person's part"
    PERSON_REACH = "the person's reach"
    HIGHEST = "starts of the highest load"
    LOWEST = "starts of the lowest load"
    REACH_PROGRAM = "the program of reach"
    UNDISTURBED_PROGRAM = "the program of undisturbed postures"
    PROGRAM = "the program of postures"
    POSTURE = "starts of postures"
    WIDER = "starts of other heights"


OF_PEOPLE = (Subject.PERSON, Subject.PERSON_REACH, Subject.UNDISTURBED_PROGRAM, Subject.PROGRAM)
"""Of one person with one load; other pieces serve everyone."""

PROGRAMS = (Subject.REACH_PROGRAM, Subject.UNDISTURBED_PROGRAM, Subject.PROGRAM)
"""Machine code, which is found again in the cache of functions."""

OF_STARTS = (Subject.HIGHEST, Subject.LOWEST, Subject.POSTURE, Subject.WIDER)
"""Portfolios of starts."""

UNDISTURBED = (*OF_STARTS, Subject.REACH_PROGRAM, Subject.UNDISTURBED_PROGRAM)
"""Follow from what is held undisturbed."""


@dataclass(frozen=True, slots=True)
class Piece:
    """A part of a preparation.

    Args:
        subject: what it is about.
        pair: names of the person and the load that it is of, or is worked out with.
        task: None if it belongs to none.
        beside: other tasks that it follows from.
    """

    subject: Subject
    pair: tuple[str, str]
    task: Task | None = None
    beside: tuple[Task, ...] = ()

    def __str__(self) -> str:
        name = str(self.subject) if self.task is None else f"{self.subject} at {self.task}"
        who = self.pair if self.subject in OF_PEOPLE else ()
        return ", ".join(part for part in (name, *who) if part)


@dataclass(frozen=True, slots=True)
class PrecomputeSetting:
    """What the pieces of a problem follow from; as for `PostureProblem`.

    Args:
        scenes: every person with every load.
        middle: the scene that portfolios are made in.
    """

    scenes: tuple[Scene, ...]
    middle: Scene
    space: DesignSpace
    weights: EffortWeights
    options: SolverOptions
    symmetry: Symmetry
    tasks: tuple[Hold, ...]

    @property
    def symmetric(self) -> bool:
        """Whether symmetric postures are looked for, at least at first."""
        return self.symmetry is not Symmetry.OFF


NO_PART_OF_PIECES: Exceptions = {
    PrecomputeSetting: {
        "scenes": "the one that a piece is worked out in counts",
        "middle": "says which scene that is",
        "symmetry": "polishing comes later: whether postures are symmetric counts",
        "tasks": "a piece is about one of them, or none",
    },
    Piece: {"pair": "says which scene that is"},
    Agent: {"label": "is a word for results"},
    Payload: {"label": "is a word for results"},
    SolverOptions: {
        "compiled": "IPOPT gives the same bits with machine code, and the native method has no other"
    },
}

NO_PART_OF_A_PERSONS: Exceptions = {
    **NO_PART_OF_PIECES,
    PrecomputeSetting: {
        **NO_PART_OF_PIECES[PrecomputeSetting],
        "space": "a person stands behind the load, whatever the robot's hardware",
    },
    Scene: {"robot": "a person stands behind the load, whoever holds the other side"},
}

NO_PART_OF_WIDER: Exceptions = {
    **NO_PART_OF_PIECES,
    PrecomputeSetting: {
        name: why for name, why in NO_PART_OF_PIECES[PrecomputeSetting].items() if name != "scenes"
    },
}

NO_PART_OF_MEETINGS: Exceptions = {
    **NO_PART_OF_PIECES,
    PrecomputeSetting: {
        name: why
        for name, why in NO_PART_OF_PIECES[PrecomputeSetting].items()
        if name not in ("tasks", "scenes")
    },
}

NO_PART_OF_PARTED: Exceptions = {
    **NO_PART_OF_PIECES,
    PrecomputeSetting: {
        name: why
        for name, why in NO_PART_OF_PIECES[PrecomputeSetting].items()
        if name in ("middle", "symmetry")
    },
}
"""Where bodies are kept apart every piece follows from the meetings of all scenes at all tasks."""

NO_PART_OF: Mapping[Subject, Exceptions] = {
    Subject.MEETINGS: NO_PART_OF_MEETINGS,
    Subject.PERSON: NO_PART_OF_A_PERSONS,
    Subject.PERSON_REACH: NO_PART_OF_A_PERSONS,
    Subject.HIGHEST: NO_PART_OF_PIECES,
    Subject.LOWEST: NO_PART_OF_PIECES,
    **dict.fromkeys(PROGRAMS, NO_PART_OF_PIECES),
    Subject.POSTURE: NO_PART_OF_PIECES,
    Subject.WIDER: NO_PART_OF_WIDER,
}
"""Fields on which a piece does not depend, by its subject, with the reason."""


def stages(
    setting: PrecomputeSetting, tasks: Sequence[Hold], *, portfolios: bool, person_reaches: bool
) -> list[list[Piece]]:
    """The pieces of a problem, stage after stage; those of a stage need only what earlier ones gave.

    Args:
        setting: of the problem.
        tasks: of the problem.
        portfolios: whether solves begin at portfolios of starts.
        person_reaches: whether the people's own reach is asked for.
    """
    parting = [scene for scene in setting.scenes if scene.robot.collisions is not None]
    meetings = [Piece(Subject.MEETINGS, scene.pair) for scene in parting]
    people = [Piece(Subject.PERSON_REACH, scene.pair) for scene in setting.scenes if person_reaches]
    people += [
        Piece(Subject.PERSON, scene.pair, task)
        for scene in setting.scenes
        for task in tasks
        if setting.symmetric and _push_alone(scene, setting.space) and isinstance(task, Hold)
    ]
    if not portfolios:
        return [meetings, people]
    middle = setting.middle.pair
    around = (min(task.height_m for task in tasks) + max(task.height_m for task in tasks)) / 2.0
    longest = sorted(tasks, key=lambda task: -abs(task.height_m - around))  # extreme heights take longest
    starts = [Piece(Subject.POSTURE, middle, task) for task in longest]
    extremes = [Piece(Subject.LOWEST, middle), Piece(Subject.HIGHEST, middle)]
    found = [meetings, [*_programs(setting), *extremes, *starts, *people]]
    if setting.symmetric and setting.middle.disturbances:
        found.append([_wider(middle, task, tasks) for task in longest])
    return found


def _programs(setting: PrecomputeSetting) -> list[Piece]:
    """What is compiled beforehand, side by side, or one worker would wait for another; longest work last."""
    joint = [each for each in setting.scenes if not (setting.symmetric and _push_alone(each, setting.space))]
    disturbed = [scene for scene in joint if scene.disturbances]
    return [
        *([Piece(Subject.REACH_PROGRAM, setting.middle.pair)] if joint else []),
        *(Piece(Subject.UNDISTURBED_PROGRAM, scene.pair) for scene in disturbed),
        *(Piece(Subject.PROGRAM, scene.pair) for scene in joint),
    ]


def _wider(pair: tuple[str, str], task: Task, tasks: Sequence[Hold]) -> Piece:
    return Piece(Subject.WIDER, pair, task, tuple(other for other in tasks if other != task))


def _push_alone(scene: Scene, space: DesignSpace) -> bool:
    """Whether the push is all that the load passes on, and no design weighs the person's effort anew."""
    shared = scene.robot_share is not None or space.allocation_names
    alone = scene.payload.grasp is Grasp.POINT and scene.stance.push > 0.0
    return alone and not shared and not scene.disturbances


def _all_undisturbed(setting: PrecomputeSetting) -> PrecomputeSetting:
    """Without disturbances: portfolios are made so, as postures are solved so first."""
    scenes = tuple(scene.undisturbed for scene in setting.scenes)
    return replace(setting, scenes=scenes, middle=setting.middle.undisturbed)


def key_of(setting: PrecomputeSetting, piece: Piece) -> str:
    """The digest under which a piece is kept: of all that it may follow from, and of the code."""
    apart = scene_of(setting.scenes, piece.pair).human.collisions is not None
    parted = apart and piece.subject is not Subject.MEETINGS
    without = NO_PART_OF_PARTED if parted else NO_PART_OF[piece.subject]
    if piece.subject in UNDISTURBED and not parted:
        setting = _all_undisturbed(setting)
    data = (setting, setting.symmetric, scene_of(setting.scenes, piece.pair), piece)
    return digest((data, code_digest(__name__)), without=without)


def compute_piece(setting: PrecomputeSetting, piece: Piece, known: Precomputed) -> bytes:
    """A piece, as it is kept.

    Args:
        setting: of the problem.
        piece: which one.
        known: what earlier stages gave.
    """
    found: HumanValue | PersonReach | StartPortfolio | dict[str, list[BodyPair]] | None
    scene = scene_of(setting.scenes, piece.pair)
    if piece.subject is Subject.MEETINGS:
        own = Setting(scene, setting.space, setting.weights, setting.options)
        pairs = [each.pair for each in setting.scenes]
        part, parts, symmetric = pairs.index(piece.pair), len(pairs), setting.symmetric
        found_pairs = found_meetings(own, setting.tasks, symmetric=symmetric, part=part, parts=parts)
        return msgspec.json.encode(found_pairs)
    scenes = tuple(with_meetings(scene, known.meetings) for scene in setting.scenes)
    setting = replace(setting, scenes=scenes, middle=with_meetings(setting.middle, known.meetings))
    if piece.subject in OF_STARTS:
        setting = _all_undisturbed(setting)
    scene = scene_of(setting.scenes, piece.pair)
    if piece.subject is Subject.PERSON and piece.task is not None:
        found = _person(setting, scene, piece.task)
    elif piece.subject is Subject.PERSON_REACH:
        found = person_reach(scene, setting.options, symmetric=setting.symmetric)
    elif piece.subject in PROGRAMS:
        _compile(setting, piece.subject, scene)
        found = None
    else:
        found = _portfolio(setting, piece, known)
    return msgspec.json.encode(found, enc_hook=np.ndarray.tolist)


def with_piece(known: Precomputed, piece: Piece, content: bytes) -> Precomputed | None:
    """What is known with one more piece; None when its content cannot be read."""
    try:
        if piece.subject is Subject.PERSON and piece.task is not None:
            value = msgspec.json.decode(content, type=HumanValue | None)
            person, payload = piece.pair
            case = Case(person=person, payload=payload, task=piece.task)
            return replace(known, values={**known.values, case: value}) if value else known
        if piece.subject is Subject.MEETINGS:
            return _with_found(known, piece, msgspec.json.decode(content, type=dict[str, list[BodyPair]]))
        if piece.subject is Subject.PERSON_REACH:
            reach = msgspec.json.decode(content, type=PersonReach | None)
            reaches = {**known.person_reaches, **({piece.pair: reach} if reach else {})}
            return replace(known, person_reaches=reaches)
        if piece.subject in PROGRAMS:
            msgspec.json.decode(content, type=None)
            return known
        found = msgspec.json.decode(content, type=StartPortfolio)
    except msgspec.DecodeError:
        return None
    if piece.task is not None:
        return replace(known, postures={**known.postures, piece.task: found})
    highest = piece.subject is Subject.HIGHEST
    return replace(known, highest=found) if highest else replace(known, lowest=found)


def _with_found(known: Precomputed, piece: Piece, found: Mapping[str, Sequence[BodyPair]]) -> Precomputed:
    """Those of a scene beside those of others: of the robot there are several."""
    meetings = dict(known.meetings)
    own = {(ROBOT, ""): found[ROBOT], (REACH, ""): found[REACH], (HUMAN, piece.pair[0]): found[HUMAN]}
    for key, pairs in own.items():
        meetings[key] = tuple(dict.fromkeys([*meetings.get(key, ()), *pairs]))
    return replace(known, meetings=meetings)


def _person(setting: PrecomputeSetting, scene: Scene, task: Task) -> HumanValue | None:
    form = symmetric_forms(scene)[1]
    return HumanProblem(form, scene, setting.weights.human, setting.options).value(task.heights[0])


def _compile(setting: PrecomputeSetting, subject: Subject, scene: Scene) -> None:
    """Compile a scene's program, with all rows and without those that are switched on when needed."""
    own = Setting(scene, setting.space, setting.weights, setting.options)
    if subject is Subject.REACH_PROGRAM:
        reach = ReachProblem(own, symmetric=setting.symmetric)
        _ = reach.landscape(HIGHEST).solver.parted
        return
    if subject is Subject.UNDISTURBED_PROGRAM:
        own = replace(own, scene=scene.undisturbed)
    problem = PostureProblem(own, setting.symmetry)
    for task in {type(task): task for task in setting.tasks}.values():
        _ = problem.landscape(task).solver.parted


def _portfolio(setting: PrecomputeSetting, piece: Piece, known: Precomputed) -> StartPortfolio:
    scene, space, task = scene_of(setting.scenes, piece.pair), setting.space, piece.task
    options = replace(setting.options, iterations=min(ITERATIONS, setting.options.iterations))
    own = Setting(scene, space, setting.weights, options)
    beside = replace(known, highest=NO_STARTS, lowest=NO_STARTS)
    reach = ReachProblem(own, symmetric=setting.symmetric, known=beside)
    if task is None:
        landscape = reach.landscape(HIGHEST if piece.subject is Subject.HIGHEST else LOWEST)
        training = REACH_TRAINING if setting.symmetric else WHOLE_REACH_TRAINING
        if landscape.parted and scene.robot.collisions is not None:
            training = replace(training, portfolio=PARTED_STARTS)
    else:
        landscape = PostureProblem(own, setting.symmetry, known).landscape(task)
        training = HALF_TRAINING if setting.symmetric else WHOLE_TRAINING
    if not setting.symmetric:
        near = STRICTER * landscape.relative, STRICTER * landscape.absolute
        landscape = replace(landscape, relative=near[0], absolute=near[1])

    def wanted(design: tuple[float, ...]) -> bool:
        return task is None or reach.solve(design).beyond(task.heights) == 0.0

    def given(genome: tuple[float, ...]) -> tuple[float, ...]:
        return space.given(space.values(genome), {})

    parted = scene.robot.collisions is not None
    if parted:
        training = replace(training, designs=int(PARTED_SHARE * training.designs))
    looked_at = LOOKED_AT * training.designs
    designs = spread_designs(len(space.parameters), given, wanted, looked_at)
    if task is None or piece.subject is not Subject.WIDER:
        return start_portfolio(landscape, designs, training)
    offers = [start for other in piece.beside for start in known.postures[other].starts]
    settings = [replace(own, scene=each) for each in setting.scenes]
    landscapes = [PostureProblem(each, setting.symmetry, known).landscape(task) for each in settings]
    few = list(islice(designs, int(WIDER_DESIGNS * (PARTED_SHARE if parted else 1.0))))
    cases = ((each, design) for design in few for each in landscapes)
    return widened(known.postures[task], offers, cases, MOST_WIDER)
