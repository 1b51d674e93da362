"""What is exported: one evaluation of a run with its robot and postures, as JSON and as CSV.

CSV has one row per number, or per wrench, as the log has them. Where a problem has several people or loads,
columns `human` and `payload` with their names come first; where a load is lifted, columns `task` and `time_s`
follow, and each moment has rows of its own. Numbers are written with as many digits as read
back to the same double.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import msgspec

from evodesign.mechanics.agent import Agent
from evodesign.records import (
    CaseDetail,
    CaseOutcome,
    Evaluation,
    Hold,
    Lift,
    RunHeader,
    materials_of,
    task_names,
)
from evodesign.report.csv_text import csv_text
from evodesign.report.scene_models import SceneModels, SceneSet
from evodesign.tree.model import JointKind, Tree
from evodesign.violations import constraints_json

Row = Sequence[str | float]

POSTURE_COLUMNS = ("height_m", "agent", "kind", "name", "position", "position_unit", "torque", "torque_unit")
WRENCH_COLUMNS = (
    *("height_m", "agent", "contact", "frame"),
    *("force_x_n", "force_y_n", "force_z_n", "moment_x_n_m", "moment_y_n_m", "moment_z_n_m"),
)
NAME_COLUMNS, TIME_COLUMNS = ("human", "payload"), ("task", "time_s")
BASE = (("x", "m"), ("y", "m"), ("z", "m"), ("roll", "rad"), ("pitch", "rad"), ("yaw", "rad"))
"""Coordinates of the root link in its agent's frame."""


@dataclass(frozen=True, slots=True)
class ExportedDesign:
    """A design with everything that its files tell.

    Args:
        run: name of the run, for people.
        header: of the run.
        evaluation: the design.
        scene_set: robot of the design, people and loads.
        cases: postures of those that were solved, in the problem's order.
        notes: on what is not as in the problem's files, such as a robot that was averaged.
        materials: names by link, of those of the robot that have one.
    """

    run: str
    header: RunHeader
    evaluation: Evaluation
    scene_set: SceneSet
    cases: tuple[CaseDetail, ...]
    notes: tuple[str, ...] = ()
    materials: Mapping[str, str] = field(default_factory=dict)


def design_json(
    header: RunHeader, evaluation: Evaluation, cases: tuple[CaseDetail, ...], *, on_front: bool
) -> dict[str, Any]:
    """A design as a JSON object, as the log has it; its shape is a promise."""
    assessment = evaluation.assessment
    outcome: dict[str, Any] = msgspec.to_builtins(assessment)
    materials, constraints = materials_of(header.parameters, assessment.design), header.constrained
    return {
        "problem": header.problem_name,
        "id": evaluation.number,
        "generation": evaluation.generation,
        "on_front": on_front,
        "status": outcome["status"],
        "reason": outcome["reason"],
        "objectives": outcome["objectives"],
        "units": {objective.name: objective.unit for objective in header.objectives},
        "parameters": outcome["design"],
        **({"materials": materials} if materials else {}),
        "violation": outcome["violation"],
        **({"constraints": constraints_json(constraints, assessment)} if constraints else {}),
        "reach": outcome["reach"],
        "heights": [_case_json(each) for each in assessment.cases if isinstance(each.case.task, Hold)],
        "postures": [_case_json(each) for each in cases if isinstance(each.case.task, Hold)],
        **_lifts(assessment.cases, cases),
    }


def _lifts(outcomes: Sequence[CaseOutcome], cases: Sequence[CaseDetail]) -> dict[str, Any]:
    """Lifts and their motions, under keys that other problems do not have."""
    lifts = [_case_json(each) for each in outcomes if isinstance(each.case.task, Lift)]
    motions = [_case_json(each) for each in cases if isinstance(each.case.task, Lift)]
    return {"lifts": lifts, "motions": motions} if lifts else {}


def _case_json(part: CaseOutcome | CaseDetail) -> dict[str, Any]:
    """A part of the log; what holds a load still has no instants but a posture."""
    told: dict[str, Any] = msgspec.to_builtins(part)
    del told["case"]
    if isinstance(part.case.task, Hold):
        (instant,) = told.pop("instants", [{}])
        told |= {key: instant[key] for key in instant if key != "time_s"}
    return {**task_names(part.case), **told}


def postures_csv(scene_set: SceneSet, cases: Sequence[CaseDetail]) -> str:
    """Base coordinates, joint positions and torques of robot and person."""
    cases = [moment for detail in cases for moment in detail.moments]
    return _text(POSTURE_COLUMNS, cases, [_posture_rows(scene_set.models_of(each), each) for each in cases])


def wrenches_csv(scene_set: SceneSet, cases: Sequence[CaseDetail]) -> str:
    """Wrenches on hands (about the grasp point) and feet (about the sole's origin)."""
    cases = [moment for detail in cases for moment in detail.moments]
    return _text(WRENCH_COLUMNS, cases, [_wrench_rows(scene_set.models_of(each), each) for each in cases])


def _posture_rows(models: SceneModels, detail: CaseDetail) -> Iterator[Row]:
    height = detail.height_m
    for name, tree in models.trees.items():
        posture = detail.agents[name]
        base = (*posture.base_position_m, *posture.base_rpy_rad)
        for (coordinate, unit), value in zip(BASE, base, strict=True):
            yield height, name, "base", coordinate, value, unit, "", ""
        for joint, position in posture.joints_rad.items():
            kind, *units = _joint(tree, joint)
            torque = posture.torques_n_m[joint]
            yield height, name, kind, joint, position, units[0], torque, units[1]


def _joint(tree: Tree, name: str) -> tuple[str, str, str]:
    """Kind of a joint, unit of its position, unit of its torque or force."""
    kind = tree.joint_by_name[name].kind
    return (kind, "m", "N") if kind is JointKind.PRISMATIC else (kind, "rad", "N m")


def _wrench_rows(models: SceneModels, detail: CaseDetail) -> Iterator[Row]:
    for agent in models.agents:
        yield from _wrenches_of(agent, detail)


def _wrenches_of(agent: Agent, detail: CaseDetail) -> Iterator[Row]:
    height, posture = detail.height_m, detail.agents[agent.name]
    for hand in agent.hands:
        frame = f"{agent.name}'s own, x at the load"
        yield height, agent.name, hand.name, frame, *posture.wrenches[hand.name]
    for foot in agent.feet:
        yield height, agent.name, foot.name, foot.frame, *posture.wrenches[foot.name]


def _text(columns: Row, cases: Sequence[CaseDetail], rows_of: Iterable[Iterable[Row]]) -> str:
    """The rows of each case under their columns, with names of people and loads where they are needed."""
    named = any(detail.case.label for detail in cases)
    timed = any(isinstance(detail.case.task, Lift) for detail in cases)
    heads = [*(NAME_COLUMNS if named else ()), *(TIME_COLUMNS if timed else ())]
    lines: list[Row] = [(*heads, *columns)]
    for detail, rows in zip(cases, rows_of, strict=True):
        names = detail.case.pair if named else ()
        times = (str(detail.case.task), detail.time_s) if timed else ()
        lines += [(*names, *times, *row) for row in rows]
    return csv_text(lines)
