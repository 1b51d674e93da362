"""What a search gained beside its first start design, usually the robot as it is, at no loss."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from evodesign.analysis.front import comparable, front, to_minimise
from evodesign.records import Objective
from evodesign.runlog.run import RunLog


@dataclass(frozen=True, slots=True)
class Gain:
    """The best value of an objective among the designs that are no worse in the others.

    Args:
        objective: which.
        before: its value of the start design.
        after: the best one.
        number: of the design that has it.
    """

    objective: Objective
    before: float
    after: float
    number: int

    @property
    def sentence(self) -> str:
        """It in words."""
        unit = "" if self.objective.unit == "1" else f" {self.objective.unit}"
        return (
            f"{self.objective.name} from {self.before:.4g} to {self.after:.4g}{unit} (design {self.number})"
        )


@dataclass(frozen=True, slots=True)
class Gains:
    """The designs of a front that are better than the start design in some objective and worse in none.

    Args:
        start: number of the start design.
        better: how many there are.
        on_front: of so many.
        best: of each objective in which one is better.
    """

    start: int
    better: int
    on_front: int
    best: tuple[Gain, ...]

    @property
    def sentence(self) -> str:
        """It in words."""
        if not self.best:
            return f"no design is better than design {self.start}, where the search began, and nowhere worse"
        return (
            f"{self.better} of {self.on_front} designs of the front are better than design {self.start}, "
            f"where the search began, and nowhere worse: {', '.join(gain.sentence for gain in self.best)}"
        )


def gains(run: RunLog) -> Gains | None:
    """What a run gained; None where its first start design is not feasible, or it has none."""
    objectives, first = run.header.objectives, run.header.search.start[:1]
    known = comparable(objectives, run.evaluations)
    start = next(((each.number, values) for each, values in known if each.genome in first), None)
    if start is None:
        return None
    number, before = start
    on_front = comparable(objectives, front(objectives, run.evaluations))
    better = [each for each in on_front if np.less_equal(each[1], before).all() and each[1] != before]
    best = []
    for place, objective in enumerate(objectives):
        least = min(better, key=lambda each: each[1][place], default=None)
        if least is not None and least[1][place] < before[place]:
            old, new = (to_minimise(objective, values[place]) for values in (before, least[1]))
            best.append(Gain(objective, old, new, least[0].number))
    return Gains(number, len(better), len(on_front), tuple(best))


def gains_json(found: Gains | None) -> dict[str, Any] | None:
    """The same as a JSON object; its shape is a promise."""
    if found is None:
        return None
    best = {
        gain.objective.name: {"id": gain.number, "before": gain.before, "after": gain.after}
        for gain in found.best
    }
    return {"start": found.start, "better": found.better, "best": best}
