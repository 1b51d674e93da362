"""What is known of a problem before any robot is evaluated: the person's part, and starts.

It follows from the problem alone and consists of plain numbers, so it travels to workers as it is.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from evodesign.nlp.program import Start
from evodesign.nlp.start_portfolio import Coverage, StartPortfolio
from evodesign.posture.formulations.human_value import HumanValue

__all__ = ["NOTHING_PRECOMPUTED", "NO_STARTS", "PersonReach", "Precomputed"]

NO_STARTS = StartPortfolio((), Coverage(0, 0, 0.0))
"""A portfolio of none: solves begin at the fixed starts."""


@dataclass(frozen=True, slots=True)
class PersonReach:
    """The interval of heights at which a person can hold a load.

    Args:
        lowest, highest: of the load's centre [m].
        scene: which of the problem's scenes it is of, from zero.
    """

    lowest: float
    highest: float
    scene: int = 0


@dataclass(frozen=True, slots=True)
class Precomputed:
    """What is known; left out, everything is solved jointly and from fixed starts.

    Portfolios serve every scene: they are starting values, and hardly depend on who holds what.

    Args:
        values: the people's value functions, for the scenes and heights that have one.
        highest, lowest: starts of the reach problem.
        postures: starts of the posture problem, by height [m].
        stretches: the people's own reach, for the scenes in which it was asked for.
    """

    values: tuple[HumanValue, ...] = ()
    highest: StartPortfolio = NO_STARTS
    lowest: StartPortfolio = NO_STARTS
    postures: Mapping[float, StartPortfolio] = field(default_factory=dict)
    person_reaches: tuple[PersonReach, ...] = ()

    def of_scene(self, scene: int) -> Precomputed:
        """What is known of one of the problem's scenes."""
        return replace(self, values=tuple(value for value in self.values if value.scene == scene))

    def starts(self, height: float) -> tuple[Start, ...]:
        """The posture problem's starts at a height [m]; none where none are known."""
        return self.postures.get(height, NO_STARTS).starts


NOTHING_PRECOMPUTED = Precomputed()
