"""Gradients of objectives against differences of what a search would see, and against CasADi."""

from __future__ import annotations

import importlib.util
import sys
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import casadi as ca
import numpy as np
import pytest

from evodesign.evaluation.evaluate import Evaluator
from evodesign.evaluation.sensitivities import DesignDerivative, ObjectiveSensitivity, Sensitivities
from evodesign.mechanics.agent import HUMAN, ROBOT
from evodesign.mechanics.balance import center_of_mass
from evodesign.nlp.optimality import NotDifferentiable
from evodesign.posture.precompute.precomputed import Precomputed
from evodesign.problem.build import DesignProblem
from evodesign.quantities.objectives import objective_kinds
from evodesign.quantities.push_quantities import SIMULATED
from evodesign.records import Objective, Sense
from evodesign.tree.kinematics import Pose, forward

OBJECTIVES = {
    name: kind
    for name, kind in objective_kinds().items()
    if name not in ("bodies_apart", "parts_apart", "torque_margin", "cost", "energy")
    and not name.endswith("safety_factor")
    and "lift_seconds" not in name
    and name not in SIMULATED
}
"""Those that a robot without actuators has, which holds a load, without [collisions] and pushes."""


@pytest.fixture(scope="module")
def benchmark_module(repository: Path) -> Iterator[ModuleType]:
    """The benchmark that measures the same on more designs."""
    spec = importlib.util.spec_from_file_location("gradients", repository / "benchmarks" / "gradients.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(sys.modules, "gradients", module)  # its dataclasses look themselves up
        spec.loader.exec_module(module)
        yield module


@pytest.fixture(scope="module")
def wide(problem: DesignProblem) -> DesignProblem:
    """The point-grasp problem with every objective that there is, and limits that joints do not meet."""
    limits = dict.fromkeys(problem.scene.robot.joints, 30.0)
    robot = replace(problem.scene.robot, torque_limits=limits)
    scenes = tuple(scene.with_agents(robot) for scene in problem.scenes)
    every = [Objective(name=name, sense=Sense.MINIMISE, unit=kind.unit) for name, kind in OBJECTIVES.items()]
    return replace(problem, scenes=scenes, objectives=tuple(every))


@pytest.fixture(scope="module")
def derivative(wide: DesignProblem, known: Precomputed, evaluator: Evaluator) -> DesignDerivative:
    """Of a design whose agents do not lean on each other as far as they may, so that the person moves too."""
    values = wide.space.unscaled(wide.scene.robot.tree)
    found = replace(evaluator.solve(values), scenes=wide.scenes)
    result = replace(found, people_highest=9.0)  # higher than the robot reaches
    return Sensitivities(wide, known).at(values, result)


@pytest.fixture(scope="module")
def found(derivative: DesignDerivative) -> Mapping[str, ObjectiveSensitivity]:
    return derivative.sensitivities()


@pytest.mark.slow
def test_gradients_are_differences_of_what_a_search_sees(
    benchmark_module: ModuleType, problem: DesignProblem, known: Precomputed
) -> None:
    """From the seeds, along one direction of each design; the benchmark takes all directions."""
    comparer = benchmark_module.Comparer(problem, known)
    rng = np.random.default_rng(11)
    compared = 0
    for _ in range(6):
        values = problem.space.values(tuple(rng.uniform(size=len(problem.space.parameters)).tolist()))
        one = comparer.compare(values, [rng.standard_normal(len(values)).tolist()])
        if not one.left_out:
            compared += 1
            assert set(one.errors) == {"robot_torque", "human_torque", "reach_height"}
            assert max(one.errors.values()) < 1e-5
    assert compared >= 3


def test_every_objective_has_a_gradient(
    found: Mapping[str, ObjectiveSensitivity], wide: DesignProblem
) -> None:
    assert set(found) == set(OBJECTIVES)
    for sensitivity in found.values():
        assert sensitivity.gradient is not None
        assert list(sensitivity.gradient) == [parameter.name for parameter in wide.space.parameters]


def test_torque_gradients_follow_the_norm(
    derivative: DesignDerivative, found: Mapping[str, ObjectiveSensitivity]
) -> None:
    """d |tau| = tau . d tau / |tau|, paired joints counted twice."""
    for agent, name in ((ROBOT, "robot_torque"), (HUMAN, "human_torque")):
        slopes = []
        for part in derivative.cases:
            assert not isinstance(part, NotDifferentiable)
            form = next(form for form in part.forms if form.agent.name == agent)
            weighted = np.array(form.counts) * part.values[f"{agent}.torques"]
            norm = np.sqrt(weighted @ part.values[f"{agent}.torques"])
            slopes.append(weighted @ part.slopes[f"{agent}.torques"] / norm)
        expected = np.mean(slopes, axis=0)
        gradient = np.array(list((found[name].gradient or {}).values()))
        assert gradient == pytest.approx(expected, rel=1e-8, abs=1e-9 * np.abs(expected).max())


def test_closed_forms_of_the_design_have_casadis_derivatives(
    derivative: DesignDerivative, found: Mapping[str, ObjectiveSensitivity], wide: DesignProblem
) -> None:
    design = ca.SX.sym("design", len(wide.space.parameters))
    tree = wide.space.resized(wide.scene.robot.tree, ca.vertsplit(design))
    poses = forward(tree, Pose(ca.SX.eye(3), ca.SX.zeros(3)), {})
    mass, center = center_of_mass(tree, poses)
    above = center[2] - poses[wide.scene.robot.frame("left_foot")].position[2]
    both = ca.Function("both", [design], [ca.jacobian(mass, design), ca.jacobian(above, design)])
    for name, exact in zip(("mass", "com_height"), both(derivative.values), strict=True):
        expected = np.asarray(exact).ravel()
        gradient = np.array(list((found[name].gradient or {}).values()))
        assert gradient == pytest.approx(expected, rel=1e-8, abs=1e-9 * np.abs(expected).max())


def test_cost_of_robot_and_person_has_the_gradient_of_their_costs(
    derivative: DesignDerivative, wide: DesignProblem, known: Precomputed
) -> None:
    """The posture problem's cost is differenced along one direction."""
    tight = Evaluator(replace(wide, options=replace(wide.options, tolerance=1e-12)), known)
    ranges = np.array([parameter.upper - parameter.lower for parameter in wide.space.parameters])
    along = ranges * np.random.default_rng(2).standard_normal(len(ranges))
    costs = []
    for share in (-1e-4, 1e-4):
        result = tight.solve((np.array(derivative.values) + share * along).tolist())
        costs.append([min(attempt.cost for attempt in height.attempts) for height in result.cases])
    for part, before, after in zip(derivative.cases, *costs, strict=True):
        assert not isinstance(part, NotDifferentiable)
        assert (after - before) / 2e-4 == pytest.approx(part.cost_slope @ along, rel=1e-5)


def test_notes_name_the_start_that_won(found: Mapping[str, ObjectiveSensitivity]) -> None:
    for name in ("robot_torque", "worst_human_torque"):
        for height in ("0.8", "1", "1.2"):
            assert any(note.startswith(f"at {height} m: symmetric: start ") for note in found[name].notes)
    assert any(note.startswith("highest load: start ") for note in found["reach_height"].notes)
    assert found["mass"].notes == ()
