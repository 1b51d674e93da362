"""The answer of `evodesign evaluate`: everything about one design, in one JSON object.

Its shape is a promise. Units: heights and positions [m], angles [rad], torques [N m], forces [N], times [s].
Positions and hand wrenches are in the agent's own frame, which looks along +x at the load above its origin; a
wrench is force, then moment, acting on the agent: at a hand about the grasp point, at a foot about the sole's
origin and in the sole frame.

`ergonomics` says what a posture asks of the person: `effort` is the share of its strength that the hardest
joint needs, in the direction of `movement`; the rest is the revised NIOSH lifting equation (docs/people.md).

Where a problem has several people or loads, `heights` has an entry for each case, with its `human_name` and
`payload_name`.

Where the problem has disturbances, a solved height's `disturbed` holds, by their names, torques and wrenches
of the same posture under each. Residuals of such a case carry its name.

`materials` names the material of each density that is one's; a problem without materials has no such key.

`sensitivities` holds, for each objective that exists, how it moves with the design:

    {objective: {"gradient": {parameter: value} or null, "notes": [sentences]}}

in the objective's unit per unit of the parameter (a length multiplier has none, a density is in kg/m^3). The
gradient is that of the optimum that won; the sentences say which start won at each height and how far behind
the next best optimum is, which limit of a posture a small change of one parameter reaches or leaves, and,
where the gradient is null, why there is none.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from evodesign.mechanics.scene import HUMAN, SIDES, Scene
from evodesign.posture.results import AgentPosture, HeightSolution
from evodesign.problem.build import Problem
from evodesign.problem.ergonomics import ergonomics, ergonomics_json
from evodesign.problem.evaluate import detail_of
from evodesign.problem.result import DesignResult
from evodesign.problem.sensitivities import ObjectiveSensitivity
from evodesign.records import Assessment, materials_of

__all__ = ["evaluation_json"]


def evaluation_json(
    problem: Problem,
    values: Sequence[float],
    result: DesignResult,
    assessment: Assessment,
    sensitivities: Mapping[str, ObjectiveSensitivity],
) -> dict[str, Any]:
    """The JSON object of one design."""
    design = dict(problem.space.named(values))
    materials = materials_of(problem.space.records, design)
    return {
        "problem": problem.name,
        "design": design,
        **({"materials": materials} if materials else {}),
        "status": str(assessment.status),
        "objectives": assessment.objectives,
        "units": {objective.name: objective.unit for objective in problem.objectives},
        "violation": assessment.violation,
        "reach": {
            "lowest_m": result.reach.lowest,
            "highest_m": result.reach.highest,
            "status": str(result.reach.status),
            "reason": result.reach.reason,
        },
        "heights": [_height(height, result.scenes[height.scene]) for height in result.heights],
        "sensitivities": {
            name: {"gradient": found.gradient, "notes": list(found.notes)}
            for name, found in sensitivities.items()
        },
    }


def _height(height: HeightSolution, scene: Scene) -> dict[str, Any]:
    labels = {"human_name": scene.human.label, "payload_name": scene.payload.label}
    shown: dict[str, Any] = {
        "height_m": height.height,
        **{name: label for name, label in labels.items() if label},
        "status": str(height.status),
        "reason": height.reason,
        "start": height.attempt.name if height.attempt else "",
        "solver": _solver(height),
    }
    if height.solved:
        shown.update({name: _agent(posture) for name, posture in height.postures.items()})
        shown["wrenches"] = _contacts(height.postures)
        if height.disturbed:
            shown["disturbed"] = {name: _borne(postures) for name, postures in height.disturbed.items()}
        shown["residuals"] = dict(height.residuals)
        posture = detail_of(height, scene).agents[HUMAN]
        shown["ergonomics"] = ergonomics_json(ergonomics(scene.human, posture))
    return shown


def _borne(postures: Mapping[str, AgentPosture]) -> dict[str, Any]:
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
    }


def _wrenches(posture: AgentPosture) -> dict[str, list[float]]:
    hands = {f"{side}_hand": posture.hand_wrenches[side].tolist() for side in SIDES}
    feet = {f"{side}_foot": posture.foot_wrenches[side].tolist() for side in SIDES}
    return {**hands, **feet}


def _solver(height: HeightSolution) -> dict[str, Any]:
    return {
        "iterations": sum(attempt.iterations for attempt in height.attempts),
        "seconds": sum(attempt.seconds for attempt in height.attempts),
        "attempts": [
            {
                "start": attempt.name,
                "status": str(attempt.status),
                "reason": attempt.reason,
                "iterations": attempt.iterations,
                "seconds": attempt.seconds,
                "cost": attempt.cost,
            }
            for attempt in height.attempts
        ],
    }
