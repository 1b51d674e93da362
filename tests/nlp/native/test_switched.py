"""Rows that are mostly off, in the method in C: as IPOPT has them where they are on, as if gone where not."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from itertools import product
from typing import Any

import casadi as ca
import numpy as np
import pytest

from evodesign.nlp.method import MethodName, SolverOptions
from evodesign.nlp.native.switched import FunctionSymbols, switched_rows
from evodesign.nlp.optimality import Conditions, PrimalDual
from evodesign.nlp.program import ConstraintBlock, Program, Start, Variable
from evodesign.nlp.solver import Solver
from evodesign.records import Status

ROWS, OFF, LEAST = 4, 10.0, 0.3
NATIVE = SolverOptions(compiled=True, method=MethodName.NATIVE)


class ByNumbers:
    """Switches of a program with all rows: one number for each; which are on is told by starts alone."""

    def __init__(self, program: Program | None = None) -> None:
        self._program = program

    names: Collection[str] = ("on",)
    off = OFF

    @property
    def program(self) -> Program:
        assert self._program is not None
        return self._program

    def rows_of(self, program: Program) -> Sequence[tuple[int, int]]:
        first = program.columns["on"].start
        return [(1 + number, first + number) for number in range(ROWS)]

    def begun(self, values: Start, given: Mapping[str, Any]) -> Start:
        return {}

    def violated(self, values: Start, given: Mapping[str, Any], short: float = 0.0) -> Start:
        return {}

    def needed(self, values: Start, multipliers: Any, price: float) -> Start:
        return {}

    def better(self, values: Start, given: Mapping[str, Any], multipliers: Any, gain: float) -> Start:
        return {}


def program(seed: int, kept: Sequence[bool] | None = None) -> Program:
    """A target outside curved walls, on a plane; with switches, or with those walls alone that are kept."""
    rng = np.random.default_rng(seed)
    x, on, target = ca.SX.sym("x", 5), ca.SX.sym("on", ROWS), ca.SX.sym("target", 5)
    walls = []
    for _ in range(ROWS):
        two = rng.permutation(5)[:2]
        seen = ca.vertcat(x[int(two[0])], ca.sin(x[int(two[1])]))
        walls.append(LEAST + ca.dot(ca.DM(rng.uniform(0.5, 1.0, 2)), seen) + 0.1 * ca.sumsqr(seen))
    if kept is None:
        walls = [wall + OFF * (1.0 - on[number]) for number, wall in enumerate(walls)]
    else:
        walls = [wall for wall, wanted in zip(walls, kept, strict=True) if wanted]
    blocks = [ConstraintBlock("plane", ca.sum1(x) + 0.1 * ca.sumsqr(x), 0.0, 0.0)]
    blocks += [ConstraintBlock("walls", ca.vertcat(*walls), LEAST, np.inf)] if walls else []
    variable = Variable("x", x, 1.0, np.full(5, -4.0), np.full(5, 4.0), np.full(5, 0.5))
    switches = ByNumbers()
    given = {"target": target, **({"on": on} if kept is None else {})}
    found = Program("walls", (variable,), tuple(blocks), ca.sumsqr(x - target), given, None)
    return replace(found, switches=switches) if kept is None else found


@pytest.mark.needs_compiler
@pytest.mark.parametrize("seed", range(3))
def test_rows_count_where_they_are_on_and_nowhere_else(seed: int) -> None:
    native, target = Solver(program(seed), NATIVE), np.random.default_rng(10 + seed).uniform(-2.0, -0.5, 5)
    held = 0
    for on in product([False, True], repeat=ROWS):
        found = native.solve({"target": target}, {"on": np.array(on, float)})
        alone = Solver(program(seed, on), SolverOptions()).solve({"target": target}, {})
        assert found.status is alone.status is Status.SOLVED
        assert found.cost == pytest.approx(alone.cost, rel=1e-7)
        assert found.values["x"] == pytest.approx(alone.values["x"], abs=1e-4)
        prices = found.multipliers.constraints[1:]
        assert prices[np.array(on)] == pytest.approx(alone.multipliers.constraints[1:], abs=1e-4)
        assert prices[~np.array(on)] == pytest.approx(0.0, abs=1e-5)
        held += int((prices < -1e-3).sum())
    assert held >= 2**ROWS / 2, "walls hold the solution"


@pytest.mark.parametrize("on", [(), (1,), (0, 3), (0, 1, 2, 3)])
def test_derivatives_are_those_of_the_program_with_the_rows_that_are_on_and_no_others(on: tuple) -> None:
    whole, rng = program(2), np.random.default_rng(5)
    alone = program(2, [number in on for number in range(ROWS)])
    x, target, forces = rng.normal(size=5), rng.normal(size=5), rng.normal(size=1 + ROWS)
    kept = [0, *(1 + number for number in on)]
    given = np.concatenate([target, [float(number in on) for number in range(ROWS)]])
    none = np.zeros(0)
    found = Conditions(whole).at(PrimalDual(x, forces, none, none, none), given)
    multipliers = ca.SX.sym("multipliers", len(kept))
    lagrangian = alone.cost + ca.dot(multipliers, alone.rows)
    hessian, gradient = ca.hessian(lagrangian, alone.symbols)
    numbers = ca.Function(
        "alone",
        [alone.symbols, multipliers, alone.given],
        [
            alone.cost,
            alone.rows,
            ca.jacobian(alone.rows, alone.symbols),
            gradient,
            hessian,
            ca.jacobian(gradient, alone.given),
            ca.gradient(lagrangian, alone.given),
        ],
    )(x, forces[kept], target)
    cost, rows, jacobian, slope, curvature, cross, by_given = (np.array(each) for each in numbers)
    assert found.cost == pytest.approx(cost.item(), abs=1e-12)
    assert found.rows[kept] == pytest.approx(rows.ravel(), abs=1e-12)
    assert found.jacobian[kept] == pytest.approx(jacobian, abs=1e-12)
    assert found.gradient == pytest.approx(slope.ravel(), abs=1e-12)
    assert found.hessian == pytest.approx(curvature, abs=1e-12)
    assert found.gradient_slope[:, :5] == pytest.approx(cross, abs=1e-12)
    assert found.cost_slope[:5] == pytest.approx(by_given.ravel(), abs=1e-12)
    off = [row for row in range(1 + ROWS) if row not in kept]
    assert found.rows[off].tolist() == [OFF] * len(off)
    assert not found.jacobian[off].any()


@pytest.mark.needs_compiler
@pytest.mark.parametrize("on", [0.0, 1.0])
def test_a_solve_is_given_up_at_its_limit(on: float) -> None:
    native, given, start = Solver(program(0), NATIVE), {"target": np.full(5, -1.0)}, {"on": np.full(ROWS, on)}
    brief, whole = (
        native.with_options(replace(NATIVE, iterations=3)).solve(given, start),
        native.solve(given, start),
    )
    assert (brief.status, brief.iterations) == (Status.ITERATION_LIMIT, 3)
    assert whole.status is Status.SOLVED
    assert whole.iterations > 3


def test_solvers_with_other_options_share_the_program_with_all_rows() -> None:
    """It takes seconds to make."""
    solver = Solver(replace(program(0), switches=ByNumbers(program(0))), SolverOptions())
    assert solver.near.parted is solver.with_options(SolverOptions(iterations=3)).near.parted is solver.parted


def test_entries_are_at_their_places_among_those_of_the_program() -> None:
    """The sum of all rows' own derivatives, put where they belong, against CasADi's of the whole."""
    whole = program(1)
    multipliers = ca.SX.sym("multipliers", whole.rows.numel())
    symbols = FunctionSymbols(whole.symbols, whole.given, multipliers)
    jacobian = ca.jacobian(whole.rows, whole.symbols)
    hessian = symbols.hessian(ca.dot(multipliers, whole.rows))
    rng = np.random.default_rng(0)
    point, given, prices = rng.normal(size=5), rng.uniform(0.5, 1.0, 5 + ROWS), rng.normal(size=1 + ROWS)
    exact = ca.Function("exact", [whole.symbols, whole.given, multipliers], [jacobian, hessian])
    slopes, curvatures = (np.array(each.nonzeros()) for each in exact(point, given, prices))
    plane = replace(whole, constraints=whole.constraints[:1])
    apart = ca.Function(
        "apart",
        [whole.symbols, whole.given, multipliers],
        [
            ca.project(
                ca.vertcat(ca.jacobian(plane.rows, whole.symbols), ca.SX(ROWS, 5)), jacobian.sparsity()
            ),
            ca.project(symbols.hessian(multipliers[0] * plane.rows), hessian.sparsity()),
        ],
    )
    found = [np.array(each.nonzeros()) for each in apart(point, given, prices)]
    for row in switched_rows(whole, whole.rows, symbols, hessian.sparsity(), jacobian.sparsity()):
        value, *added = row.functions[1](point, given, prices)
        assert float(value) == float(row.functions[0](point, given))
        for entries, (_, places), own in zip(found, row.places, added, strict=True):
            np.add.at(entries, places, own.nonzeros())
    assert found[0] == pytest.approx(slopes, abs=1e-12)
    assert found[1] == pytest.approx(curvatures, abs=1e-12)
