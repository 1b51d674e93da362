"""Whether a record can be what it says, by itself and beside its run's header.

A checksum says that a record was not changed by accident, not that evodesign wrote it. What is shown,
replayed or computed with relies on what is checked here: names, lengths and numbers that fit the header.
"""

from __future__ import annotations

from typing import Final

import msgspec

from evodesign.records import (
    AgentDetail,
    Detail,
    Evaluation,
    Front,
    Generation,
    InstantDetail,
    Lift,
    LoadCaseDetail,
    RunHeader,
)

AGENTS: Final = frozenset(
    f"{role}{number}" for role in ("robot", "human") for number in ("", "_2", "_3", "_4")
)
"""Who may hold a load: one at each of its four sides."""

HANDS: Final = frozenset(("left_hand", "right_hand"))
STANDING: Final = (frozenset(("left_foot", "right_foot")), frozenset(("base",)))
"""Contacts with the load, of which there is one at least, and with the ground."""

LARGEST_NUMBER: Final = 10**9
"""More evaluations than any run has: what is counted and listed stays bounded."""

LARGEST_POPULATION: Final = 10**5
"""More designs than any search asks for at once."""


def header_fault(header: RunHeader) -> str:
    """What is wrong with a header by itself; empty if nothing is."""
    parameters = [parameter.name for parameter in header.parameters]
    objectives = [objective.name for objective in header.objectives]
    search = header.search
    lengths = [len(genome) for genome in search.start]
    if len(set(parameters)) < len(parameters) or len(set(objectives)) < len(objectives):
        return "a parameter or objective stands twice"
    if not objectives or search.objectives != len(objectives):
        return f"its search is of {search.objectives} objectives, and it has {len(objectives)}"
    if search.dimension != len(parameters) or {len(search.counts), *lengths} != {len(parameters)}:
        return f"its search has other dimensions than its {len(parameters)} parameters"
    if not parameters:
        return "it has no parameters"
    if not 1 <= search.population <= LARGEST_POPULATION or not 0 <= header.budget <= LARGEST_NUMBER:
        return f"its population is {search.population} and its budget {header.budget}"
    if any(each.lower > each.upper or len(each.materials) > len(each.choices) for each in header.parameters):
        return "the bounds or materials of a parameter contradict each other"
    return ""


class Validity:
    """What the records of a run must agree with.

    Args:
        header: of the run.
    """

    def __init__(self, header: RunHeader) -> None:
        self._dimension = len(header.parameters)
        self._parameters = frozenset(parameter.name for parameter in header.parameters)
        self._objectives = frozenset(objective.name for objective in header.objectives)
        self._constraints = frozenset(constraint.name for constraint in header.constrained)
        self._asynchronous = header.search.asynchronous

    def fault(self, record: msgspec.Struct) -> str:
        """What is wrong with a record, and with which, such as `evaluation 3: ...`; empty if nothing is."""
        match record:
            case Evaluation():
                fault = self._evaluation(record)
                return fault and f"evaluation {record.number}: {fault}"
            case Generation():
                fault = self._generation(record)
                return fault and f"generation {record.number}: {fault}"
            case Front():
                if not _counts(record.generation, *record.evaluations):
                    return f"the front of generation {record.generation}: it has numbers that are none"
            case Detail():
                fault = _detail(record)
                return fault and f"the postures of evaluation {record.evaluation}: {fault}"
        return ""

    def _evaluation(self, evaluation: Evaluation) -> str:
        assessment, turn = evaluation.assessment, evaluation.turn
        if not (0 <= evaluation.number <= LARGEST_NUMBER and 0 <= evaluation.generation <= LARGEST_NUMBER):
            return "its number or generation is none"
        if len(evaluation.genome) != self._dimension:
            return f"wanted {self._dimension} coordinates, found {len(evaluation.genome)}"
        if assessment.design.keys() != self._parameters:
            return "its design has not the run's parameters"
        if not assessment.objectives.keys() <= self._objectives:
            return "it has unknown objectives"
        if not assessment.constrained.keys() <= self._constraints:
            return "it has unknown constraints"
        if (turn is not None) != self._asynchronous:
            return "its search has turns, and it has none, or the reverse"
        if turn is not None and not (_counts(turn.number, turn.told) and turn.told <= evaluation.number):
            return "its turn came after it"
        return ""

    def _generation(self, generation: Generation) -> str:
        if not _counts(generation.number, generation.evaluations):
            return "its number or count of evaluations is none"
        if not {*generation.best, *(generation.reference or ())} <= self._objectives:
            return "it has unknown objectives"
        return ""


def _detail(detail: Detail) -> str:
    if not _counts(detail.evaluation):
        return "its number is none"
    for case in detail.cases:
        if isinstance(case.case.task, Lift):
            times = [instant.time_s for instant in case.instants]
            if len(times) < 2 or times != sorted(set(times)):
                return "a lift has not several postures, one after the other"
        elif len(case.instants) != 1:
            return "a case has not one posture of everyone"
        wrong = next((wrong for instant in case.instants if (wrong := _instant(instant))), "")
        if wrong:
            return wrong
    return ""


def _instant(instant: InstantDetail) -> str:
    if not instant.agents or not instant.agents.keys() <= AGENTS:
        return "a case has not one posture of each robot and person"
    if any(agents.keys() != instant.agents.keys() for agents in instant.disturbed.values()):
        return "a disturbance has not the agents of its posture"
    found: list[AgentDetail | LoadCaseDetail] = [*instant.agents.values()]
    found += [each for agents in instant.disturbed.values() for each in agents.values()]
    if not all(map(_complete, found)):
        return "a position, an angle or a wrench has too few or too many components"
    return ""


def _complete(agent: AgentDetail | LoadCaseDetail) -> bool:
    """Whether places have three components, and there is a wrench of six for each contact."""
    places = (agent.base_position_m, agent.base_rpy_rad) if isinstance(agent, AgentDetail) else ()
    contacts = agent.wrenches.keys()
    placed = not HANDS.isdisjoint(contacts) and contacts - HANDS in STANDING
    whole = placed and all(len(each) == 6 for each in agent.wrenches.values())
    return whole and all(len(place) == 3 for place in places)


def _counts(*numbers: int) -> bool:
    """Whether all these count something."""
    return all(0 <= number <= LARGEST_NUMBER for number in numbers)
