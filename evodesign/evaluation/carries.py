"""Walks with the load that begin in the holds of a design: what each takes."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from evodesign.errors import InputError
from evodesign.mechanics.agent import Role
from evodesign.mechanics.lumbar_load import has_lumbar_disc
from evodesign.quantities.motion_quantities import power
from evodesign.quantities.person_quantities import compression
from evodesign.simulation.carry import CarryOutcome, carried
from evodesign.simulation.pushed_plan import PushConditions, PushedPlan


@dataclass(frozen=True, slots=True, eq=False)
class CarriedCase:
    """A walk from a hold.

    Args:
        name: of the hold.
        load: mass [kg].
        outcome: of the walk.
        energy: what each agent's joints and actuators draw [J], by name.
        compression: largest of each person's disc L5/S1 [N], by name.
    """

    name: str
    load: float
    outcome: CarryOutcome
    energy: Mapping[str, float]
    compression: Mapping[str, float]


def carried_holds(
    plans: Iterable[PushedPlan],
    way: tuple[float, float],
    load: float | None,
    conditions: PushConditions,
) -> Iterator[CarriedCase]:
    """The walk from each hold.

    Args:
        plans: of the holds.
        way: distance [m], and direction from the robot's forwards to its left [rad].
        load: its mass [kg]; None: the hold's.
        conditions: of everything else.
    Raises:
        InputError: a distance or a mass that is not positive.
    """
    for key, value in {"--distance": way[0], "--load": load}.items():
        if value is not None and not 0.0 < value < math.inf:
            raise InputError(key, "", "a positive number", f"{value}")
    for plan in plans:
        held = plan if load is None else _with_load(plan, load)
        yield _case(held, carried(held, *way, conditions))


def _with_load(plan: PushedPlan, mass: float) -> PushedPlan:
    """A hold of a load of another mass, of which hands carry the same shares."""
    payload, factor = plan.scene.payload, mass / plan.scene.payload.mass
    postures = {}
    for agent in plan.scene.agents:
        posture = plan.postures[agent.name]
        hands = {hand.name: factor * posture.wrenches[hand.name] for hand in agent.hands}
        postures[agent.name] = replace(posture, wrenches={**posture.wrenches, **hands})
    return replace(plan, scene=replace(plan.scene, payload=replace(payload, mass=mass)), postures=postures)


def _case(plan: PushedPlan, outcome: CarryOutcome) -> CarriedCase:
    energy, compressions = {}, {}
    for agent in plan.scene.agents:
        own, instants = replace(agent, tree=plan.trees[agent.name]), outcome.instants.get(agent.name, ())
        if not instants:
            continue
        energy[agent.name] = outcome.seconds * float(np.mean([power(own, each) for each in instants]))
        if agent.role is Role.PERSON and has_lumbar_disc(own):
            compressions[agent.name] = float(max(compression(own, each) for each in instants))
    return CarriedCase(plan.name, plan.scene.payload.mass, outcome, energy, compressions)


def carries_json(cases: Iterable[CarriedCase]) -> list[dict[str, Any]]:
    """What the table shows, in SI units and degrees."""
    return [
        {
            "hold": case.name,
            "load_kg": case.load,
            "walked": not case.outcome.reason,
            "reason": case.outcome.reason,
            "seconds": case.outcome.seconds,
            "distance_m": case.outcome.distance,
            "step_m": case.outcome.length,
            "steps": case.outcome.steps,
            "tilt_deg": math.degrees(case.outcome.tilt),
            "load_off_m": case.outcome.load_off,
            "agents": {
                name: {
                    "torque_n_m": each.torque,
                    "joint": each.joint,
                    "torque_saturation": each.saturation,
                    "saturated": list(each.saturated),
                    "capture_point_m": each.capture,
                    "energy_j": case.energy.get(name),
                    "back_compression_n": case.compression.get(name),
                }
                for name, each in case.outcome.agents.items()
            },
        }
        for case in cases
    ]
