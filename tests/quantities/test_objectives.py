"""Objectives against their definitions, recomputed from a design's results."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from evodesign.design.walls import Wall
from evodesign.evaluation.evaluate import Evaluator
from evodesign.hardware.actuators import actuator_law
from evodesign.posture.results import CaseSolution
from evodesign.problem.build import DesignProblem
from evodesign.quantities.design_result import DesignResult
from evodesign.quantities.objectives import objective_kinds
from evodesign.quantities.push_quantities import SIMULATED
from evodesign.records import Status
from evodesign.tree.equip import WallOfLink, with_actuators, with_walls
from evodesign.tree.urdf_write import urdf_text

OBJECTIVES = objective_kinds()


@pytest.fixture(scope="module")
def result(problem: DesignProblem, evaluator: Evaluator) -> DesignResult:
    return evaluator.solve(problem.space.values(tuple(0.4 for _ in problem.space.parameters)))


def norms(result: DesignResult, agent: str) -> list[float]:
    return [
        float(np.sqrt(sum(t**2 for t in height.postures[agent].torques.values()))) for height in result.cases
    ]


@pytest.mark.parametrize("agent", ["robot", "human"])
def test_torques_are_mean_and_worst_norms(agent: str, result: DesignResult) -> None:
    assert OBJECTIVES[f"{agent}_torque"].value(result) == pytest.approx(sum(norms(result, agent)) / 3)
    assert OBJECTIVES[f"worst_{agent}_torque"].value(result) == pytest.approx(max(norms(result, agent)))


def test_mass_and_its_height_agree_with_pinocchio(result: DesignResult) -> None:
    model = pin.buildModelFromXML(urdf_text(result.tree), pin.JointModelFreeFlyer())
    data = model.createData()
    pin.framesForwardKinematics(model, data, pin.neutral(model))
    center = pin.centerOfMass(model, data, pin.neutral(model))
    sole = data.oMf[model.getFrameId("l_sole")].translation
    assert OBJECTIVES["mass"].value(result) == pytest.approx(pin.computeTotalMass(model))
    assert OBJECTIVES["com_height"].value(result) == pytest.approx(center[2] - sole[2])


def test_torques_of_a_design_that_misses_a_height_are_absent(result: DesignResult) -> None:
    missed = CaseSolution(result.cases[2].case, Status.INFEASIBLE, "out of reach")
    broken = replace(result, cases=(*result.cases[:2], missed))
    for name in ("robot_torque", "human_torque", "worst_robot_torque", "worst_human_torque"):
        assert OBJECTIVES[name].value(broken) is None
    assert OBJECTIVES["reach_height"].value(broken) == result.reach.highest


def limited(result: DesignResult) -> DesignResult:
    """The result of a robot whose joints have limits of 20 N m, and its elbows 8."""
    limits = {joint: 8.0 if joint.endswith("elbow") else 20.0 for joint in result.robot.joints}
    scenes = tuple(s.with_agents(replace(s.robot, torque_limits=limits)) for s in result.scenes)
    return replace(result, scenes=scenes)


def driven(result: DesignResult) -> DesignResult:
    """The result of a robot with actuators, which other quantities ask about."""
    actuators = dict.fromkeys(result.robot.joints, replace(actuator_law().at(20.0), price=100.0))
    walled = with_walls(result.tree, {"l_forearm": WallOfLink(0.002, 2700.0, 0.3)})
    walls = (Wall("arm", ("l_forearm",), 0.002, "aluminium_6061", 2700.0, 0.3),)
    tree = with_actuators(walled, actuators)
    return replace(result, tree=tree, space=replace(result.space, walls=walls))


def test_peak_torque_is_the_largest_share_of_a_joints_limit(result: DesignResult) -> None:
    shares = []
    for height in result.cases:
        torques = height.postures["robot"].torques
        elbows = [abs(torque) / 8.0 for name, torque in torques.items() if "elbow" in name]
        others = [abs(torque) / 20.0 for name, torque in torques.items() if "elbow" not in name]
        shares.append(max(elbows + others))
    assert OBJECTIVES["peak_torque"].value(limited(result)) == pytest.approx(sum(shares) / 3)
    assert OBJECTIVES["worst_peak_torque"].value(limited(result)) == pytest.approx(max(shares))


def test_every_objective_has_a_unit_and_a_value(result: DesignResult) -> None:
    """Only what needs [collisions], a life, a lift (tests/evaluation/test_lifts.py) or [push] is none."""
    known = driven(replace(limited(result), people_highest=1.9))
    assert all(kind.unit for kind in OBJECTIVES.values())
    assert [name for name, kind in OBJECTIVES.items() if kind.value(known) is None] == [
        "bodies_apart",
        "parts_apart",
        "fatigue_safety_factor",
        "energy",
        "lift_seconds",
        "worst_lift_seconds",
        *SIMULATED,
    ]
