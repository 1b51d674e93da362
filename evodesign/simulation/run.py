"""A simulation in time: feed-forward torques of the plan, joint feedback, and what came of them."""

from __future__ import annotations

from collections.abc import Mapping

import mujoco
import numpy as np

from evodesign.mechanics.scene import SIDES, Scene
from evodesign.posture.check import AgentModel
from evodesign.simulation.feedback import Feedback, set_gains
from evodesign.simulation.model import SimulatedScene, simulated_scene
from evodesign.simulation.outcome import FALLEN, AgentRecord, Record
from evodesign.simulation.plan import Plan

__all__ = ["simulated"]


def simulated(scene: Scene, models: Mapping[str, AgentModel], plan: Plan, feedback: Feedback) -> Record:
    """Robot and person follow a plan.

    Args:
        scene: undisturbed.
        models: robot and person by name, with the trees of a design.
        plan: of the scene; its step is the simulation's.
        feedback: of the joints of both.
    Returns:
        What they did, at the plan's times, until somebody fell.
    Raises:
        ModelError: as `simulated_scene`.
    """
    first = {name: agent.first for name, agent in plan.agents.items()}
    found = simulated_scene(scene, models, first, float(plan.heights[0]), plan.step)
    set_gains(found, feedback)
    model, data = found.model, found.data
    inputs = {name: _inputs(found, plan, name) for name in plan.agents}
    rows: list[dict[str, object]] = []
    fallen: tuple[str, ...] = ()
    for place in range(len(plan.heights)):
        for name, parts in found.agents.items():
            data.ctrl[parts.actuators] = inputs[name][place]
        mujoco.mj_step1(model, data)
        mujoco.mj_fwdActuation(model, data)
        mujoco.mj_fwdAcceleration(model, data)
        mujoco.mj_fwdConstraint(model, data)
        rows.append(_row(found))
        fallen = tuple(name for name in found.agents if _fell(found, plan, name, place))
        if fallen:
            break
        mujoco.mj_step2(model, data)
    stacked = {key: np.array([row[key] for row in rows]) for key in rows[0]}
    agents = {}
    for name, parts in found.agents.items():
        limited = model.actuator_forcelimited[parts.actuators].astype(bool)
        limits = np.where(limited, model.actuator_forcerange[parts.actuators, 1], np.inf)
        own = {key: stacked[f"{name}.{key}"] for key in ("roots", "positions", "torques", "soles")}
        agents[name] = AgentRecord(**own, limits=limits)
    return Record(plan.times[: len(rows)], stacked["loads"], agents, fallen)
 

def _inputs(found, plan, name):
    own, parts = plan.agents[name], found.agents[name]
    stiffness, damping = -found.model.actuator_biasprm[parts.actuators, 1:3].T
    return own.torques + stiffness * own.positions + damping * own.rates


def _row(found):
    data = found.data
    row = {"loads": np.r_[data.xpos[found.load], data.xquat[found.load]]}
    for name, parts in found.agents.items():
        row[f"{name}.roots"] = np.r_[data.xpos[parts.root], data.xquat[parts.root]]
        row[f"{name}.positions"] = data.qpos[parts.positions]
        row[f"{name}.torques"] = data.actuator_force[parts.actuators] + found.model.actuator_biasprm[parts.actuators, 2]*found.model.opt.timestep*data.qacc[parts.rates]
        geoms = [parts.soles[side] for side in SIDES]
        row[f"{name}.soles"] = data.geom_xpos[geoms].copy()
    return row


def _fell(found, plan, name, place):
    parts = found.agents[name]
    base = plan.agents[name].bases[place] * [parts.agent.sign, parts.agent.sign, 1.0]
    return not np.linalg.norm(found.data.xpos[parts.root] - base) < FALLEN
