"""What has to be worked out of a problem before any robot is evaluated, and in which order."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

from evodesign.design.space import DesignSpace
from evodesign.human.measured_posture import MEAN_PERSON
from evodesign.mechanics.scene import Scene
from evodesign.nlp.method import SolverOptions
from evodesign.posture.allocation import EffortWeights
from evodesign.posture.formulations.base import Setting
from evodesign.posture.postures import Symmetry
from evodesign.records import Hold, Lift, Task


class Subject(StrEnum):
    """What a piece is about; the value is how it is told."""

    MEETINGS = "bodies that come near each other"
    PERSON_REACH = "the person's reach"
    DESIGNS = "designs to learn from"
    HIGHEST = "starts of the highest load"
    LOWEST = "starts of the lowest load"
    POSTURE = "starts of postures"
    LIFT = "starts of lifts"


OF_PEOPLE = (Subject.PERSON_REACH, Subject.POSTURE, Subject.LIFT)
"""Of one person with one load; other pieces serve everyone."""

OF_STARTS = (Subject.HIGHEST, Subject.LOWEST, Subject.POSTURE)
"""Portfolios of starts."""


@dataclass(frozen=True, slots=True)
class Piece:
    """A part of a preparation.

    Args:
        subject: what it is about.
        pair: names of the person and the load that it is of, or is worked out with.
        task: None if it belongs to none.
        after: the task whose starts its own are sought from; None if they are sought all over.
    """

    subject: Subject
    pair: tuple[str, str]
    task: Task | None = None
    after: Task | None = None

    def __str__(self) -> str:
        at = "from" if isinstance(self.task, Lift) else "at"
        name = str(self.subject) if self.task is None else f"{self.subject} {at} {self.task}"
        who = self.pair if self.subject in OF_PEOPLE else ()
        return ", ".join(part for part in (name, *who) if part)


@dataclass(frozen=True, slots=True)
class PrecomputeSetting:
    """What the pieces of a problem follow from; as for `PostureProblem`.

    Args:
        scenes: every person with every load.
        middle: the scene that portfolios are made in.
        lowest_asked: below which no robot's reach is asked for [m].
    """

    scenes: tuple[Scene, ...]
    middle: Scene
    space: DesignSpace
    weights: EffortWeights
    options: SolverOptions
    symmetry: Symmetry
    tasks: tuple[Hold, ...]
    lowest_asked: float

    def of(self, scene: Scene, options: SolverOptions | None = None) -> Setting:
        """What the programs of a scene follow from, with these or other options."""
        return Setting(scene, self.space, self.weights, options or self.options, self.lowest_asked)

    @property
    def symmetric(self) -> bool:
        """Whether symmetric postures are looked for, at least at first."""
        return self.symmetry is not Symmetry.OFF


def stages(
    setting: PrecomputeSetting,
    tasks: Sequence[Hold],
    *,
    portfolios: bool,
    person_reaches: bool,
    lifts: Sequence[Lift] = (),
) -> list[list[Piece]]:
    """The pieces of a problem, stage after stage; those of a stage need only what earlier ones gave.

    Args:
        setting: of the problem.
        tasks: of the problem.
        portfolios: whether solves begin at portfolios of starts.
        person_reaches: whether the people's own reach is asked for.
        lifts: of the problem.
    """
    parting = [scene for scene in setting.scenes if scene.agents[0].collisions is not None]
    meetings = [Piece(Subject.MEETINGS, scene.pair) for scene in parting]
    people = [Piece(Subject.PERSON_REACH, scene.pair) for scene in setting.scenes if person_reaches]
    if not portfolios:
        return [meetings, people]
    middle = setting.middle.pair
    own = [scene.pair for scene in setting.scenes] if setting.symmetric else [middle]
    first = sorted(tasks, key=lambda task: task.height_m)[(len(tasks) - 1) // 2]
    longest = sorted(tasks, key=lambda task: -abs(task.height_m - first.height_m))
    starts = [Piece(Subject.POSTURE, pair, first) for pair in own]
    others = [Piece(Subject.POSTURE, pair, task, first) for task in longest if task != first for pair in own]
    extremes = [Piece(Subject.LOWEST, middle), Piece(Subject.HIGHEST, middle)]
    designs = Piece(Subject.DESIGNS, middle)
    found = [meetings, [designs, *people], [*starts, *extremes], others]
    return [*found, lift_pieces(setting, lifts)] if lifts else found


def lift_pieces(setting: PrecomputeSetting, lifts: Sequence[Lift]) -> list[Piece]:
    """Starts of lifts, of every person with every load; they serve any number of knots."""
    coarse = dict.fromkeys(lift.coarse for lift in lifts)
    return [Piece(Subject.LIFT, scene.pair, lift) for scene in setting.scenes for lift in coarse]


def all_mean_people(setting: PrecomputeSetting) -> PrecomputeSetting:
    """With the mean person in the place of each drawn one: their starts and colliding pairs serve all."""
    scenes = tuple(map(_with_mean_person, setting.scenes))
    return replace(setting, scenes=scenes, middle=_with_mean_person(setting.middle))


def _with_mean_person(scene: Scene) -> Scene:
    return scene.with_agents(
        *(
            replace(person, measured=replace(person.measured, drawn=MEAN_PERSON))
            for person in scene.people
            if person.measured is not None and person.measured.drawn != MEAN_PERSON
        )
    )
