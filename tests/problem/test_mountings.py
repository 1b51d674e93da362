"""Actuators that are bodies: where they sit, what they weigh there, and what becomes of a design."""

from __future__ import annotations

import tomllib
from dataclasses import replace
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from evodesign.body.placement import Placement
from evodesign.collision.parts import PART
from evodesign.errors import InputError
from evodesign.evaluation.bill import bill_of_materials
from evodesign.evaluation.evaluate import Evaluator
from evodesign.evaluation.gradients import assessed_gradients
from evodesign.evaluation.sensitivities import Sensitivities
from evodesign.hardware.actuators import actuator_law
from evodesign.mechanics.agent import ROBOT
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.shipped import SHIPPED
from evodesign.problem.source import source_of
from evodesign.tree.equip import actuators_of, mounted_solids
from evodesign.tree.frames import link_frames
from evodesign.violations import PARTS_APART


def tables() -> dict[str, Any]:
    found = tomllib.loads((SHIPPED / "icub_geometry.toml").read_text(encoding="utf-8"))
    found["task"]["heights_m"] = [1.0]
    found["solver"] = {"start_portfolio": False, "compile": False, "method": "ipopt"}
    return found


@pytest.fixture(scope="module")
def geometry() -> DesignProblem:
    return build_problem(source_of(tables()))


@pytest.fixture(scope="module")
def evaluator(geometry: DesignProblem) -> Evaluator:
    return Evaluator(replace(geometry, options=replace(geometry.options, compiled=False)))


def housing_places(problem: DesignProblem) -> dict[str, np.ndarray]:
    """From each joint to the middle of its actuator, in the robot's frame at zero [m]."""
    tree, space = problem.scene.designed_tree, problem.space
    values = space.unscaled(tree)
    actuators = space.actuators(space.given(values, {}))
    frames, found = link_frames(tree, Placement(), {}), {}
    names = [joint.name for joint in tree.joints if joint.name in actuators]
    for name, (link, solid) in zip(names, mounted_solids(tree, actuators), strict=True):
        place = frames[link] @ solid.link_from_solid
        joint = frames[tree.joint_by_name[name].child]
        found[name] = np.array(place.translation, float) - np.array(joint.translation, float)
    return found


def test_offset_actuators_sit_away_from_what_they_move_and_inline_ones_in_the_joint(
    geometry: DesignProblem,
) -> None:
    """Legs hang outside of the hips' joints, so these actuators sit inside; roll axes point ahead: behind."""
    found = housing_places(geometry)
    half = actuator_law().at(1.4142135623730951 * 10.0).size[1] / 2.0
    assert half > 0.0
    assert found["l_hip_pitch"][1] < -0.01
    assert found["r_hip_pitch"] == pytest.approx(found["l_hip_pitch"] * [1.0, -1.0, 1.0], abs=1e-6)
    assert found["l_hip_roll"][0] < -0.01
    assert found["r_hip_roll"] == pytest.approx(found["l_hip_roll"] * [1.0, -1.0, 1.0], abs=1e-6)
    for name in ("l_knee", "torso_pitch", "r_shoulder_yaw"):
        assert found[name] == pytest.approx(np.zeros(3), abs=1e-12)


def test_an_offset_joint_that_moves_what_is_on_neither_side_is_refused() -> None:
    text = tables()
    text["design"]["actuator"][4]["mount"] = "offset"  # of the torso, whose pitch axis is in the middle
    with pytest.raises(InputError) as refused:
        build_problem(source_of(text))
    assert "design.actuator[4].mount: wanted 'inline' of 'torso_pitch'" in str(refused.value)


