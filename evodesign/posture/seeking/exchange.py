"""The robot of one posture beside the person of another.

Robot and person have several ways to stand each, and hardly more than the load couples them: the best pair of
ways may be none that a start led to. What a pair asks at least is known before it is solved: the efforts of
both, each in its own posture.

The same holds between cases: the robot of a design has the same ways to stand whoever holds the load with it,
and the starts of one case lead to the best of them where those of another do not.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

import numpy as np

from evodesign.mechanics.agent import Role
from evodesign.nlp.program import Program
from evodesign.posture.allocation import EffortWeights
from evodesign.posture.assemble import Slot
from evodesign.posture.results import Array, CaseSolution
from evodesign.posture.seeking.budget import BUDGET
from evodesign.posture.symmetry import Form


class Exchange:
    """Which robot to put beside which person.

    Args:
        program: of both agents.
        forms: of both.
    """

    def __init__(self, program: Program, forms: Sequence[Form]) -> None:
        counts = {form.agent.name: np.array(form.counts) for form in forms}
        self._agents = [form.agent for form in forms]
        torques = [(v.key, v.name) for v in program.variables if isinstance(v.key, Slot)]
        self._torques = [
            (slot.party, slot.load_case, name, counts[slot.party])
            for slot, name in torques
            if slot.part == "torques"
        ]
        self._load_cases = 1 + max((case for _, case, _, _ in self._torques), default=0)

    def best(self, postures: Sequence[Mapping[str, Array]], weights: EffortWeights) -> tuple[int, int] | None:
        """Whose robots and whose people promise most together; None where no pair promises enough.

        Args:
            postures: values of solutions by variable name, SI units.
            weights: of the efforts.
        """
        if len(postures) < 2:
            return None
        by_agent, roles = weights.by_agent(self._agents), {each.name: each.role for each in self._agents}
        efforts = {role: np.zeros((len(postures), self._load_cases)) for role in Role}
        for party, load_case, name, counts in self._torques:
            squares = np.array([values[name] for values in postures]) ** 2
            efforts[roles[party]][:, load_case] += by_agent[party] * (squares @ counts)
        pairs = (efforts[Role.ROBOT][:, None] + efforts[Role.PERSON][None, :]).max(axis=2)
        robot, person = np.unravel_index(int(np.argmin(pairs)), pairs.shape)
        enough = pairs[robot, person] < BUDGET.exchange * np.diag(pairs).min()
        return (int(robot), int(person)) if enough else None


def other_ways(
    own: CaseSolution, others: Sequence[CaseSolution], robots: Collection[str]
) -> list[CaseSolution]:
    """The solutions of other cases in which robots stand differently, each way once.

    Args:
        own: solved; likewise all others.
        others: of the same design and task.
        robots: names of the agents that are robots.
    """
    ways, found = [_angles(own, robots)], list[CaseSolution]()
    for other in others:
        angles = _angles(other, robots)
        if all(np.abs(angles - way).max(initial=0.0) > BUDGET.other_way for way in ways):
            ways.append(angles)
            found.append(other)
    return found


def _angles(solution: CaseSolution, robots: Collection[str]) -> Array:
    postures = [instant.postures[robot] for instant in solution.instants for robot in robots]
    return np.array([angle for posture in postures for angle in posture.joints.values()])
