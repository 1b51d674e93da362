"""Derivatives of solutions against closed forms, and the refusal where they do not exist."""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

from evodesign.nlp.method import SolverOptions
from evodesign.nlp.optimality import NotDifferentiable
from evodesign.nlp.program import ConstraintBlock, Program, Variable
from evodesign.nlp.sensitivity import Optimum, SolutionSensitivity
from evodesign.nlp.solver import Solver


def nearest_point() -> Program:
    """The point of the half-plane x + y <= 2 with x >= 0 that is nearest to (p, q)."""
    point = replace(Variable.column("point", [0.0, -9.0], [9.0, 9.0], [0.5, 0.5], 2.0), labels=("x", "y"))
    wanted = ca.SX.sym("wanted", 2)
    plane = ConstraintBlock("plane", point.value[0] + point.value[1], -np.inf, 2.0)
    return Program("nearest", (point,), (plane,), ca.sumsqr(point.value - wanted) / 2.0, {"wanted": wanted})


def optimum(program: Program, parameters: list[float]) -> Optimum | NotDifferentiable:
    given, solver = {"wanted": parameters}, Solver(program, SolverOptions())
    return SolutionSensitivity(solver).at(given, solver.solve(given, {}).values)


@pytest.mark.parametrize(
    ("wanted", "value", "slope"),
    [
        ([0.5, 0.5], [0.5, 0.5], [[1.0, 0.0], [0.0, 1.0]]),
        ([2.0, 1.0], [1.5, 0.5], [[0.5, -0.5], [-0.5, 0.5]]),
        ([-1.0, 0.5], [0.0, 0.5], [[0.0, 0.0], [0.0, 1.0]]),
        ([-1.0, 5.0], [0.0, 2.0], [[0.0, 0.0], [0.0, 0.0]]),
    ],
)
def test_nearest_point_follows_as_geometry_says(
    wanted: list[float], value: list[float], slope: list[list[float]]
) -> None:
    found = optimum(nearest_point(), wanted)
    assert isinstance(found, Optimum)
    assert found.values["point"] == pytest.approx(value, abs=1e-11)
    assert found.slopes["point"] == pytest.approx(np.array(slope), abs=1e-11)
    assert found.cost_slope == pytest.approx(np.array(wanted) - value, abs=1e-11)


def test_multipliers_of_the_parameters_are_the_gradient_of_the_optimal_cost() -> None:
    raw = Solver(nearest_point(), SolverOptions()).solve({"wanted": [2.0, 1.0]}, {})
    assert raw.cost_slope == pytest.approx([0.5, 0.5], abs=1e-6)


@pytest.mark.parametrize("wanted", [[0.0, 0.5], [1.5, 0.5]])
def test_there_is_no_derivative_just_at_a_limit(wanted: list[float]) -> None:
    found = optimum(nearest_point(), wanted)
    assert isinstance(found, NotDifferentiable)
    assert "just about to reach or to leave its limit" in found.reason


def test_margins_say_where_the_limits_change() -> None:
    """The plane is left when (p, q) has come down to it; x = 0 is reached when p is 2 less than q."""
    found = optimum(nearest_point(), [2.0, 1.0])
    assert isinstance(found, Optimum)
    limits = {(limit.name, limit.active): limit for limit in found.limits}
    plane = limits["plane", True]
    assert plane.margin == pytest.approx(0.5)
    assert plane.slope == pytest.approx([0.5, 0.5])
    x = min((x for x in found.limits if x.name == "point x"), key=lambda limit: limit.margin)
    assert x.margin == pytest.approx(1.5 / 2.0)  # in units of 2
    assert x.slope == pytest.approx([0.25, -0.25])


def test_what_has_no_cost_has_no_slope() -> None:
    pair = Variable.column("pair", [-9.0, -9.0], [9.0, 9.0], [0.1, 0.2], 1.0)
    wanted = ca.SX.sym("wanted")
    both = ConstraintBlock("both", pair.value[0] - 1.0, 0.0, 0.0)
    found = optimum(
        Program("flat", (pair,), (both,), (pair.value[0] - wanted) ** 2, {"wanted": wanted}), [0.5]
    )
    assert isinstance(found, Optimum)
    assert found.slopes["pair"][0] == pytest.approx([0.0])
    assert np.isnan(found.slopes["pair"][1]).all()


def test_limit_that_is_written_twice_has_no_unique_multipliers() -> None:
    x = Variable.column("x", [-9.0], [9.0], [0.0], 1.0)
    wanted = ca.SX.sym("wanted")
    twice = [ConstraintBlock(name, x.value, -np.inf, 1.0) for name in ("once", "again")]
    found = optimum(Program("twice", (x,), tuple(twice), (x.value - wanted) ** 2, {"wanted": wanted}), [3.0])
    assert isinstance(found, NotDifferentiable)
    assert "twice" in found.reason
