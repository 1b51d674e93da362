"""A TIAGo with two arms, read from its file: it stands on its base and MuJoCo holds the posture."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from evodesign.control.gains import Feedback
from evodesign.evaluation.evaluate import Evaluator
from evodesign.evaluation.simulations import simulated_holds
from evodesign.guess.preflight import preflight
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.source import source_of
from evodesign.tree.urdf_write import urdf_text
from tests.robots import SHARED

pytestmark = pytest.mark.needs_robots

TIAGO = SHARED / "tiago_description" / "robots" / "tiago_dual.urdf"
SIZE = (0.40, 0.36)
G = 9.81


@pytest.fixture(scope="module")
def on_wheels() -> DesignProblem:
    arms = [f"arm_{side}_{number}_joint" for side in ("left", "right") for number in range(1, 8)]
    tables = {
        "name": "tiago-on-wheels",
        "robot": {
            "urdf": str(TIAGO),
            "meshes": False,
            "inertia": "file",
            "base": {"frame": "base_footprint", "size_m": SIZE},
            "hands": {"left": "hand_left_grasping_frame", "right": "hand_right_grasping_frame"},
            "trunk": ["base_link", "torso_lift_link"],
            "joints": arms,
        },
        "human": {"stature_m": 1.75, "mass_kg": 75.0, "sex": "male"},
        "payload": {"size_m": [0.5, 0.5, 0.1], "mass_kg": 4.0, "grasp": "rigid"},
        "task": {"heights_m": [0.9]},
        "objectives": {"minimise": ["robot_torque", "human_torque"], "maximise": ["reach_height"]},
        "design": {
            "length": [
                {
                    "name": "upper_arm",
                    "links": ["arm_left_3_link", "arm_right_3_link"],
                    "lower": 0.7,
                    "upper": 1.5,
                }
            ]
        },
        "solver": {"start_portfolio": False, "compile": False, "method": "ipopt"},
    }
    problem = build_problem(source_of(tables))
    return replace(problem, options=replace(problem.options, compiled=False))


def test_check_finds_it_on_its_wheels(on_wheels: DesignProblem) -> None:
    found = {finding.item: finding for finding in preflight(on_wheels)}
    assert [finding.fault for finding in found.values() if finding.fault] == []
    assert "above the ground" in found["stands on its wheels"].found


def test_it_holds_the_load_from_its_base(on_wheels: DesignProblem) -> None:
    """What the ground presses balances weight and load about the base, by pinocchio."""
    result = Evaluator(on_wheels).solve((1.0,))
    (solution,) = result.cases
    assert solution.solved, solution.reason
    posture, robot = solution.postures["robot"], on_wheels.scene.robot
    model = pin.buildModelFromXML(urdf_text(result.tree), pin.JointModelFreeFlyer())
    q = pin.neutral(model)
    q[:3], q[3:7] = posture.base_position, pin.Quaternion(pin.rpy.rpyToMatrix(*posture.base_angles)).coeffs()
    for name, angle in posture.joints.items():
        q[model.joints[model.getJointId(name)].idx_q] = angle
    data = model.createData()
    pin.framesForwardKinematics(model, data, q)
    base = data.oMf[model.getFrameId("base_footprint")]
    assert base.translation[2] == pytest.approx(0.0, abs=1e-5)
    center, weight = pin.centerOfMass(model, data, q), pin.computeTotalMass(model) * G
    force, moment = np.array([0.0, 0.0, -weight]), np.cross(center, [0.0, 0.0, -weight])
    for hand in robot.hands:
        place, wrench = data.oMf[model.getFrameId(hand.frame)].translation, posture.wrenches[hand.name]
        force += wrench[:3]
        moment += np.cross(place, wrench[:3]) + wrench[3:]
    ground = posture.wrenches["base"]
    pressed = base.rotation @ ground[:3]
    assert force + pressed == pytest.approx(0.0, abs=1e-3)
    assert moment + np.cross(base.translation, pressed) + base.rotation @ ground[3:] == pytest.approx(
        0.0, abs=1e-3
    )
    assert abs(ground[4]) <= SIZE[0] / 2.0 * ground[2] + 1e-4
    assert abs(ground[3]) <= SIZE[1] / 2.0 * ground[2] + 1e-4
    details = Evaluator(on_wheels).details(result)
    (held,) = simulated_holds(on_wheels.scenes, result.tree, details, 0.5, Feedback())
    assert not any(agent.fell for agent in held.outcome.agents.values())
