"""Numbers of an evaluation by the names that a user writes: in conditions, on axes, in tables.

    robot_torque                an objective of the run, natural value
    length.thigh                a parameter of the design
    lowest_reach, highest_reach ends of the interval of load heights that the robot can hold [m]
    robot_torque@1.2            |tau|_2 of an agent at a required height [N m]; human_torque@1.2 likewise

An objective of the same name goes before the others.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial

from evodesign.errors import InputError, nearest_name
from evodesign.records import Evaluation, HeightOutcome, RunHeader

__all__ = ["Quantity", "quantities", "quantity"]

Quantity = Callable[[Evaluation], float | None]
"""A number of an evaluation; None where it does not exist."""


def quantities(header: RunHeader, example: Evaluation | None) -> dict[str, Quantity]:
    """All quantities of a run, by name.

    Args:
        header: of the run; its objectives and parameters have names.
        example: any evaluation of the run, for its heights; None for a run that has none yet.
    """
    heights = () if example is None else example.assessment.heights
    found: dict[str, Quantity] = {"lowest_reach": _lowest_reach, "highest_reach": _highest_reach}
    for outcome in heights:
        found[f"robot_torque@{outcome.height_m:g}"] = partial(_robot_torque, outcome.height_m)
        found[f"human_torque@{outcome.height_m:g}"] = partial(_human_torque, outcome.height_m)
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
        wanted = f"one of {', '.join(known)}"
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


def _robot_torque(height_m: float, evaluation: Evaluation) -> float | None:
    outcome = _outcome(evaluation, height_m)
    return None if outcome is None else outcome.robot_torque_norm


def _human_torque(height_m: float, evaluation: Evaluation) -> float | None:
    outcome = _outcome(evaluation, height_m)
    return None if outcome is None else outcome.human_torque_norm


def _outcome(evaluation: Evaluation, height_m: float) -> HeightOutcome | None:
    outcomes = evaluation.assessment.heights
    return next((outcome for outcome in outcomes if outcome.height_m == height_m), None)
