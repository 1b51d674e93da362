"""The answer of `evodesign evaluate`: everything about one design, in one JSON object.

Its shape is a promise. Units: heights and positions [m], angles [rad], torques [N m], forces [N], times [s].
Positions and hand wrenches are in the agent's own frame, which looks along +x at the load above its origin; a
wrench is force, then moment, acting on the agent: at a hand about the grasp point, at a foot about the sole's
origin and in the sole frame.

`ergonomics` says what a posture asks of the person: `effort` is the share of its strength that the hardest
joint needs, in the direction of `movement`; then the revised NIOSH lifting equation, what the load adds to
the torques, the disc L5/S1, the holding time, and the scores of RULA and REBA (docs/people.md).

`cases` has an entry for each undisturbed case: the names of `person` and `payload`, empty where the problem
has one, the `task`, and what came of it. `heights` tells the same of every load held still by its `height_m`
and, where the problem has several people or loads, its `human_name` and `payload_name`. A lift has `instants`
in place of one posture, with their `time_s` and `load_height_m`, and `speeds` of the joints [rad/s]; its
`ergonomics` is that of the instant at which the person's torques are largest.

`clearance` tells of a posture which two bodies are the nearest of those that must not overlap, and how far
they are apart, negative where they overlap:

    {"bodies": ["robot l_foot", "robot r_foot"], "distance_m": -0.01}

`limits` lists the limits that hold a posture, with what each costs [N m per unit] (`posture.active_limits`):

    {"name": "feet apart", "value": 0.5, "unit": "m", "price_n_m": -3.9, "at_most": true, "agent": "robot",
     "part": "", "key": "limits.feet_apart_m"}

Where the problem has disturbances, a solved case's `disturbed` holds, by their names, torques and wrenches
of the same posture under each. Residuals of such a case carry its name.

`materials` names the material of each density that is one's; a problem without materials has no such key.
Likewise `hardware`, the bill of materials (`evaluation.bill`), where there are actuators or walls.

`constraints` has an entry for each of the problem's `[constraints]`, with its `lower` and `upper` bound, its
`value` and by how much that violates it, all in its unit; a problem without constraints has no such key.
`violation` is zero for a feasible design and otherwise as in `evodesign.violations`.

`sensitivities` holds, for each objective and constrained quantity that exists, how it moves with the design:

    {objective: {"gradient": {parameter: value} or null, "notes": [sentences]}}

in the objective's unit per unit of the parameter (a length multiplier has none, a density is in kg/m^3). The
gradient is that of the optimum that won; the sentences say which start won in each case and how far behind
the next best optimum is, which limit of a posture a small change of one parameter reaches or leaves, and,
where the gradient is null, why there is none.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import msgspec

from evodesign.collision.clearance import BodyDistance
from evodesign.evaluation.bill import bill_of_materials
from evodesign.evaluation.clearance import distance_json, solved_distances
from evodesign.evaluation.sensitivities import ObjectiveSensitivity
from evodesign.posture.results import AgentPosture, CaseSolution, Instant
from evodesign.problem.build import DesignProblem
from evodesign.quantities.design_result import DesignResult
from evodesign.quantities.ergonomics import ergonomics, ergonomics_json
from evodesign.records import Assessment, CaseDetail, Hold, materials_of, task_names
from evodesign.violations import constraints_json


def evaluation_json(
    problem: DesignProblem,
    values: Sequence[float],
    result: DesignResult,
    assessment: Assessment,
    sensitivities: Mapping[str, ObjectiveSensitivity],
    details: Sequence[CaseDetail],
) -> dict[str, Any]:
    """The JSON object of one design.

    Args:
        problem: whose design it is.
        values: one number per parameter.
        result: of its evaluation.
        assessment: the same in short.
        sensitivities: of its objectives and constrained quantities.
        details: the postures of its solved cases, with the limits that hold them.
    """
    design = dict(problem.space.named(values))
    materials = materials_of(problem.space.records, design)
    gaps = solved_distances(result)
    by_case = {detail.case: detail for detail in details}
    bill = bill_of_materials(problem, result.tree, details)
    shown = [
        _shown(solution, result, gaps.get(solution.case), by_case.get(solution.case))
        for solution in result.cases
    ]
    return {
        "problem": problem.name,
        "design": design,
        **({"materials": materials} if materials else {}),
        **({"hardware": bill} if bill else {}),
        "status": str(assessment.status),
        "objectives": assessment.objectives,
        "units": {objective.name: objective.unit for objective in problem.objectives},
        "violation": assessment.violation,
        **({"constraints": constraints_json(problem.constraints, assessment)} if problem.constraints else {}),
        "reach": {
            "lowest_m": result.reach.lowest,
            "highest_m": result.reach.highest,
            "or_lower": result.reach.or_lower,
            "status": str(result.reach.status),
            "reason": result.reach.reason,
        },
        "cases": [
            {"person": "", "payload": ""} | msgspec.to_builtins(each.case) | of
            for each, of in zip(result.cases, shown, strict=True)
        ],
        "heights": [
            task_names(each.case) | of
            for each, of in zip(result.cases, shown, strict=True)
            if isinstance(each.case.task, Hold)
        ],
        "sensitivities": {
            name: {"gradient": found.gradient, "notes": list(found.notes)}
            for name, found in sensitivities.items()
        },
    }


def _shown(
    solution: CaseSolution, result: DesignResult, gap: BodyDistance | None, detail: CaseDetail | None
) -> dict[str, Any]:
    """All of a case but its name."""
    shown: dict[str, Any] = {
        "status": str(solution.status),
        "reason": solution.reason,
        "start": solution.attempt.name if solution.attempt else "",
        "solver": _solver(solution),
    }
    if detail is not None:
        if isinstance(solution.case.task, Hold):
            shown |= _instant(solution.instants[0])
            shown["limits"] = msgspec.to_builtins(detail.limits)
        else:
            shown["instants"] = [
                {"time_s": each.time, "load_height_m": each.height, **_instant(each)}
                for each in solution.instants
            ]
        shown["residuals"] = dict(solution.residuals)
        if gap is not None:
            shown["clearance"] = distance_json(gap)
        found = {
            person.name: ergonomics_json(ergonomics(person, detail.hardest.agents[person.name]))
            for person in result.scene_of(solution.case).people
        }
        if found:
            shown["ergonomics"] = found if len(found) > 1 else found.popitem()[1]
    return shown


def _instant(instant: Instant) -> dict[str, Any]:
    """Postures of both agents, and what they carry."""
    shown: dict[str, Any] = {name: _agent(posture) for name, posture in instant.postures.items()}
    shown["wrenches"] = _contacts(instant.postures)
    if instant.disturbed:
        shown["disturbed"] = {name: _load_case(postures) for name, postures in instant.disturbed.items()}
    return shown


def _load_case(postures: Mapping[str, AgentPosture]) -> dict[str, Any]:
    """Torques and wrenches of agents in a posture that is shown elsewhere."""
    strained = {
        name: {"torque_norm": posture.torque_norm, "torques": dict(posture.torques)}
        for name, posture in postures.items()
    }
    return {**strained, "wrenches": _contacts(postures)}


def _contacts(postures: Mapping[str, AgentPosture]) -> dict[str, list[float]]:
    return {
        f"{name}.{contact}": wrench
        for name, posture in postures.items()
        for contact, wrench in _wrenches(posture).items()
    }


def _agent(posture: AgentPosture) -> dict[str, Any]:
    return {
        "torque_norm": posture.torque_norm,
        "torques": dict(posture.torques),
        "base": {
            "position_m": posture.base_position.tolist(),
            "rpy_rad": posture.base_angles.tolist(),
        },
        "joints": dict(posture.joints),
        **({"speeds": dict(posture.speeds)} if posture.speeds else {}),
    }


def _wrenches(posture: AgentPosture) -> dict[str, list[float]]:
    return {name: wrench.tolist() for name, wrench in posture.wrenches.items()}


def _solver(solution: CaseSolution) -> dict[str, Any]:
    return {
        "iterations": sum(attempt.iterations for attempt in solution.attempts),
        "seconds": sum(attempt.seconds for attempt in solution.attempts),
        "attempts": [
            {
                "start": attempt.name,
                "status": str(attempt.status),
                "reason": attempt.reason,
                "iterations": attempt.iterations,
                "seconds": attempt.seconds,
                "cost": attempt.cost,
            }
            for attempt in solution.attempts
        ],
    }
