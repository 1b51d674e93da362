"""Programs of repeated blocks, against the same program written at length."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

from evodesign.nlp.blocks import Block, Repeated
from evodesign.nlp.method import Ending, MethodName, SolverOptions
from evodesign.nlp.optimality import NotDifferentiable
from evodesign.nlp.repeated import RepeatedProgram

TIMES = 4
IMAGE = np.random.default_rng(1).normal(size=(2 * TIMES, 5))
OWN = np.linspace(1.0, 2.0, TIMES).reshape(TIMES, 1)
START, BOUNDS = np.full(5, 0.3), (np.full(5, -2.0), np.full(5, 2.0))


def cost_and_rows(seen: ca.SX, own: ca.SX, shared: ca.SX) -> tuple[ca.SX, ca.SX]:
    cost = own * ca.exp(0.3 * seen[0]) + (seen[1] - shared[0]) ** 2 + shared[1] * ca.cos(seen[0] * seen[1])
    return cost, ca.vertcat(seen[0] * seen[1] + shared[0], ca.sin(seen[1]))


METHODS = pytest.mark.parametrize("method", list(MethodName))


def program(method: MethodName = MethodName.IPOPT) -> RepeatedProgram:
    seen, own, shared = ca.SX.sym("y", 2), ca.SX.sym("p"), ca.SX.sym("s", 2)
    cost, rows = cost_and_rows(seen, own, shared)
    block = Block("toy", seen, own, shared, cost, rows, np.array([-1.0, -0.5]), np.array([1.5, np.inf]))
    options = SolverOptions(tolerance=1e-10, compiled=method is MethodName.NATIVE, method=method)
    return RepeatedProgram("toy", [Repeated(block, IMAGE, TIMES)], options)


def solved_at_length(shared: np.ndarray) -> tuple[float, np.ndarray]:
    x = ca.SX.sym("x", 5)
    seen = ca.reshape(ca.DM(IMAGE) @ x, 2, TIMES)
    said = [cost_and_rows(seen[:, k], ca.SX(OWN[k, 0]), ca.SX(shared)) for k in range(TIMES)]
    problem = {"x": x, "f": sum(cost for cost, _ in said), "g": ca.vertcat(*[rows for _, rows in said])}
    options = {"print_time": False, "ipopt": {"print_level": 0, "sb": "yes", "tol": 1e-10}}
    limits = {"lbg": [-1.0, -0.5] * TIMES, "ubg": [1.5, np.inf] * TIMES}
    found = ca.nlpsol("flat", "ipopt", problem, options)(x0=START, lbx=BOUNDS[0], ubx=BOUNDS[1], **limits)
    return float(found["f"]), np.array(found["x"]).ravel()


@METHODS
def test_blocks_have_the_optimum_of_the_program_at_length(method: MethodName) -> None:
    shared, solver = np.array([0.4, 0.2]), program(method)
    assert solver.method is method
    ending, _ = solver.solve(START, BOUNDS, shared, [OWN])
    cost, where = solved_at_length(shared)
    assert ending.word == "Solve_Succeeded"
    assert ending.cost == pytest.approx(cost, rel=1e-8)
    assert ending.symbols == pytest.approx(where, abs=1e-5)


@METHODS
def test_the_optimal_cost_changes_with_shared_numbers_as_told(method: MethodName) -> None:
    shared, step = np.array([0.4, 0.2]), 1e-4
    ending, _ = program(method).solve(START, BOUNDS, shared, [OWN])
    differences = [
        (solved_at_length(shared + step * e)[0] - solved_at_length(shared - step * e)[0]) / (2 * step)
        for e in np.eye(2)
    ]
    assert ending.cost_slope == pytest.approx(differences, rel=1e-4)


@METHODS
def test_variables_with_one_value_keep_it_and_tell_what_it_costs(method: MethodName) -> None:
    shared, place, step = np.array([0.4, 0.2]), 2, 1e-4

    def solved(value: float) -> Ending:
        held = np.where(np.arange(5) == place, value, START)
        lower, upper = (np.where(np.arange(5) == place, value, side) for side in BOUNDS)
        return program(method).solve(held, (lower, upper), shared, [OWN])[0]

    found = solved(0.7)
    assert found.symbols[place] == 0.7
    slope = (solved(0.7 + step).cost - solved(0.7 - step).cost) / (2.0 * step)
    assert -found.bounds[place] == pytest.approx(slope, rel=1e-4)


def test_blocks_of_several_kinds_are_solved_alike_by_both_methods() -> None:
    """Their patterns are sparse, and some of their symbols see several variables."""
    rng = np.random.default_rng(3)
    parts = []
    for number, times in enumerate((3, 5)):
        seen, own, shared = ca.SX.sym("y", 4), ca.SX.sym("p", number), ca.SX.sym("s")
        cost = ca.sumsqr(seen - shared) + ca.sin(seen[0]) * seen[3] + ca.sum1(own) * seen[1] ** 2
        rows = ca.vertcat(seen[0] * seen[2] + seen[1], seen[3] ** 2)
        block = Block(
            f"kind_{number}", seen, own, shared, cost, rows, np.array([0.1, -1.0]), np.array([0.1, 2.0])
        )
        image = rng.normal(size=(4 * times, 20)) * (rng.uniform(size=(4 * times, 20)) < 0.2)
        parts.append(Repeated(block, image, times))
    found = []
    for method in MethodName:
        options = SolverOptions(tolerance=1e-10, compiled=True, method=method)
        bounds = np.full(20, -3.0), np.full(20, 3.0)
        solver = RepeatedProgram("kinds", parts, options)
        own = [np.empty((3, 0)), np.linspace(0.0, 1.0, 5).reshape(5, 1)]
        found.append(solver.solve(np.full(20, 0.2), bounds, np.array([0.3]), own)[0])
    native, ipopt = found
    assert native.word == ipopt.word == "Solve_Succeeded"
    assert native.cost == pytest.approx(ipopt.cost, rel=1e-8)
    assert native.symbols == pytest.approx(ipopt.symbols, abs=1e-6)
    assert native.rows == pytest.approx(ipopt.rows, abs=1e-5)
    assert native.cost_slope == pytest.approx(ipopt.cost_slope, rel=1e-5)


def pushed(method: MethodName = MethodName.IPOPT) -> RepeatedProgram:
    """Min (x - s)^2 + (y + x)^2 with x at most 1 in each of two repetitions: x is s or 1, and y is -x."""
    seen, own, shared = ca.SX.sym("y", 2), ca.SX.sym("p", 0), ca.SX.sym("s")
    cost = (seen[0] - shared) ** 2 + (seen[1] + seen[0]) ** 2
    block = Block("pushed", seen, own, shared, cost, 2.0 * seen[0], np.array([-np.inf]), np.array([2.0]))
    options = SolverOptions(tolerance=1e-7, compiled=method is MethodName.NATIVE, method=method)
    return RepeatedProgram("pushed", [Repeated(block, np.eye(4), 2)], options)


def slopes_at(shared: float, method: MethodName, held: float | None = None) -> object:
    """How x and y move with s; the last y is held where a number is given."""
    solver, own, given = pushed(method), [np.empty((2, 0))], np.array([shared])
    low, high = np.full(4, -3.0), np.full(4, 3.0)
    low[3], high[3] = (-3.0, 3.0) if held is None else (held, held)
    ending, _ = solver.solve(np.clip(np.full(4, 0.2), low, high), (low, high), given, own)
    exact = solver.exact(ending, (low, high), given, own)
    assert isinstance(exact, Ending)
    found = solver.slopes(exact, (low, high), given, own, 1)
    return found if isinstance(found, NotDifferentiable) else found.ravel()


@METHODS
@pytest.mark.parametrize("beyond", [1e-2, 1e-4, 1e-5])
def test_a_limit_that_is_nearly_reached_does_not_hold_and_one_that_hardly_pushes_does(
    method: MethodName, beyond: float
) -> None:
    assert slopes_at(1.0 - beyond, method) == pytest.approx([1.0, -1.0, 1.0, -1.0], abs=1e-5)
    assert slopes_at(1.0 + beyond, method) == pytest.approx([0.0, 0.0, 0.0, 0.0], abs=1e-5)


@METHODS
def test_a_limit_that_is_just_reached_leaves_no_derivative(method: MethodName) -> None:
    found = slopes_at(1.0, method)
    assert isinstance(found, NotDifferentiable)
    assert found.reason.startswith("a limit of the motion is only just reached")


@METHODS
def test_a_variable_of_one_value_stays_though_nothing_pushes_it(method: MethodName) -> None:
    """Without its value y would be -x = -0.5, which it is."""
    assert slopes_at(0.5, method, held=-0.5) == pytest.approx([1.0, -1.0, 0.5, 0.0], abs=1e-6)
