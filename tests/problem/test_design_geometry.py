"""Joints as design parameters, from a problem file to a search's numbers."""

from __future__ import annotations

import math
import tomllib
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from evodesign.errors import InputError
from evodesign.evaluation.evaluate import Evaluator
from evodesign.evaluation.gradients import assessed_gradients
from evodesign.evaluation.sensitivities import Sensitivities
from evodesign.posture.postures import PostureProblem
from evodesign.posture.results import CaseSolution
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.designs import designs_text, read_designs
from evodesign.problem.model_json import model_json
from evodesign.problem.shipped import SHIPPED
from evodesign.problem.source import source_of
from evodesign.tree.urdf_read import read_urdf
from evodesign.tree.urdf_write import urdf_text

HIP = {
    "name": "hip",
    "joints": ["l_hip_pitch", "r_hip_pitch"],
    "offset_m": [-0.02, 0.06],
    "along": [0.0, 1.0, 0.0],
    "tilt_deg": [-20.0, 20.0],
    "about": [0.0, 0.0, 1.0],
}
ELBOW = {"name": "elbow", "joints": ["l_elbow", "r_elbow"], "upper_deg": [40.0, 130.0]}


def tables(*joints: dict[str, Any]) -> dict[str, Any]:
    found = tomllib.loads((SHIPPED / "point_grasp.toml").read_text(encoding="utf-8"))
    found["design"] = {"length": found["design"]["length"][:2], "joint": [*joints]}
    found["task"]["heights_m"] = [1.0]
    found["search"].pop("start", None)
    found["solver"] = {"start_portfolio": False, "compile": False, "method": "ipopt"}
    return found


@pytest.fixture(scope="module")
def moved() -> DesignProblem:
    problem = build_problem(source_of(tables(HIP, ELBOW)))
    return replace(problem, options=replace(problem.options, compiled=False))


def test_a_file_has_them_beside_lengths(moved: DesignProblem) -> None:
    found = {parameter.name: parameter for parameter in moved.space.parameters}
    assert [*found] == ["length.upper_arm", "length.forearm", "offset.hip", "tilt.hip", "upper.elbow"]
    assert (found["tilt.hip"].lower, found["tilt.hip"].upper) == pytest.approx(
        (-0.349066, 0.349066), abs=1e-6
    )
    assert found["offset.hip"].record.unit == "m"
    unscaled = moved.space.unscaled(moved.scene.robot.tree)
    assert unscaled[2:4] == (0.0, 0.0)
    assert unscaled[4] == moved.scene.robot.tree.joint_by_name["l_elbow"].upper
    assert moved.start[0] == moved.space.genome(unscaled), "a search begins with the file's robot"
    shown = {each["name"]: each for each in model_json(moved)["parameters"]}
    assert shown["upper.elbow"]["joints"] == ["l_elbow", "r_elbow"]


def test_the_unscaled_robot_is_that_of_a_file_without_them(moved: DesignProblem) -> None:
    tree = moved.scene.robot.tree
    same = moved.space.resized(tree, moved.space.unscaled(tree))
    assert urdf_text(same) == urdf_text(tree)
    bare = build_problem(source_of(tables()))
    assert urdf_text(bare.scene.robot.tree) == urdf_text(tree)


def test_a_written_design_is_read_back(moved: DesignProblem) -> None:
    values = (1.1, 0.9, 0.03, 0.2, math.radians(100.0))
    tree = moved.space.resized(moved.scene.robot.tree, values)
    again = read_urdf(urdf_text(tree), "again", "file")
    for name in ("l_hip_pitch", "r_hip_pitch", "l_elbow"):
        written, read = tree.joint_by_name[name], again.joint_by_name[name]
        assert np.array(read.axis) == pytest.approx(np.array(written.axis), abs=1e-9)
        assert (read.lower, read.upper) == pytest.approx((written.lower, written.upper))


def test_postures_keep_to_the_limits_of_the_design(moved: DesignProblem) -> None:
    """With elbows that hardly bend the posture is another one, and costs more."""
    evaluator, unscaled = Evaluator(moved), moved.space.unscaled(moved.scene.robot.tree)
    norms = []
    for degrees in (130.0, 40.0):
        result = evaluator.solve((*unscaled[:4], math.radians(degrees)))
        (solution,) = result.cases
        assert solution.solved, solution.reason
        bent = max(abs(solution.postures["robot"].joints[name]) for name in ("l_elbow", "r_elbow"))
        assert bent <= math.radians(degrees) + 1e-6
        norms.append(solution.postures["robot"].torque_norm)
    assert norms[1] > 1.001 * norms[0]


STEP = 5e-4


def norm_beside(formulation: PostureProblem, values: tuple[float, ...], solution: CaseSolution) -> float:
    """The robot's torque norm of a neighbouring design, in the posture beside that of a solution [N m]."""
    near = formulation.followed(values, solution)
    assert near is not None
    return near.postures["robot"].torque_norm


def five_point(values: list[float]) -> float:
    """The derivative, from values at -2, -1, 1 and 2 steps."""
    return (8.0 * (values[2] - values[1]) - (values[3] - values[0])) / (12.0 * STEP)


def test_gradients_by_offset_tilt_and_limit_are_those_of_differences(moved: DesignProblem) -> None:
    evaluator = Evaluator(moved)
    values = (1.0, 1.0, 0.02, 0.1, math.radians(45.0))
    result = evaluator.solve(values)
    (solution,) = result.cases
    assert solution.solved, solution.reason
    found = assessed_gradients(
        moved, Sensitivities(moved, evaluator.known, evaluator.inner), values, result
    ).values["robot_torque"]
    formulation = evaluator.inner.postures[solution.case.pair]
    for place, parameter in enumerate(moved.space.parameters):
        norms = []
        for steps in (-2, -1, 1, 2):
            near = tuple(v + steps * STEP * (p == place) for p, v in enumerate(values))
            norms.append(norm_beside(formulation, near, solution))
        slope = five_point(norms) * (parameter.upper - parameter.lower)
        assert found[parameter.name] == pytest.approx(slope, rel=1e-6, abs=1e-6), parameter.name


