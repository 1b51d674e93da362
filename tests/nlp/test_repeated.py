"""Programs of repeated blocks, against the same program written at length."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

from evodesign.nlp.method import SolverOptions
from evodesign.nlp.repeated import Block, Repeated, RepeatedProgram

TIMES = 4
IMAGE = np.random.default_rng(1).normal(size=(2 * TIMES, 5))
OWN = np.linspace(1.0, 2.0, TIMES).reshape(TIMES, 1)
START, BOUNDS = np.full(5, 0.3), (np.full(5, -2.0), np.full(5, 2.0))


def cost_and_rows(seen: ca.SX, own: ca.SX, shared: ca.SX) -> tuple[ca.SX, ca.SX]:
    cost = own * ca.exp(0.3 * seen[0]) + (seen[1] - shared[0]) ** 2 + shared[1] * ca.cos(seen[0] * seen[1])
    return cost, ca.vertcat(seen[0] * seen[1] + shared[0], ca.sin(seen[1]))


def program() -> RepeatedProgram:
    seen, own, shared = ca.SX.sym("y", 2), ca.SX.sym("p"), ca.SX.sym("s", 2)
    cost, rows = cost_and_rows(seen, own, shared)
    block = Block("toy", seen, own, shared, cost, rows, np.array([-1.0, -0.5]), np.array([1.5, np.inf]))
    return RepeatedProgram("toy", [Repeated(block, IMAGE, TIMES)], SolverOptions(tolerance=1e-10))


def solved_at_length(shared: np.ndarray) -> tuple[float, np.ndarray]:
    x = ca.SX.sym("x", 5)
    seen = ca.reshape(ca.DM(IMAGE) @ x, 2, TIMES)
    said = [cost_and_rows(seen[:, k], ca.SX(OWN[k, 0]), ca.SX(shared)) for k in range(TIMES)]
    problem = {"x": x, "f": sum(cost for cost, _ in said), "g": ca.vertcat(*[rows for _, rows in said])}
    options = {"print_time": False, "ipopt": {"print_level": 0, "sb": "yes", "tol": 1e-10}}
    limits = {"lbg": [-1.0, -0.5] * TIMES, "ubg": [1.5, np.inf] * TIMES}
    found = ca.nlpsol("flat", "ipopt", problem, options)(x0=START, lbx=BOUNDS[0], ubx=BOUNDS[1], **limits)
    return float(found["f"]), np.array(found["x"]).ravel()


def test_blocks_have_the_optimum_of_the_program_at_length() -> None:
    shared = np.array([0.4, 0.2])
    ending, _ = program().solve(START, BOUNDS, shared, [OWN])
    cost, where = solved_at_length(shared)
    assert ending.word == "Solve_Succeeded"
    assert ending.cost == pytest.approx(cost, rel=1e-8)
    assert ending.symbols == pytest.approx(where, abs=1e-5)


def test_the_optimal_cost_changes_with_shared_numbers_as_told() -> None:
    shared, step = np.array([0.4, 0.2]), 1e-4
    ending, _ = program().solve(START, BOUNDS, shared, [OWN])
    differences = [
        (solved_at_length(shared + step * e)[0] - solved_at_length(shared - step * e)[0]) / (2 * step)
        for e in np.eye(2)
    ]
    assert ending.cost_slope == pytest.approx(differences, rel=1e-4)
