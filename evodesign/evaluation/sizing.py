"""Designs whose actuators are sized by what is asked of them.

    rated torque of a group = margin x demand on it

An actuator is part of what the others carry, so postures and sizes are found in rounds (`hardware.sizing`).
Which postures are best depends on the sizes, so one start of each case tells first about which ones will be
asked for. The first round begins there as any evaluation; each further one moves the robot's postures of the
last to sizes that would meet the demand if postures stayed: torques are about linear then in the masses of
actuators (`mechanics.added_mass`). What is checked, and solved to the end, are the postures of the last
sizes. If the check finds better ones, which ask for other actuators, the rounds begin again from those.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Protocol

from evodesign.design.space import TYPICAL, DesignSpace
from evodesign.hardware.sizing import TOLERANCE, Sizing, SizingRounds, sizes_met
from evodesign.posture.results import CaseSolution
from evodesign.quantities.demand import Demand, SizedRobot, demand_of
from evodesign.quantities.design_result import DesignResult
from evodesign.records import Status

BOUNDS = (2.5, 300.0)
"""Smallest and largest rated torque [N m] that an actuator is made for: the smallest row of the default law,
and about twice its largest, which designs of the default's front stay far below."""

BEGINNINGS = 3
"""How often the rounds begin."""

NOTHING_KNOWN: Mapping[str, float] = {}

Cases = tuple[CaseSolution, ...]


class PostureRounds(Protocol):
    """What is asked of a design's postures, round after round; values have rated torques for margins."""

    def sketched(self, values: Sequence[float]) -> Cases:
        """Postures of every case from one start each, not checked; none where they tell too little."""

    def cases(self, values: Sequence[float]) -> Cases:
        """Postures of every case, not checked."""

    def following(self, values: Sequence[float], before: Cases) -> Cases:
        """Those near the postures of another round, not checked."""

    def result(self, values: Sequence[float], before: Cases = ()) -> DesignResult:
        """The checked results near them; cases that have no posture there have none."""


def usual_values(
    space: DesignSpace, values: Sequence[float], usual: Mapping[str, float] = NOTHING_KNOWN
) -> list[float]:
    """The values of a design with rated torques [N m] for margins, as another design asks for them.

    Args:
        space: of the problem.
        values: of the design.
        usual: what the other design asks of each group [N m].
    """
    found = list(values)
    for place in space.margins:
        found[place] *= usual.get(space.parameters[place].name, TYPICAL)
    return found


def sized_result(
    space: DesignSpace,
    values: Sequence[float],
    robot: SizedRobot,
    rounds: PostureRounds,
    usual: Mapping[str, float] = NOTHING_KNOWN,
) -> DesignResult:
    """The results of a design with sized actuators.

    Args:
        space: of the problem.
        values: of the design.
        robot: of the design.
        rounds: its postures with any sizes.
        usual: what another design asks of each group [N m], for the first round.
    """
    groups = {space.parameters[place].name: place for place in space.margins}
    margins = {name: values[place] for name, place in groups.items()}
    bounds = dict.fromkeys(groups, BOUNDS)
    first = usual_values(space, values, usual)
    start: Mapping[str, float] = {name: first[place] for name, place in groups.items()}
    sketch = rounds.sketched(first)
    demand = demand_of(space, first, robot, sketch) if sketch else ""
    if isinstance(demand, Demand):
        start = sizes_met(demand.at, start, margins, bounds)
    cases: Cases = ()
    latest: Demand | None = None
    for _ in range(BEGINNINGS):
        sizes = SizingRounds(start, margins, bounds)
        while True:
            places = {place: sizes.sizes[name] for name, place in groups.items()}
            given = [places.get(place, value) for place, value in enumerate(values)]
            cases = rounds.following(given, cases) if cases else rounds.cases(given)
            demand = demand_of(space, given, robot, cases, latest)
            latest = demand if isinstance(demand, Demand) else None
            sizing = sizes.ended_by(latest.at(sizes.sizes), latest.at) if latest else sizes.ended_by(None)
            if sizing is not None:
                break
        if sizing.status is not Status.SOLVED and all(each.solved for each in cases):
            reason = demand if isinstance(demand, str) else sizing.reason
            return rounds.result(given, _failed(cases, sizing, reason))
        result = rounds.result(given, cases)
        if latest is None or not all(each.solved for each in result.cases):
            return result
        cases, latest = result.cases, latest.of_lift(result.cases)
        start = _wanted(latest, sizing, margins)
        last = replace(sizing, wanted=start)
        if last.change <= 2.0 * TOLERANCE:
            return replace(result, demand=latest)
    lost = replace(last, status=Status.ITERATION_LIMIT)
    return replace(result, cases=_failed(result.cases, lost, "checked postures ask for other actuators"))


def _wanted(demand: Demand, sizing: Sizing, margins: Mapping[str, float]) -> Mapping[str, float]:
    """The sizes that a demand around those of the last round asks for."""
    asked = demand.at(sizing.sizes)
    return {name: min(max(margin * asked[name], BOUNDS[0]), BOUNDS[1]) for name, margin in margins.items()}


def _failed(cases: Cases, sizing: Sizing, reason: str) -> Cases:
    return tuple(CaseSolution(each.case, sizing.status, reason) for each in cases)