@pytest.mark.parametrize(
    ("table", "key", "wanted"),
    [
        ({**HIP, "joints": ["l_hip_pitch", "no"]}, "design.joint[0].joints[1]", "moving joint"),
        ({**HIP, "joints": ["l_hip_pitch", "l_hip_pitch"]}, "design.joint[0].joints[1]", "another joint"),
        ({"name": "a", "joints": ["l_elbow"]}, "design.joint[0]", "offset_m, tilt_deg"),
        ({**HIP, "offset_m": [0.1, 0.1]}, "design.joint[0].offset_m", "a rising pair"),
        ({**HIP, "offset_m": [-2.0, 6.0]}, "design.joint[0].offset_m", "at most 0.5 m"),
        ({**HIP, "joints": ["l_hip_pitch", "r_knee"]}, "design.joint[0].joints[1]", "the mirror image of"),
        ({**ELBOW, "upper_deg": [60.0, 1300.0]}, "design.joint[0].upper_deg", "at most 360 degrees"),
        (
            {"name": "neck", "joints": ["neck_yaw"], "lower_deg": [-20.0, -10.0]},
            "design.joint[0].joints[0]",
            "a joint that moves in postures",
        ),
        ({**HIP, "tilt_deg": [-90.0, 0.0]}, "design.joint[0].tilt_deg", "at most 80 degrees"),
        ({k: v for k, v in HIP.items() if k != "along"}, "design.joint[0].along", "an axis"),
        ({k: v for k, v in HIP.items() if k != "offset_m"}, "design.joint[0].along", "offset_m with it"),
        ({**HIP, "along": [0.0, 0.0, 0.0]}, "design.joint[0].offset_m", "an axis of some length"),
        ({**ELBOW, "upper_deg": [-30.0, 130.0]}, "design.joint[0].upper_deg", "limits between which"),
    ],
)
def test_what_makes_no_sense_is_refused(table: dict[str, Any], key: str, wanted: str) -> None:
    with pytest.raises(InputError) as error:
        build_problem(source_of(tables(table)))
    assert error.value.key == key
    assert wanted in error.value.wanted


def test_two_parameters_for_one_thing_are_refused() -> None:
    with pytest.raises(InputError, match=r"one parameter for the offset of 'l_hip_pitch'"):
        build_problem(source_of(tables(HIP, {**HIP, "name": "again"})))


def test_one_joint_of_a_pair_is_refused_where_postures_are_symmetric() -> None:
    found = tables({**HIP, "joints": ["l_hip_pitch"]})
    found["solver"]["symmetry"] = "on"
    with pytest.raises(InputError, match="both joints of a pair"):
        build_problem(source_of(found))


def test_the_limit_of_a_knee_that_stays_bent_is_refused() -> None:
    found = tables({"name": "knee", "joints": ["l_knee", "r_knee"], "lower_deg": [-120.0, -90.0]})
    found["robot"]["knee_flexion_deg"] = 15.0
    with pytest.raises(InputError, match="wanted a joint that no least flexion keeps bent"):
        build_problem(source_of(found))


def test_designs_with_joints_are_written_and_read_back(moved: DesignProblem) -> None:
    tree, values = moved.scene.robot.tree, (1.1, 0.9, -0.0123, 0.1234, 1.7)
    text = designs_text("some", {"one": values}, moved.space, "a test")
    assert read_designs(text, "some.toml", moved.space, tree) == {"one": values}


THIGH = {"name": "thigh", "links": ["l_upper_leg", "r_upper_leg"], "lower": 0.7, "upper": 1.4}


def test_sections_are_parameters_with_gradients_of_their_own() -> None:
    """A thicker upper leg is heavier by the square, and torques move with it as solves of neighbours do."""
    found = tables()
    found["design"] = {"section": [THIGH]}
    problem = build_problem(source_of(found))
    problem = replace(problem, options=replace(problem.options, compiled=False))
    tree = problem.scene.robot.tree
    assert [parameter.name for parameter in problem.space.parameters] == ["section.thigh"]
    assert urdf_text(problem.space.resized(tree, (1.0,))) == urdf_text(tree)
    thick = problem.space.resized(tree, (1.2,))
    for name in THIGH["links"]:
        before, after = (float(each.link_by_name[name].mass) for each in (tree, thick))
        assert after == pytest.approx(1.44 * before, rel=1e-6)
    evaluator = Evaluator(problem)
    result = evaluator.solve((1.1,))
    (solution,) = result.cases
    assert solution.solved, solution.reason
    slopes = assessed_gradients(
        problem, Sensitivities(problem, evaluator.known, evaluator.inner), (1.1,), result
    ).values["robot_torque"]
    formulation = evaluator.inner.postures[solution.case.pair]
    norms = [norm_beside(formulation, (1.1 + steps * STEP,), solution) for steps in (-2, -1, 1, 2)]
    assert slopes["section.thigh"] == pytest.approx(0.7 * five_point(norms), rel=1e-6, abs=1e-6)


def test_a_section_along_one_axis_of_a_cylinder_is_refused() -> None:
    found = tables()
    found["design"] = {"section": [{**THIGH, "links": ["l_lower_leg"], "across": [1.0, 0.0, 0.0]}]}
    with pytest.raises(InputError, match="wanted boxes, for one axis alone") as error:
        build_problem(source_of(found))
    assert error.value.key == "design.section[0].across"
