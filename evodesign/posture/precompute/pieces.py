"""What is worked out once per problem, before any robot is evaluated: the pieces of a `Precomputed`.

A piece is a function of the problem alone and is kept, as JSON, under a digest of everything that it depends
on; so a score depends neither on a cache nor on who worked the piece out.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

import casadi as ca
import msgspec

from evodesign.design.space import DesignSpace
from evodesign.mechanics.disturbance import Disturbances
from evodesign.mechanics.scene import Agent, Grasp, Scene, scene_of
from evodesign.nlp.disk_cache import digest_of
from evodesign.nlp.program import IpoptOptions
from evodesign.nlp.start_portfolio import StartPortfolio, Training, spread_designs, start_portfolio
from evodesign.posture.allocation import EffortWeights
from evodesign.posture.formulations.human_value import HumanProblem, HumanValue
from evodesign.posture.formulations.joint import PostureProblem, Symmetry
from evodesign.posture.formulations.reach import HIGHEST, LOWEST, ReachProblem
from evodesign.posture.person_reach import person_reach
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
from evodesign.records import Case, Task
from evodesign.tree.urdf_write import urdf_text

__all__ = ["Piece", "PrecomputeSetting", "Subject", "compute_piece", "key_of", "stages", "with_piece"]

RECIPE = b"4"
"""Changes whenever the same problem would get other pieces."""

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
    HIGHEST = "seeds of the highest load"
    LOWEST = "seeds of the lowest load"
    POSTURE = "seeds of postures"


OF_PEOPLE = (Subject.PERSON, Subject.PERSON_REACH)
"""Of one person with one load; other pieces serve everyone."""


@dataclass(frozen=True, slots=True)
class Piece:
    """A part of a preparation.

    Args:
        subject: what it is about.
        pair: names of the person and the load that it is of, or is worked out with.
        task: None if it belongs to none.
    """

    subject: Subject
    pair: tuple[str, str]
    task: Task | None = None

    def __str__(self) -> str:
        name = str(self.subject) if self.task is None else f"{self.subject} at {self.task}"
        who = self.pair if self.subject in OF_PEOPLE else ()
        return ", ".join(part for part in (name, *who) if part)


@dataclass(frozen=True, slots=True)
class PrecomputeSetting:
    """What the pieces of a problem follow from; as for `PostureProblem`.

    Args:
        scenes: every person with every load.
        middle: the scene that seeds are made in.
    """

    scenes: tuple[Scene, ...]
    middle: Scene
    space: DesignSpace
    weights: EffortWeights
    options: IpoptOptions
    symmetry: Symmetry

    @property
    def symmetric(self) -> bool:
        """Whether symmetric postures are looked for, at least at first."""
        return self.symmetry is not Symmetry.OFF


def stages(
    setting: PrecomputeSetting, tasks: Sequence[Task], *, seeds: bool, person_reaches: bool
) -> list[list[Piece]]:
    """The pieces of a problem, stage after stage; those of a stage need only what earlier ones gave.

    Args:
        setting: of the problem.
        tasks: of the problem.
        seeds: whether solves begin at seeds.
        person_reaches: whether the people's own reach is asked for.
    """
    people = [Piece(Subject.PERSON_REACH, scene.pair) for scene in setting.scenes if person_reaches]
    people += [
        Piece(Subject.PERSON, scene.pair, task)
        for scene in setting.scenes
        for task in tasks
        if setting.symmetric and _push_alone(scene, setting.space)
    ]
    if not seeds:
        return [people]
    middle = setting.middle.pair
    return [
        [Piece(Subject.HIGHEST, middle), Piece(Subject.LOWEST, middle), *people],
        [Piece(Subject.POSTURE, middle, task) for task in tasks],
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
    scene = scene_of(setting.scenes, piece.pair)
    if piece.subject in (Subject.HIGHEST, Subject.LOWEST):
        return replace(scene, disturbances=Disturbances())
    return scene


def key_of(setting: PrecomputeSetting, piece: Piece) -> str:
    """The digest under which a piece is kept."""
    scene, options = _scene_of(setting, piece), replace(setting.options, compiled=False)
    load = replace(scene.payload, label="")
    limits = (scene.ground, scene.stance, scene.robot_share)
    numbers = (piece.subject, piece.task, load, *limits, setting.weights, options)
    ingredients = [RECIPE, ca.__version__.encode(), repr(numbers).encode(), *_named(scene.human)]
    if scene.disturbances:
        ingredients.append(repr(scene.disturbances).encode())
    if piece.subject is Subject.PERSON_REACH:
        ingredients.append(repr(setting.symmetric).encode())
    elif piece.subject is not Subject.PERSON:
        ingredients += [repr((setting.space, setting.symmetric)).encode(), *_named(scene.robot)]
    return digest_of(*ingredients)


def compute_piece(setting: PrecomputeSetting, piece: Piece, known: Precomputed) -> bytes:
    """A piece, as it is kept.

    Args:
        setting: of the problem.
        piece: which one.
        known: what earlier stages gave.
    """
    if piece.subject is Subject.PERSON and piece.task is not None:
        return msgspec.json.encode(stored_value(_person(setting, _scene_of(setting, piece), piece.task)))
    if piece.subject is Subject.PERSON_REACH:
        found = person_reach(_scene_of(setting, piece), setting.options, symmetric=setting.symmetric)
        return msgspec.json.encode(stored_person_reach(found))
    return msgspec.json.encode(stored_portfolio(_seeds(setting, piece, known)))


def with_piece(known: Precomputed, piece: Piece, content: bytes) -> Precomputed | None:
    """What is known with one more piece; None when its content cannot be read."""
    try:
        if piece.subject is Subject.PERSON and piece.task is not None:
            value = human_value_of_stored(msgspec.json.decode(content, type=StoredValue))
            person, payload = piece.pair
            case = Case(person=person, payload=payload, task=piece.task)
            return replace(known, values={**known.values, case: value}) if value else known
        if piece.subject is Subject.PERSON_REACH:
            reach = person_reach_of_stored(msgspec.json.decode(content, type=StoredPersonReach))
            return (
                replace(known, person_reaches={**known.person_reaches, piece.pair: reach}) if reach else known
            )
        found = portfolio_of(msgspec.json.decode(content, type=StoredStartPortfolio))
    except msgspec.DecodeError:
        return None
    if piece.task is not None:
        return replace(known, postures={**known.postures, piece.task: found})
    highest = piece.subject is Subject.HIGHEST
    return replace(known, highest=found) if highest else replace(known, lowest=found)


def _person(setting: PrecomputeSetting, scene: Scene, task: Task) -> HumanValue | None:
    form = symmetric_forms(scene)[1]
    return HumanProblem(form, scene, setting.weights.human, setting.options).value(task.height_m)


def _seeds(setting: PrecomputeSetting, piece: Piece, known: Precomputed) -> StartPortfolio:
    scene, space, task = _scene_of(setting, piece), setting.space, piece.task
    options = replace(setting.options, iterations=min(ITERATIONS, setting.options.iterations))
    reach = ReachProblem(scene, space, options, symmetric=setting.symmetric, known=known)
    if task is None:
        landscape = reach.landscape(HIGHEST if piece.subject is Subject.HIGHEST else LOWEST)
        return start_portfolio(
            landscape, _designs(space, REACH_TRAINING, lambda design: True), REACH_TRAINING
        )
    problem = PostureProblem(scene, space, setting.weights, options, setting.symmetry, known)
    training = DISTURBED_TRAINING if scene.disturbances else HALF_TRAINING
    training = training if setting.symmetric else WHOLE_TRAINING
    designs = _designs(space, training, lambda design: reach.solve(design).distance(task.height_m) == 0.0)
    return start_portfolio(problem.landscape(task), designs, training)


def _designs(
    space: DesignSpace, training: Training, wanted: Callable[[tuple[float, ...]], bool]
) -> Iterator[tuple[float, ...]]:
    return spread_designs(len(space.parameters), space.values, wanted, LOOKED_AT * training.designs)


def _named(agent: Agent) -> list[bytes]:
    named = (agent.joints, agent.hands, agent.soles, agent.sole_size, agent.trunk)
    limits = [repr(sorted(agent.torque_limits.items())).encode()] if agent.limits_torques else []
    return [urdf_text(agent.tree).encode(), repr(named).encode(), *limits]
