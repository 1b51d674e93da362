"""Crews of other shapes than one robot and one person: who holds the load, from which side.

Each posture is looked at in the world, by code that shares nothing with the programs: pinocchio places hands,
and weights and moments are added up by hand.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from evodesign.errors import ModelError
from evodesign.mechanics.agent import Agent
from evodesign.mechanics.disturbance import Disturbance, Disturbances
from evodesign.mechanics.payload import Grasp, Payload
from evodesign.mechanics.scene import Scene
from evodesign.posture.check import AgentModel, Checker
from evodesign.posture.formulations.base import Setting
from evodesign.posture.postures import PostureProblem, Symmetry
from evodesign.posture.results import AgentPosture, CaseSolution
from evodesign.posture.symmetry import symmetric_forms
from evodesign.problem.build import DesignProblem
from evodesign.tasks import Hold
from evodesign.tree.urdf_write import urdf_text

G, HEIGHT = 9.81, 1.0
TABLE = (0.8, 0.6, 0.05)
SIDES = {"left": 1.0, "right": -1.0}


def named(agent: Agent, name: str, quarters: int) -> Agent:
    return replace(agent, name=name, quarters=quarters)


def held_at_its_sides(payload: Payload, agent: Agent) -> Payload:
    """Hands beside the centre of mass, as somebody alone holds a box in points."""
    points = {(agent.name, hand.name): (0.0, 0.25 * SIDES[hand.side], 0.0) for hand in agent.hands}
    return replace(payload, grasp_points=points)


def crew(problem: DesignProblem, kind: str) -> Scene:
    scene = problem.scene
    robot, person = scene.agents
    table = replace(scene.payload, size=TABLE, grasp=Grasp.RIGID, hand_moment=5.0)
    if kind == "robot alone":
        return replace(scene.only(robot), payload=held_at_its_sides(scene.payload, robot))
    if kind == "person alone":
        person = replace(person, quarters=0)
        return replace(scene.only(person), payload=held_at_its_sides(scene.payload, person))
    if kind == "two people":
        return scene.only(named(person, "one", 0), named(person, "other", 2))
    if kind == "two robots":
        return replace(scene.only(robot, named(robot, "second", 2)), payload=table)
    if kind == "three sides":
        return replace(scene.only(robot, named(robot, "second", 1), person), payload=table)
    four = (robot, named(robot, "second", 1), person, named(person, "neighbour", 3))
    return replace(scene.only(*four), payload=table)


ALONE = ("robot alone", "person alone")
FACING = ("two people", "two robots")
WHOLE = (*ALONE, *FACING, "three sides")


def solved(problem: DesignProblem, scene: Scene, symmetry: Symmetry) -> CaseSolution:
    setting = Setting(scene, problem.space, problem.weights, problem.options)
    checker = Checker(scene, *(AgentModel.of(agent, agent.tree) for agent in scene.agents))
    design = problem.space.unscaled(problem.scene.robot.tree)
    return PostureProblem(setting, symmetry).solve(design, Hold(height_m=HEIGHT), checker)


def turned(agent: Agent) -> np.ndarray:
    angle = agent.quarters * math.pi / 2.0
    return np.array(
        [[math.cos(angle), -math.sin(angle), 0.0], [math.sin(angle), math.cos(angle), 0.0], [0.0, 0.0, 1.0]]
    )


def hands_in_world(agent: Agent, posture: AgentPosture) -> dict[str, np.ndarray]:
    """Where pinocchio puts the hands, by contact [m]."""
    model = pin.buildModelFromXML(urdf_text(agent.tree), pin.JointModelFreeFlyer())
    q = pin.neutral(model)
    turn = turned(agent) @ pin.rpy.rpyToMatrix(*posture.base_angles)
    q[:3], q[3:7] = turned(agent) @ posture.base_position, pin.Quaternion(turn).coeffs()
    for name, angle in posture.joints.items():
        joint = model.joints[model.getJointId(name)]
        q[joint.idx_q : joint.idx_q + joint.nq] = (
            angle if joint.nq == 1 else (math.cos(angle), math.sin(angle))
        )
    data = model.createData()
    pin.framesForwardKinematics(model, data, q)
    return {hand.name: data.oMf[model.getFrameId(hand.frame)].translation.copy() for hand in agent.hands}


@pytest.mark.parametrize(
    ("kind", "symmetry"),
    [
        *((kind, Symmetry.ON) for kind in ALONE + FACING),
        ("four sides", Symmetry.OFF),
        *(
            pytest.param(kind, Symmetry.OFF, marks=pytest.mark.slow)
            for kind in (*ALONE, *FACING, "three sides")
        ),
    ],
)
def test_every_crew_holds_the_load_in_the_world(
    problem: DesignProblem, kind: str, symmetry: Symmetry
) -> None:
    scene = crew(problem, kind)
    found = solved(problem, scene, symmetry)
    assert found.solved, found.reason
    assert max(found.residuals.values()) < 1e-5
    center, payload = np.array([0.0, 0.0, HEIGHT]), scene.payload
    force, moment = np.array([0.0, 0.0, -payload.mass * G]), np.zeros(3)
    below = 0.0
    for agent in scene.agents:
        posture, world = found.postures[agent.name], turned(agent)
        hands = hands_in_world(agent, posture)
        for name, place in hands.items():
            on_load = -world @ posture.wrenches[name][:3]
            force += on_load
            moment += np.cross(place - center, on_load) - world @ posture.wrenches[name][3:]
        middle = world.T @ np.mean(list(hands.values()), axis=0)
        edge = 0.0 if kind in ALONE else TABLE[agent.quarters % 2] / 2.0
        if kind != "two people":
            assert middle == pytest.approx([-edge, 0.0, middle[2]], abs=1e-5), "from the agent's own side"
        below += sum(posture.wrenches[foot.name][2] for foot in agent.feet)
    assert force == pytest.approx(0.0, abs=1e-4)
    assert moment == pytest.approx(0.0, abs=1e-4)
    weight = sum(float(agent.tree.mass) for agent in scene.agents) + payload.mass
    assert below == pytest.approx(weight * G, abs=1e-3)


def test_a_push_meets_whoever_stands_at_the_side(problem: DesignProblem) -> None:
    """In the world's axes: what the ground gives to all feet balances weights and the push."""
    pushed = Disturbance("pushed", push=(12.0, 7.0, 0.0), at="second")
    scene = replace(crew(problem, "three sides"), disturbances=Disturbances((pushed,)))
    found = solved(problem, scene, Symmetry.OFF)
    assert found.solved, found.reason
    force = np.array(pushed.push)
    for agent in scene.agents:
        posture, own = found.disturbed[pushed.name][agent.name], AgentModel.of(agent, agent.tree)
        state = own.at(found.postures[agent.name])
        for foot in agent.feet:
            force += turned(agent) @ state.pose(foot.frame)[0] @ posture.wrenches[foot.name][:3]
        force -= [0.0, 0.0, G * float(agent.tree.mass)]
    force -= [0.0, 0.0, G * scene.payload.mass]
    assert force == pytest.approx(0.0, abs=1e-3)


def test_two_of_one_kind_who_face_each_other_bear_the_same(problem: DesignProblem) -> None:
    found = solved(problem, crew(problem, "two robots"), Symmetry.ON)
    one, other = (posture.torque_norm for posture in found.postures.values())
    assert one == pytest.approx(other, rel=1e-4)


def test_nobody_at_the_side_is_a_half_of_a_symmetric_scene(problem: DesignProblem) -> None:
    with pytest.raises(ModelError, match="agents before and behind a symmetric load"):
        symmetric_forms(crew(problem, "three sides"))
