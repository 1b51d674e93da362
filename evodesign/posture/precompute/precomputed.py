"""What is known of a problem before any robot is evaluated: the people's reach, bodies that meet, and starts.

It follows from the problem alone and consists of plain numbers: so it travels to workers, and its parts are
kept as JSON, as they are.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import msgspec

from evodesign.collision.rules import BodyPair
from evodesign.nlp.program import Start
from evodesign.posture.seeking.landscape import Design
from evodesign.posture.seeking.start_portfolio import Coverage, StartPortfolio
from evodesign.records import Case, Lift, Task

NO_STARTS = StartPortfolio((), Coverage(0, 0, 0.0))
"""A portfolio of none: solves begin at the fixed starts."""


HeldLoads = tuple[Design, float, float]
"""What programs are given of a design, and the lowest and the highest load that it holds [m]."""

IN_FILES = {"lowest": "lowest_m", "highest": "highest_m"}
"""Names of fields with their units, as a person's reach is kept."""


class PersonReach(msgspec.Struct, frozen=True, forbid_unknown_fields=True, rename=IN_FILES):
    """The interval of heights at which a person can hold a load.

    Args:
        lowest, highest: of the load's centre [m].
    """

    lowest: float
    highest: float


@dataclass(frozen=True, slots=True)
class Precomputed:
    """What is known; left out, everything is solved from fixed starts.

    A portfolio serves every scene: starting values hardly depend on who holds what. Where some do better in
    one scene than in another, they are chosen for each.

    Args:
        designs: from which starts are learned, with the lowest and highest load that each holds [m].
        highest, lowest: starts of the reach problem.
        postures: starts of the posture problem, by the case that they were found in.
        person_reaches: the people's own reach, by the names of person and load, where it was asked for.
        meetings: pairs of bodies that come near each other, by agent name and label.
        lifts: starts of lifts, by case.
    """

    designs: tuple[HeldLoads, ...] = ()
    highest: StartPortfolio = NO_STARTS
    lowest: StartPortfolio = NO_STARTS
    postures: Mapping[Case, StartPortfolio] = field(default_factory=dict)
    person_reaches: Mapping[tuple[str, str], PersonReach] = field(default_factory=dict)
    meetings: Mapping[tuple[str, str], tuple[BodyPair, ...]] = field(default_factory=dict)
    lifts: Mapping[Case, StartPortfolio] = field(default_factory=dict)

    def starts(self, pair: tuple[str, str], task: Task) -> tuple[Start, ...]:
        """The posture problem's starts for a person, a load and a task; none where none are known."""
        case = Case(person=pair[0], payload=pair[1], task=task)
        if case in self.postures:
            return self.postures[case].starts
        return tuple(
            start for other, found in self.postures.items() if other.task == task for start in found.starts
        )

    def other_starts(self, pair: tuple[str, str], task: Task) -> tuple[tuple[Start, ...], tuple[Start, ...]]:
        """The posture problem's starts of others in the same task, and those of other tasks."""
        beside: list[Start] = []
        rest: list[Start] = []
        for case, found in self.postures.items():
            if case.task != task:
                rest += found.starts
            elif (case.person, case.payload) != pair:
                beside += found.starts
        return tuple(beside), tuple(rest)

    def designs_for(self, task: Task | None) -> list[Design]:
        """The designs to learn from that hold a load at all heights of a task; all of them without one."""
        heights = task.heights if task else ()
        return [d for d, lowest, highest in self.designs if all(lowest <= h <= highest for h in heights)]

    def is_learned(self, pair: tuple[str, str], task: Task) -> bool:
        """Whether the posture problem's starts were learned with this very person, load and task."""
        return Case(person=pair[0], payload=pair[1], task=task) in self.postures

    def lift_starts(self, pair: tuple[str, str], lift: Lift) -> tuple[Start, ...]:
        """Where a lift of a person and a load begins; none where nothing is known."""
        person, payload = pair
        return self.lifts.get(Case(person=person, payload=payload, task=lift.coarse), NO_STARTS).starts


NOTHING_PRECOMPUTED = Precomputed()
