"""Lifts as JSON and as a table over time (docs/motion.md has keys and units)."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping
from typing import Any

from evodesign.motion.solution import LiftSolution


def lift_json(solutions: Mapping[tuple[str, str], LiftSolution]) -> dict[str, Any]:
    """What a lift takes of robot and person, for every person and load."""
    return {"lifts": [_one(pair, solution) for pair, solution in solutions.items()]}


def _one(pair: tuple[str, str], solution: LiftSolution) -> dict[str, Any]:
    lift, checked = solution.lift, solution.checked
    found: dict[str, Any] = {
        "person": pair[0],
        "payload": pair[1],
        "from_m": lift.from_m,
        "to_m": lift.to_m,
        "seconds": lift.seconds,
        "profile": lift.profile,
        "knots": lift.knots,
        "status": solution.status,
        "reason": solution.reason,
        "attempts": [
            {
                "start": each.start,
                "status": each.status,
                "iterations": each.iterations,
                "seconds": each.seconds,
                "cost": each.cost,
            }
            for each in solution.attempts
        ],
    }
    if solution.course is None or checked is None:
        return found
    times = solution.times
    return found | {
        "residuals": {"knots": checked.knots, "between": checked.between, "energy": checked.energy_error},
        "energy_gained_j": checked.energy,
        **({} if solution.least is None else {"least_seconds": solution.least.seconds}),
        "times_s": times.tolist(),
        "heights_m": solution.course.heights(times).tolist(),
        "agents": {
            name: {
                "mean_torque": effort.mean_torque,
                "peak_torque": effort.peak_torque,
                "static_share": effort.static_share,
                "work_j": effort.work,
                "peak_power_w": float(effort.power.max()),
                "torque_norms": effort.torques.tolist(),
                "powers_w": effort.power.tolist(),
                "disturbed_torque_norms": {key: norms.tolist() for key, norms in effort.disturbed.items()},
            }
            for name, effort in solution.efforts.items()
        },
    }


def lift_csv(solutions: Mapping[tuple[str, str], LiftSolution]) -> str:
    """A row for each moment of the lifts that were found: every joint's position and torque."""
    text, header = io.StringIO(), ["person", "payload", "time_s", "height_m"]
    rows: list[dict[str, Any]] = []
    for (person, payload), solution in solutions.items():
        if solution.course is None:
            continue
        instants = solution.course.instants(solution.times)
        for instant, height in zip(instants, solution.course.heights(solution.times), strict=True):
            row: dict[str, Any] = {"person": person, "payload": payload, "time_s": instant.time}
            row["height_m"] = float(height)
            for name, posture in instant.postures.items():
                row |= {f"{name}.{joint}.position_rad": at for joint, at in posture.joints.items()}
                row |= {f"{name}.{joint}.torque_n_m": torque for joint, torque in posture.torques.items()}
            rows.append(row)
    columns = dict.fromkeys([*header, *(name for row in rows for name in row)])
    writer = csv.DictWriter(text, list(columns), lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()