def test_a_housing_has_the_mass_and_the_moments_of_its_cylinder(geometry: DesignProblem) -> None:
    """Beside pinocchio, in the frame of the link, with a tilted axis among them."""
    space, tree = geometry.space, geometry.scene.designed_tree
    values = space.values((0.8,) * len(space.parameters))
    given = space.given(values, {})
    resized, tilted = space.resized(tree, given), False
    for joint in resized.joints:
        actuator = joint.actuator
        if actuator is None or actuator.mounting is None:
            continue
        (solid,) = [
            solid for link, solid in mounted_solids(resized, {joint.name: actuator}) if link == joint.parent
        ]
        diameter, length = map(float, actuator.size)
        axis = np.array(joint.parent_from_child.rotation, float) @ np.array(joint.axis, float)
        place = np.array(joint.parent_from_child.translation, float) + actuator.mounting.share * length * axis
        turn = pin.Quaternion.FromTwoVectors(np.array([0.0, 0.0, 1.0]), axis).matrix()
        wanted = pin.SE3(turn, place).act(
            pin.Inertia.FromCylinder(float(actuator.mass), diameter / 2.0, length)
        )
        assert float(solid.inertia.mass) == pytest.approx(wanted.mass, rel=1e-12)
        assert np.array(solid.inertia.center, float) == pytest.approx(wanted.lever, abs=1e-12)
        assert np.array(solid.inertia.about_center, float) == pytest.approx(wanted.inertia, abs=1e-12)
        tilted = tilted or 0.05 < np.sort(np.abs(axis))[1] < 0.95
    assert tilted


@pytest.mark.slow
def test_sizes_are_margins_times_what_is_asked_with_the_housings_where_they_are(
    geometry: DesignProblem, evaluator: Evaluator
) -> None:
    space = geometry.space
    values = space.values((0.6,) * len(space.parameters))
    result = evaluator.solve(values)
    assert all(case.solved for case in result.cases)
    assert result.standing is not None
    alone = result.standing.needed(result.tree)
    assert not isinstance(alone, str)
    ratio = float(actuator_law().peak(1.0))
    lifted = [case.postures[ROBOT].torques for case in result.cases]
    for place in space.margins:
        parameter, margin = space.parameters[place], values[place]
        asked = max(
            max(max(abs(torques.get(joint, 0.0)) for torques in lifted) for joint in parameter.joints),
            max(max(torques[joint] / ratio for torques in alone) for joint in parameter.joints),
        )
        rated = float(actuators_of(result.tree)[parameter.joints[0]].rated)
        assert rated == pytest.approx(max(1.0, margin * asked), rel=3e-4)


@pytest.mark.slow
def test_parts_that_lack_room_are_a_violation_with_two_names_and_a_gradient(
    geometry: DesignProblem, evaluator: Evaluator
) -> None:
    space = geometry.space
    assert PARTS_APART in {constraint.name for constraint in geometry.constraints}
    values = list(space.unscaled(geometry.scene.designed_tree))
    result = evaluator.solve(values)
    assessed = evaluator.assessment(values, result)
    constrained = dict(assessed.constraints)  # type: ignore[call-overload]
    assert constrained[PARTS_APART] < -0.05
    assert assessed.violation == pytest.approx(-constrained[PARTS_APART])
    bill = bill_of_materials(geometry, result.tree, evaluator.details(result))
    assert bill["least_clearance"]["clearance_m"] < -0.01
    assert bill["least_clearance"]["parts"][0].startswith(PART)
    sensitivities = Sensitivities(evaluator.problem, evaluator.known, evaluator.inner)
    found = assessed_gradients(evaluator.problem, sensitivities, values, result).values[PARTS_APART]
    names = [parameter.name for parameter in space.parameters]
    for name in ("offset.waist", "offset.elbow", "section.shoulder", "offset.hip_width"):
        place = names.index(name)
        span = space.parameters[place].upper - space.parameters[place].lower

        def apart(share: float, place: int = place, span: float = span) -> float:
            beside = [*values]
            beside[place] += share * span
            return float(dict(evaluator.assess_values(beside).assessment.constraints)[PARTS_APART])  # type: ignore[call-overload]

        step = 5e-3  # sizes settle within 1e-4 of themselves, which moves the differences by up to 1e-3
        differences = (apart(step) - apart(-step)) / (2.0 * step)
        assert found[name] == pytest.approx(differences, rel=1e-2, abs=1e-3)
        assert abs(found[name]) > 1e-2
