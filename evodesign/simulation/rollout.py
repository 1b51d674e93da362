"""A simulation in time: torques of the plan, joint feedback, and Newton's laws.

Damping is taken at the end of a step (`feedback.set_damping`), with forces of contacts and grasps found for
the same sum, so that stiff feedback does not shake the feet. The torque of a step is u - k q - d v', as it
acts.
"""

from __future__ import annotations

from collections.abc import Mapping

import mujoco
import numpy as np

from evodesign.control.gains import Feedback
from evodesign.mechanics.scene import Scene
from evodesign.posture.results import Array
from evodesign.simulation.contact_wrenches import foot_wrenches, hand_wrenches
from evodesign.simulation.feedback import set_gains
from evodesign.simulation.model import SimulatedScene, simulated_scene
from evodesign.simulation.outcome import FALLEN, AgentRollout, Rollout
from evodesign.simulation.plan import Plan
from evodesign.tree.model import Tree

FRAME = 0.02
"""Time between two frames of a recording [s]."""


def rolled_out(scene: Scene, trees: Mapping[str, Tree], plan: Plan, feedback: Feedback) -> Rollout:
    """Robot and person follow a plan, until it ends or somebody falls.

    Args:
        scene: undisturbed.
        trees: of robot and person by name, of a design.
        plan: of the scene; its step is the simulation's.
        feedback: of the joints of both.
    Raises:
        ModelError: as `simulated_scene`.
    """
    first = {name: agent.first for name, agent in plan.agents.items()}
    found = simulated_scene(scene, trees, first, float(plan.heights[0]), plan.step)
    set_gains(found, feedback)
    model, data = found.model, found.data
    inputs = {name: _inputs(found, plan, name) for name in plan.agents}
    every = max(1, round(FRAME / plan.step))
    rows: list[dict[str, Array]] = []
    frames: list[dict[str, Array]] = []
    fallen: tuple[str, ...] = ()
    for place in range(len(plan.heights)):
        for name, parts in found.agents.items():
            data.ctrl[parts.actuators] = inputs[name][place]
        mujoco.mj_forward(model, data)
        rows.append(_row(found))
        if place % every == 0:
            frames.append(_frame(found))
        fallen = tuple(name for name in found.agents if _fell(found, plan, name, place))
        if fallen:
            break
        mujoco.mj_Euler(model, data)
    return _collected(found, plan, rows, frames, every, fallen)


def _inputs(found: SimulatedScene, plan: Plan, name: str) -> Array:
    """Inputs u over time, shape (n, j): damping is with respect to the speeds at the end of a step."""
    own, parts = plan.agents[name], found.agents[name]
    stiffness, damping = -found.model.actuator_biasprm[parts.actuators, 1:3].T
    rates = np.vstack([own.rates[1:], own.rates[-1:]])
    return np.asarray(own.torques + stiffness * own.positions + damping * rates)


def _row(found: SimulatedScene) -> dict[str, Array]:
    """What is kept of every step."""
    model, data = found.model, found.data
    row = {"loads": np.r_[data.xpos[found.load], data.xquat[found.load]]}
    for name, parts in found.agents.items():
        damping = -model.actuator_biasprm[parts.actuators, 2]
        late = model.opt.timestep * damping * data.qacc[parts.rates]
        row[f"{name}.roots"] = np.r_[data.xpos[parts.root], data.xquat[parts.root]]
        row[f"{name}.positions"] = data.qpos[parts.positions]
        row[f"{name}.torques"] = data.actuator_force[parts.actuators] - late
        row[f"{name}.soles"] = np.array([found.sole_origin(sole) for sole in parts.soles.values()])
    return row


def _frame(found: SimulatedScene) -> dict[str, Array]:
    """What is kept of every frame."""
    frame = {"states": np.array(found.data.qpos)}
    for name, parts in found.agents.items():
        frame[f"{name}.feet"] = foot_wrenches(found, parts)
        frame[f"{name}.hands"] = hand_wrenches(found, parts)
    return frame


def _fell(found: SimulatedScene, plan: Plan, name: str, place: int) -> bool:
    parts = found.agents[name]
    planned = parts.agent.turn @ plan.agents[name].bases[place]
    return not np.linalg.norm(found.data.xpos[parts.root] - planned) < FALLEN


def _collected(
    found: SimulatedScene,
    plan: Plan,
    rows: list[dict[str, Array]],
    frames: list[dict[str, Array]],
    every: int,
    fallen: tuple[str, ...],
) -> Rollout:
    kept = {key: np.array([each[key] for each in part]) for part in (rows, frames) for key in part[0]}
    agents = {}
    for name, parts in found.agents.items():
        limited = found.model.actuator_forcelimited[parts.actuators].astype(bool)
        limits = np.where(limited, found.model.actuator_forcerange[parts.actuators, 1], np.inf)
        keys = ("roots", "positions", "torques", "soles", "feet", "hands")
        agents[name] = AgentRollout(limits=limits, **{key: kept[f"{name}.{key}"] for key in keys})
    return Rollout(
        times=plan.times[: len(rows)],
        loads=kept["loads"],
        agents=agents,
        fallen=fallen,
        frames=tuple(range(0, len(rows), every)),
        states=kept["states"],
        model=found.model,
    )
