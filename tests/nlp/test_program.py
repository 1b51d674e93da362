"""Programs are solved in SI units whatever the scales, and failures have a status."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

from evodesign.nlp.method import SolverOptions
from evodesign.nlp.program import ConstraintBlock, Program, Variable
from evodesign.nlp.solver import Solver
from evodesign.records import Status


def rosenbrock(scale: float, bound: float) -> Program:
    x = Variable.column("x", [-5.0, -5.0], [5.0, 5.0], [-1.2, 1.0], scale)
    a, b = x.value[0], x.value[1]
    weight = ca.SX.sym("weight")
    return Program(
        "rosenbrock",
        (x,),
        (ConstraintBlock("disc", ca.sumsqr(x.value), -np.inf, bound),),
        (1.0 - a) ** 2 + weight * (b - a**2) ** 2,
        {"weight": weight},
    )


@pytest.mark.parametrize("scale", [1.0, 10.0])
def test_minimum_does_not_depend_on_the_scale(scale: float) -> None:
    solver = Solver(rosenbrock(scale, 10.0), SolverOptions())
    solution = solver.solve({"weight": 100.0}, solver.start)
    assert solution.status is Status.SOLVED
    assert np.allclose(solution.values["x"], 1.0, atol=1e-5)


def test_iteration_limit_is_a_status() -> None:
    solver = Solver(rosenbrock(1.0, 10.0), SolverOptions(iterations=2))
    assert solver.solve({"weight": 100.0}, solver.start).status is Status.ITERATION_LIMIT


def test_contradiction_is_infeasible() -> None:
    solver = Solver(rosenbrock(1.0, -1.0), SolverOptions())
    assert solver.solve({"weight": 100.0}, solver.start).status is Status.INFEASIBLE


def test_time_limit_is_a_status() -> None:
    solver = Solver(rosenbrock(1.0, 10.0), SolverOptions(seconds=1e-9))
    assert solver.solve({"weight": 100.0}, solver.start).status is Status.TIME_LIMIT


def test_starts_outside_the_bounds_are_moved_inside() -> None:
    block = Variable.column("x", [0.0, 0.0], [1.0, 1.0], [-3.0, 3.0], 1.0)
    assert block.start.tolist() == [0.0, 1.0]
