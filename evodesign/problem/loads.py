"""The loads of a problem file."""

from __future__ import annotations

import math
from dataclasses import replace

from evodesign.errors import InputError
from evodesign.mechanics.scene import HUMAN, ROBOT, SIDES, Grasp, Payload
from evodesign.problem.file import PayloadTable, ProblemFile
from evodesign.records import ProblemSource

__all__ = ["payloads"]


def payloads(tables: ProblemFile, source: ProblemSource) -> tuple[Payload, ...]:
    """The loads of the `payload` tables; where there are several, each has a label of its own.

    Raises:
        InputError: a centre of mass outside the box, a moment of point grasps, or two loads of one name.
    """
    loads = [_payload(key, table, source) for key, table in tables.loads.items()]
    if len(loads) == 1:
        return tuple(loads)
    labelled: list[Payload] = []
    for (key, table), load in zip(tables.loads.items(), loads, strict=True):
        label = table.name or f"{load.mass:g} kg"
        if any(other.label == label for other in labelled):
            raise InputError(source.path, f"{key}.name", "a name of its own", f"'{label}' twice")
        labelled.append(replace(load, label=label))
    return tuple(labelled)


def _payload(key: str, table: PayloadTable, source: ProblemSource) -> Payload:
    for axis, (offset, size) in enumerate(zip(table.center_of_mass_m, table.size_m, strict=True)):
        if abs(offset) > size / 2.0:
            where = f"{key}.center_of_mass_m[{axis}]"
            raise InputError(source.path, where, f"a point in the box, at most {size / 2.0:g}", f"{offset:g}")
    points = {
        (agent, side): getattr(grasps, side)
        for agent, grasps in ((ROBOT, table.robot_grasps_m), (HUMAN, table.human_grasps_m))
        if grasps is not None
        for side in SIDES
    }
    moment = _hand_moment(key, table, source)
    return Payload(table.size_m, table.mass_kg, table.center_of_mass_m, table.grasp, moment, points)


def _hand_moment(key: str, table: PayloadTable, source: ProblemSource) -> float:
    """Largest moment of a rigid hand [N m]; without a bound, infinite."""
    if table.hand_moment_n_m is None:
        return math.inf
    if table.grasp is Grasp.POINT:
        found = f"{table.hand_moment_n_m:g} for point grasps, which pass no moment"
        raise InputError(source.path, f"{key}.hand_moment_n_m", "grasp = 'rigid' with it", found)
    return table.hand_moment_n_m
