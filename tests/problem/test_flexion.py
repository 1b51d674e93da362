"""Knees and elbows that stay bent: angles between segments by pinocchio, postures, and what is refused."""

from __future__ import annotations

import math
from dataclasses import replace

import msgspec
import numpy as np
import pinocchio as pin
import pytest

from evodesign.errors import InputError
from evodesign.evaluation.evaluate import Evaluator
from evodesign.mechanics.agent import ROBOT
from evodesign.posture.symmetry import symmetric_forms
from evodesign.posture.terms.floating_base import joint_ranges
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.flexion import bent_ranges
from evodesign.tree.urdf_read import InertiaRule, read_urdf
from tests.robots import HUMANOIDS

LEGS = {
    "icub": ("l_hip_pitch", "l_knee", "l_ankle_pitch"),
    "g1": ("left_hip_pitch_joint", "left_knee_joint", "left_ankle_pitch_joint"),
    "talos": ("leg_left_3_joint", "leg_left_4_joint", "leg_left_5_joint"),
}


def with_key(problem: DesignProblem, key: str) -> DesignProblem:
    """The problem with a key of its robot, solved from fixed starts."""
    text = problem.source.text.replace("[robot]\n", f"[robot]\n{key}\n", 1) + SOLVER
    return build_problem(msgspec.structs.replace(problem.source, text=text))


SOLVER = "\n[solver]\nstart_portfolio = false\ncompile = false\n"


def angle(urdf: str, positions: dict[str, float], names: tuple[str, str, str]) -> float:
    """Between two segments of a leg from the side [deg]; all axes of these joints are across it."""
    model = pin.buildModelFromXML(urdf)
    data, q = model.createData(), pin.neutral(model)
    for name, value in positions.items():
        q[model.joints[model.getJointId(name)].idx_q] = value
    pin.forwardKinematics(model, data, q)
    hip, knee, ankle = (data.oMi[model.getJointId(name)].translation[[0, 2]] for name in names)
    thigh, shank = knee - hip, ankle - knee
    cosine = thigh @ shank / np.linalg.norm(thigh) / np.linalg.norm(shank)
    return math.degrees(math.acos(min(1.0, cosine)))


def test_knees_of_the_icub_are_bent_by_the_angle_asked_for(problem: DesignProblem) -> None:
    bent = with_key(problem, "knee_flexion_deg = 15.0")
    robot, (urdf,) = (
        bent.scene.robot,
        (text for name, text in bent.source.files.items() if name.endswith(".urdf")),
    )
    ranges = robot.bent_ranges
    assert sorted(ranges) == ["l_knee", "r_knee"]
    assert ranges["l_knee"] == pytest.approx(ranges["r_knee"])
    least = ranges["l_knee"][1]
    assert angle(urdf, {"l_knee": least}, LEGS["icub"]) == pytest.approx(15.0, abs=1e-6)
    assert angle(urdf, {"l_knee": least - 0.1}, LEGS["icub"]) > 15.0
    form = symmetric_forms(bent.scene)[0]
    assert dict(zip(form.joints, joint_ranges(form), strict=True))["l_knee"] == ranges["l_knee"]
    assert robot.tree.joint_by_name["l_knee"].upper > least, "the file's limits stay"


@pytest.mark.needs_robots
@pytest.mark.parametrize(("name", "feet"), [("g1", "{}_ankle_roll_link"), ("talos", "leg_{}_6_link")])
def test_knees_of_other_robots_are_found_by_geometry(problem: DesignProblem, name: str, feet: str) -> None:
    text = HUMANOIDS[name].read_text()
    tree = read_urdf(text, name, InertiaRule.FILE)
    robot = problem.scene.robot
    soles = tuple(replace(foot, frame=feet.format(foot.side)) for foot in robot.feet)
    agent = replace(robot, tree=tree, joints=tree.actuated, contacts=(*soles, *robot.hands))
    ranges = bent_ranges(agent, soles, math.radians(20.0), "robot.knee_flexion_deg", problem.source)
    hip, knee, ankle = LEGS[name]
    assert sorted(ranges) == sorted([knee, knee.replace("left", "right")])
    joint, (lower, upper) = tree.joint_by_name[knee], ranges[knee]
    assert (joint.lower < lower) != (upper < joint.upper), "one end moved"
    assert angle(text, {knee: lower if joint.lower < lower else upper}, (hip, knee, ankle)) == pytest.approx(
        20.0
    )
    assert upper - lower > math.radians(90.0)


def test_elbows_stay_bent_too(problem: DesignProblem) -> None:
    ranges = with_key(problem, "elbow_flexion_deg = 20.0").scene.robot.bent_ranges
    assert sorted(ranges) == ["l_elbow", "r_elbow"]
    known = problem.scene.robot.tree.joint_by_name["l_elbow"]
    assert ranges["l_elbow"][1] == known.upper
    assert ranges["l_elbow"][0] == pytest.approx(math.radians(20.0), abs=math.radians(15.0))


def test_postures_keep_their_knees_bent_and_the_limit_has_a_price(problem: DesignProblem) -> None:
    bent = with_key(problem, "knee_flexion_deg = 15.0")
    evaluator = Evaluator(bent)
    result = evaluator.solve(bent.space.unscaled(bent.scene.robot.tree))
    (urdf,) = (text for name, text in bent.source.files.items() if name.endswith(".urdf"))
    assert result.cases[0].solved
    for case in result.cases:
        joints = case.instants[0].postures[ROBOT].joints
        assert angle(urdf, {"l_knee": joints["l_knee"]}, LEGS["icub"]) > 15.0 - 1e-4
    limits = [limit for detail in evaluator.details(result) for limit in detail.limits]
    assert any(limit.name == "flexion" and "knee" in limit.part for limit in limits)


def test_more_flexion_than_a_knee_has_is_refused(problem: DesignProblem) -> None:
    words = r"wanted at most what the left limb .* bends, found 90, and 'l_knee' from -70 to 5 deg"
    with pytest.raises(InputError, match=f"robot.knee_flexion_deg: {words}"):
        with_key(problem, "knee_flexion_deg = 90.0")
