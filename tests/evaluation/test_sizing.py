"""Actuators sized by what is asked of them: the fixed point, what governs it, and its gradients."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pytest

from evodesign.design.parameter import DesignParameter, ParameterKind
from evodesign.design.space import DesignSpace
from evodesign.evaluation import sizing
from evodesign.evaluation.design_solver import _OneDesign
from evodesign.evaluation.evaluate import Evaluator
from evodesign.evaluation.gradients import assessed_gradients
from evodesign.evaluation.sensitivities import Sensitivities
from evodesign.evaluation.sizing import BOUNDS
from evodesign.hardware.actuators import actuator_law
from evodesign.hardware.catalogue import Gear, catalogue
from evodesign.mechanics.agent import ROBOT
from evodesign.mechanics.stance_case import StanceCase
from evodesign.posture.precompute.precomputed import Precomputed
from evodesign.posture.results import CaseSolution
from evodesign.problem.build import DesignProblem
from evodesign.quantities.design_result import DesignResult
from evodesign.quantities.objectives import objective_kinds
from evodesign.records import Hold, Objective, Sense, Status
from evodesign.tree.equip import actuators_of, rated_torques

GROUPS = {
    "shoulder": tuple(f"{s}_shoulder_{axis}" for axis in ("pitch", "roll", "yaw") for s in "lr"),
    "elbow": ("l_elbow", "r_elbow"),
    "knee": ("l_knee", "r_knee"),
}
SQUAT = StanceCase(
    "squat",
    {f"{s}_{joint}": math.radians(a) for joint, a in (("knee", -45.0), ("hip_pitch", 35.0)) for s in "lr"},
    ("l_sole", "r_sole"),
    (("l_ankle_pitch", "r_ankle_pitch"),),
    2.0,
)
NAMES = ("mass", "holding_power", "robot_torque", "actuator_mass", "torque_margin")
DESIGN = (1.0, 1.1, 2.0, 3.0, 1.5)


@pytest.fixture(scope="module")
def sized(problem: DesignProblem) -> DesignProblem:
    """The point-grasp problem at one height with margins of three groups."""
    margins = [
        DesignParameter(ParameterKind.MARGIN, name, (), 1.0, 8.0, joints=joints)
        for name, joints in GROUPS.items()
    ]
    objectives = [Objective(name, Sense.MINIMISE, objective_kinds()[name].unit) for name in NAMES]
    return replace(
        problem,
        space=DesignSpace((*problem.space.parameters[:2], *margins)),
        tasks=(Hold(height_m=1.0),),
        objectives=tuple(objectives),
        stances=(SQUAT,),
        options=replace(problem.options, tolerance=1e-11),
    )


@pytest.fixture(scope="module")
def inner(sized: DesignProblem, known: Precomputed) -> Evaluator:
    return Evaluator(sized, known)


@pytest.fixture(scope="module")
def result(inner: Evaluator) -> DesignResult:
    return inner.solve(DESIGN)


def test_every_actuator_is_its_margin_times_what_is_asked_of_it(result: DesignResult) -> None:
    assert result.cases[0].solved
    torques = result.cases[0].postures[ROBOT].torques
    assert result.standing is not None
    ((_, squat),) = result.standing.torques(result.tree)
    ratio = actuator_law().peak(1.0)
    for (name, joints), margin in zip(GROUPS.items(), DESIGN[2:], strict=True):
        asked = max(max(abs(torques[joint]), 2.0 * abs(squat.torques[joint]) / ratio) for joint in joints)
        rated = [actuators_of(result.tree)[joint].rated for joint in joints]
        assert rated == pytest.approx([margin * asked] * len(joints), rel=1e-4), name
    assert result.values == DESIGN
    assert result.rated[:2] == DESIGN[:2]


def test_a_group_with_another_gear_is_sized_and_weighed_by_its_law(
    sized: DesignProblem, known: Precomputed, result: DesignResult
) -> None:
    """Knees with strain wave drives: heavier, and larger for the squat, as their peak is nearer to rated."""
    parameters = (*sized.space.parameters[:-1], replace(sized.space.parameters[-1], gear=Gear.STRAIN_WAVE))
    other = Evaluator(replace(sized, space=DesignSpace(parameters)), known).solve(DESIGN)
    assert other.standing is not None
    ((_, squat),) = other.standing.torques(other.tree)
    law, usual = actuator_law("strain_wave"), actuator_law()
    knee, elbow = actuators_of(other.tree)["l_knee"], actuators_of(other.tree)["l_elbow"]
    asked = 2.0 * max(abs(squat.torques[joint]) for joint in GROUPS["knee"])
    assert knee.peak == pytest.approx(DESIGN[4] * asked, rel=1e-4)
    assert knee.rated == pytest.approx(float(knee.peak / law.peak(1.0)), rel=1e-12)
    assert knee.mass == pytest.approx(float(law.mass(knee.peak)), rel=1e-12)
    assert elbow.mass == pytest.approx(float(usual.mass(elbow.peak)), rel=1e-12)
    assert knee.rated > actuators_of(result.tree)["l_knee"].rated
    assert other.demand is not None
    heavier = dict(other.demand.sizes)
    heavier["margin.knee"] *= 1.05
    before, after = (other.demand.at(sizes)["margin.elbow"] for sizes in (other.demand.sizes, heavier))
    assert after == pytest.approx(before, rel=1e-9)


def test_legs_are_sized_by_the_squat_and_arms_by_the_lift(result: DesignResult) -> None:
    torques = result.cases[0].postures[ROBOT].torques
    assert result.standing is not None
    ((_, squat),) = result.standing.torques(result.tree)
    knee = actuators_of(result.tree)["l_knee"]
    assert abs(torques["l_knee"]) < 0.2 * knee.rated / DESIGN[4]
    assert knee.peak == pytest.approx(DESIGN[4] * 2.0 * abs(squat.torques["l_knee"]), rel=1e-4)
    assert actuators_of(result.tree)["l_elbow"].rated >= DESIGN[3] * abs(torques["l_elbow"]) * (1 - 1e-4)


def test_sized_actuators_bind_no_posture_and_the_margin_is_the_least_of_the_design(
    result: DesignResult,
) -> None:
    assert rated_torques(result.tree) == {}
    assert objective_kinds()["torque_margin"].value(result) == pytest.approx(min(DESIGN[2:]), rel=1e-4)


def test_predictions_are_first_order_in_the_masses_of_actuators(
    inner: Evaluator, result: DesignResult, sized: DesignProblem
) -> None:
    """Frozen postures: the torques of standing cases and arms by other actuators, solved anew."""
    assert result.standing is not None
    demand = result.demand
    assert demand is not None
    sizes = dict(demand.sizes)
    sizes["margin.elbow"] *= 1.05
    values = list(result.rated)
    values[3] *= 1.05
    tree = sized.space.resized(sized.scene.robot.tree, values)
    ((_, squat),) = result.standing.torques(tree)
    predicted = demand.at(sizes)["margin.knee"]
    assert predicted == pytest.approx(2 * abs(squat.torques["l_knee"]) / actuator_law().peak(1.0), rel=1e-5)


def test_rounds_begin_at_the_sizes_that_a_sketch_asks_for_and_end_where_they_do_without(
    inner: Evaluator, result: DesignResult, monkeypatch: pytest.MonkeyPatch
) -> None:
    begun: list[list[float]] = []
    sketches: list[tuple[CaseSolution, ...]] = []
    cases, sketched = _OneDesign.cases, _OneDesign.sketched

    def seen(design: _OneDesign, values: Sequence[float], *checked: Any) -> tuple[CaseSolution, ...]:
        if not checked:
            begun.append(list(values[2:]))
        return cases(design, values, *checked)

    def kept(design: _OneDesign, values: Sequence[float]) -> tuple[CaseSolution, ...]:
        sketches.append(sketched(design, values))
        return sketches[-1]

    monkeypatch.setattr(_OneDesign, "cases", seen)
    monkeypatch.setattr(_OneDesign, "sketched", kept)
    told = inner.solve(DESIGN)
    monkeypatch.setattr(_OneDesign, "sketched", lambda design, values: ())
    untold = inner.solve(DESIGN)
    ((case,),) = sketches
    arms = [abs(case.postures[ROBOT].torques[joint]) for joint in GROUPS["elbow"]]
    assert begun[0][1] == pytest.approx(DESIGN[3] * max(arms), rel=0.05)
    assert begun[1][1] != pytest.approx(begun[0][1], rel=0.05)
    assert told.rated == result.rated
    assert untold.rated == pytest.approx(told.rated, rel=1e-3)


def test_an_actuator_that_nothing_is_asked_of_is_the_smallest_that_is_made(
    inner: Evaluator, sized: DesignProblem
) -> None:
    alone = replace(sized, stances=())
    found = Evaluator(alone).solve((1.0, 1.0, 1.0, 1.0, 1.0))
    assert actuators_of(found.tree)["l_knee"].rated == BOUNDS[0]


def test_a_robot_that_cannot_stand_has_no_sizes_and_a_reason(sized: DesignProblem) -> None:
    fallen = replace(SQUAT, joints={f"{s}_{name}": -0.79 for s in "lr" for name in ("knee", "hip_pitch")})
    evaluator = Evaluator(replace(sized, stances=(fallen,)))
    found = evaluator.solve(DESIGN)
    assert found.cases[0].status is Status.INFEASIBLE
    assert "cannot stand as in 'squat'" in found.cases[0].reason
    assert evaluator.assessment(DESIGN, found).violation is None


def test_gradients_go_through_the_sizes(
    sized: DesignProblem, inner: Evaluator, result: DesignResult, monkeypatch: pytest.MonkeyPatch
) -> None:
    gradients = assessed_gradients(sized, Sensitivities(sized, inner=inner.inner), DESIGN, result).values
    exactly = partial(sizing.SizingRounds, tolerance=1e-10, rounds=12)
    monkeypatch.setattr(sizing, "SizingRounds", exactly)
    kinds = objective_kinds()
    for position, parameter in enumerate(sized.space.records):
        step = 1e-3 * DESIGN[position]
        results = []
        for sign in (-1, 1):
            moved = list(DESIGN)
            moved[position] += sign * step
            results.append(inner.solve(moved))
        for name in NAMES[:-1]:
            found = [kinds[name].value(each) for each in results]
            slope = (found[1] - found[0]) / (2 * step)
            wanted = slope * parameter.slope_at(DESIGN[position])
            scale = max(abs(kinds[name].value(result) or 0.0), abs(wanted))
            assert np.abs(gradients[name][parameter.name] - wanted) <= 1e-4 * scale, (name, parameter.name)


def test_with_a_fixed_margin_the_others_have_the_same_gradients_and_it_has_none(
    sized: DesignProblem, inner: Evaluator, result: DesignResult
) -> None:
    parameters = [*sized.space.parameters[:4], replace(sized.space.parameters[4], lower=1.5, upper=1.5)]
    fixed = replace(sized, space=DesignSpace(tuple(parameters)))
    bounded, found = (
        assessed_gradients(each, Sensitivities(each, inner=inner.inner), DESIGN, result)
        for each in (sized, fixed)
    )
    for name in NAMES[:-1]:
        wanted = {key: value for key, value in bounded.values[name].items() if key != "margin.knee"}
        assert found.values[name] == pytest.approx(wanted, rel=1e-9, abs=1e-12), name
    moved = Sensitivities(fixed, inner=inner.inner).at(DESIGN, result).sensitivities()["mass"].gradient
    assert moved is not None
    assert set(moved) == {each.name for each in fixed.space.records}


def test_no_actuator_is_sized_below_the_rows_of_the_law() -> None:
    assert BOUNDS[0] == min(row.rated_torque_n_m for row in catalogue().values() if row.in_default_law)
