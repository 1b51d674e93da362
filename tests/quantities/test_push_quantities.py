"""Quantities of simulated pushes: what asks for them, which designs have them, and from which simulations."""

from __future__ import annotations

import tomllib
from dataclasses import replace
from typing import Any

import msgspec
import pytest

from evodesign.errors import InputError
from evodesign.evaluation.evaluate import Evaluator
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.shipped import SHIPPED
from evodesign.problem.source import source_of
from evodesign.quantities.push_quantities import SIMULATED
from evodesign.simulation.push_margin import FASTEST

PUSH = {"impulse_n_s": 6.0}


def built(**changes: Any) -> DesignProblem:
    tables = tomllib.loads((SHIPPED / "point_grasp.toml").read_text(encoding="utf-8"))
    tables["task"] = {"heights_m": [1.0]}
    tables["solver"] = {"start_portfolio": False, "compile": False, "method": "ipopt"}
    tables["objectives"] = {"minimise": ["robot_torque", "load_tracking"], "maximise": ["push_margin"]}
    tables |= {"push": PUSH, **changes}
    return build_problem(source_of({key: value for key, value in tables.items() if value is not None}))


@pytest.fixture(scope="module")
def evaluator() -> Evaluator:
    problem = built(constraints={"recovery_seconds": {"upper": 2.9}, "mass_kg": {"upper": 80.0}})
    return Evaluator(replace(problem, options=replace(problem.options, compiled=False)))


def test_a_feasible_design_is_pushed_and_one_that_breaks_a_bound_is_not(
    evaluator: Evaluator, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("evodesign.simulation.push_margin.RESOLUTION", 0.5)
    monkeypatch.setattr("evodesign.simulation.push_margin.DIRECTIONS", (0.0,))
    problem = evaluator.problem
    design = problem.space.unscaled(problem.scene.robot.tree)
    result = evaluator.solve(design)
    found = evaluator.assessment(design, result)
    mass = float(result.tree.mass)
    assert found.violation == 0.0
    assert PUSH["impulse_n_s"] / 2.0 < found.objectives["push_margin"] <= FASTEST * mass
    weakest = found.weakest_pushes["push_margin"]
    assert (weakest.moment, weakest.direction_deg) == ("1 m", 0.0)
    assert weakest.reason
    assert 0.0 < found.objectives["load_tracking"] < 0.1
    assert 0.0 < found.constraints["recovery_seconds"] < 2.9
    heavy = tuple(replace_bound(each, mass - 1.0) for each in problem.constraints)
    monkeypatch.setattr(evaluator, "problem", replace(problem, constraints=heavy))
    monkeypatch.setattr("evodesign.evaluation.pushes.found_pushes", lambda *_: pytest.fail("simulated"))
    missed = evaluator.assessment(design, result)
    assert missed.violation == pytest.approx(1.0 / (mass - 1.0))
    assert set(missed.objectives) == {"robot_torque"}
    assert set(missed.constraints) == {"mass"}


def replace_bound(constraint: Any, upper: float) -> Any:
    return msgspec.structs.replace(constraint, upper=upper) if constraint.name == "mass" else constraint


@pytest.mark.parametrize("name", SIMULATED)
def test_a_simulated_quantity_needs_a_push_table(name: str) -> None:
    asked = {"minimise": [name]}
    assert built(objectives=asked).pushes is not None
    with pytest.raises(InputError, match=rf"push: wanted a \[push\] for '{name}', found none"):
        built(objectives=asked, push=None)


def test_nothing_is_simulated_where_nothing_asks_for_it() -> None:
    assert built(objectives={"minimise": ["mass"]}).pushes is None
