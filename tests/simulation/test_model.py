"""The model that is simulated, against pinocchio and the postures that evodesign finds without it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import mujoco
import numpy as np
import pinocchio as pin
import pytest

from evodesign.hardware.actuators import actuator_law
from evodesign.mechanics.agent import SIDES
from evodesign.mechanics.payload import Grasp
from evodesign.simulation.feedback import joint_inertias
from evodesign.simulation.model import SimulatedScene, simulated_scene
from evodesign.tree.equip import with_actuators
from tests.simulation.conftest import HEIGHT, Held

AGENTS = ("robot", "human")


def bodies_of(found: SimulatedScene, who: str) -> list[int]:
    root = found.agents[who].root
    return [body for body in range(found.model.nbody) if found.model.body_rootid[body] == root]


@pytest.mark.parametrize("who", AGENTS)
def test_mass_centre_and_inertia_are_pinocchios(held: Held, who: str) -> None:
    found, model = held.simulated(), held.models[who]
    state = model.at(held.solution.postures[who])
    body = model.body.model
    data = body.createData()
    pin.ccrba(body, data, state.coordinates, np.zeros(body.nv))
    sign = np.diag(model.agent.turn)
    root = found.agents[who].root
    assert found.model.body_subtreemass[root] == pytest.approx(data.Ig.mass, rel=1e-12)
    center = found.data.subtree_com[root]
    assert center == pytest.approx(sign * data.com[0], abs=1e-9)
    inertia = np.zeros((3, 3))
    for number in bodies_of(found, who):
        turn = found.data.ximat[number].reshape(3, 3)
        lever = pin.skew(found.data.xipos[number] - center)
        inertia += turn @ np.diag(found.model.body_inertia[number]) @ turn.T
        inertia -= found.model.body_mass[number] * lever @ lever
    assert inertia == pytest.approx(np.outer(sign, sign) * np.array(data.Ig.inertia), abs=1e-8)


@pytest.mark.parametrize("grasp", Grasp)
def test_inverse_dynamics_asks_for_the_planned_torques_and_leaves_the_load_in_balance(
    held_with: Callable[[Grasp], Held], grasp: Grasp
) -> None:
    held = held_with(grasp)
    found = held.simulated()
    model, data = found.model, found.data
    flags = mujoco.mjtDisableBit
    model.opt.disableflags |= flags.mjDSBL_CONTACT | flags.mjDSBL_LIMIT | flags.mjDSBL_EQUALITY
    data.qacc[:] = 0.0
    mujoco.mj_inverse(model, data)
    passed = np.zeros(model.nv)
    for name, parts in found.agents.items():
        posture = held.solution.postures[name]
        sign = np.diag(parts.agent.turn)
        for side in SIDES:
            hand, sole = parts.hands[f"{side}_hand"], parts.soles[f"{side}_foot"]
            force, moment = (sign * part for part in np.split(posture.wrenches[f"{side}_hand"], 2))
            point = data.site_xpos[hand]
            mujoco.mj_applyFT(model, data, force, moment, point, model.site_bodyid[hand], passed)
            mujoco.mj_applyFT(model, data, -force, -moment, point, found.load, passed)
            turn = data.geom_xmat[sole].reshape(3, 3)
            force, moment = (turn @ part for part in np.split(posture.wrenches[f"{side}_foot"], 2))
            origin, body = found.sole_origin(sole), model.geom_bodyid[sole]
            mujoco.mj_applyFT(model, data, force, moment, origin, body, passed)
    left = data.qfrc_inverse - passed
    for name, parts in found.agents.items():
        torques = [held.solution.postures[name].torques[joint] for joint in parts.agent.joints]
        assert left[parts.rates] == pytest.approx(torques, abs=1e-5)
        left[parts.rates] = 0.0
    assert left == pytest.approx(0.0, abs=1e-5)


def test_soles_are_on_the_floor_and_hands_on_the_load_and_nothing_else_touches(held: Held) -> None:
    found = held.simulated()
    model, data = found.model, found.data
    for name, parts in found.agents.items():
        for side in SIDES:
            assert found.sole_origin(parts.soles[f"{side}_foot"])[2] == pytest.approx(0.0, abs=1e-6)
            grip = data.site(f"{name}/{side}_hand_grip").xpos
            assert data.site_xpos[parts.hands[f"{side}_hand"]] == pytest.approx(grip, abs=1e-6)
    soles = {sole for parts in found.agents.values() for sole in parts.soles.values()}
    assert {int(geom) for contact in data.contact for geom in contact.geom} == {0, *soles}
    touching = {
        geom for geom in range(model.ngeom) if model.geom_contype[geom] or model.geom_conaffinity[geom]
    }
    assert touching == {0, *soles}
    assert {contact.friction[0] for contact in data.contact} == {held.scene.ground.friction}


def test_motors_have_the_limits_of_the_problem_or_of_actuators_and_their_inertia(held: Held) -> None:
    scene, law = held.scene, actuator_law()
    knee, elbow = law.at(30.0), "l_elbow"
    robot = replace(scene.robot, torque_limits={elbow: 7.0})
    trees = {**held.trees, "robot": with_actuators(scene.robot.tree, {"l_knee": knee})}
    found = simulated_scene(scene.with_agents(robot), trees, held.solution.postures, HEIGHT)

    def limit(joint: str) -> float:
        motor = found.model.actuator(f"robot/{joint}")
        return float(motor.forcerange[1]) if motor.forcelimited[0] else math.inf

    assert (limit("l_knee"), limit(elbow), limit("r_knee")) == (knee.peak, 7.0, math.inf)
    assert found.model.joint("robot/l_knee").armature[0] == pytest.approx(knee.inertia)
    assert found.model.joint("robot/r_knee").armature[0] == 0.0


@pytest.mark.parametrize(
    ("who", "joint", "moved"),
    [
        ("robot", "l_ankle_pitch", "above"),
        ("robot", "l_elbow", "beyond"),
        ("human", "jRightKnee_roty", "above"),
    ],
)
def test_a_joints_inertia_is_that_of_the_bodies_that_it_moves(
    held: Held, who: str, joint: str, moved: str
) -> None:
    """Summed over bodies by Steiner's theorem; both legs share what is above."""
    found = held.simulated()
    model, data, parts = found.model, found.data, found.agents[who]
    number = model.joint(f"{who}/{joint}").id
    first = int(model.jnt_bodyid[number])
    beyond = {body for body in bodies_of(found, who) if first in _up(model, body)}
    bodies = beyond if moved == "beyond" else set(bodies_of(found, who)) - beyond
    axis, anchor = data.xaxis[number], data.xanchor[number]
    inertia = 0.0
    for body in bodies:
        across = np.cross(axis, data.xipos[body] - anchor)
        turned = data.ximat[body].reshape(3, 3).T @ axis
        inertia += model.body_mass[body] * across @ across + turned @ (model.body_inertia[body] * turned)
    for side in SIDES:
        if (model.site_bodyid[parts.hands[f"{side}_hand"]] in beyond) == (moved == "beyond"):
            across = np.cross(axis, data.site_xpos[parts.hands[f"{side}_hand"]] - anchor)
            inertia += held.scene.payload.mass / 4.0 * across @ across
    shared = inertia / (1.0 if moved == "beyond" else 2.0)
    told = joint_inertias(found, parts)[parts.agent.joints.index(joint)]
    assert told == pytest.approx(shared, rel=1e-9)


def _up(model: mujoco.MjModel, body: int) -> list[int]:
    """A body and those that carry it."""
    found = [body]
    while found[-1]:
        found.append(int(model.body_parentid[found[-1]]))
    return found
