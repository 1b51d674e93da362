"""Numbers of an evaluation by the names that a user writes: in conditions, on axes, in tables.

    robot_torque                an objective of the run, natural value
    length.thigh                a parameter of the design
    lowest_reach, highest_reach ends of the interval of load heights that the robot can hold [m]
    robot_torque@1.2            |tau|_2 of an agent at a required height [N m]; human_torque@1.2 likewise
    robot_torque@short@5 kg@1.2 that of one case, where a problem has several people or loads; then
                                robot_torque@1.2 is the largest at that height, if all of them are solved

An objective of the same name goes before the others.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial

from evodesign.analysis.cases import case_name, named_people_or_loads
from evodesign.errors import InputError, nearest_name
from evodesign.records import Evaluation, HeightOutcome, RunHeader

__all__ = ["Quantity", "quantities", "quantity"]

Quantity = Callable[[Evaluation], float | None]
"""A number of an evaluation; None where it does not exist."""

Norm = Callable[[HeightOutcome], float | None]
"""The torque norm of one of the agents [N m]."""


def quantities(header: RunHeader, example: Evaluation | None) -> dict[str, Quantity]:
    """All quantities of a run, by name.

    Args:
        header: of the run; its objectives and parameters have names.
        example: any evaluation of the run, for its cases; None for a run that has none yet.
    """
    outcomes = () if example is None else example.assessment.heights
    found: dict[str, Quantity] = {"lowest_reach": _lowest_reach, "highest_reach": _highest_reach}
    for outcome in outcomes:
        found[f"robot_torque@{outcome.height_m:g}"] = partial(_largest, _robot_norm, outcome.height_m)
        found[f"human_torque@{outcome.height_m:g}"] = partial(_largest, _human_norm, outcome.height_m)
    if named_people_or_loads(outcomes):
        for outcome in outcomes:
            names = (outcome.human_name, outcome.payload_name, f"{outcome.height_m:g}")
            place = "@".join(name for name in names if name)
            found[f"robot_torque@{place}"] = partial(_of_case, _robot_norm, outcome)
            found[f"human_torque@{place}"] = partial(_of_case, _human_norm, outcome)
    for parameter in header.parameters:
        found[parameter.name] = partial(_parameter, parameter.name)
    for objective in header.objectives:
        found[objective.name] = partial(_objective, objective.name)
    return found


def quantity(known: Mapping[str, Quantity], name: str, source: str) -> Quantity:
    """The quantity of a name.

    Raises:
        InputError: there is none; it names the nearest.
    """
    if name not in known:
        short = [each for each in known if each.count("@") < 2]
        wanted = f"one of {', '.join(short)}"
        if len(short) < len(known):
            wanted += ", robot_torque@WHO@WHAT@HEIGHT, human_torque@WHO@WHAT@HEIGHT"
        raise InputError(source, "", wanted, f"'{name}'{nearest_name(name, known)}")
    return known[name]


def _objective(name: str, evaluation: Evaluation) -> float | None:
    return evaluation.assessment.objectives.get(name)


def _parameter(name: str, evaluation: Evaluation) -> float | None:
    return evaluation.assessment.design.get(name)


def _lowest_reach(evaluation: Evaluation) -> float | None:
    reach = evaluation.assessment.reach
    return None if reach is None else reach.lowest_m


def _highest_reach(evaluation: Evaluation) -> float | None:
    reach = evaluation.assessment.reach
    return None if reach is None else reach.highest_m


def _robot_norm(outcome: HeightOutcome) -> float | None:
    return outcome.robot_torque_norm


def _human_norm(outcome: HeightOutcome) -> float | None:
    return outcome.human_torque_norm


def _largest(norm: Norm, height_m: float, evaluation: Evaluation) -> float | None:
    """The largest over all cases of a height; None unless each of them has one."""
    outcomes = [outcome for outcome in evaluation.assessment.heights if outcome.height_m == height_m]
    norms = [norm(outcome) for outcome in outcomes]
    known = [value for value in norms if value is not None]
    return max(known) if known and len(known) == len(norms) else None


def _of_case(norm: Norm, wanted: HeightOutcome, evaluation: Evaluation) -> float | None:
    for outcome in evaluation.assessment.heights:
        if case_name(outcome) == case_name(wanted):
            return norm(outcome)
    return None
