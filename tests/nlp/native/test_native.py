"""The method in C against IPOPT and closed forms; its failures; and its memory under sanitizers."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

from evodesign.nlp.compiler import Compiler, find_compiler
from evodesign.nlp.method import MethodName, SolverOptions
from evodesign.nlp.native.elimination import Entries, determined, elimination
from evodesign.nlp.program import ConstraintBlock, Program, Variable
from evodesign.nlp.solver import Solver, available
from evodesign.records import Status
from tests.nlp.native.programs import random_program

pytestmark = pytest.mark.needs_compiler

NATIVE = SolverOptions(compiled=True, method=MethodName.NATIVE)


def program(
    cost: ca.SX,
    x: ca.SX,
    rows: dict[str, tuple[ca.SX, float, float]],
    *,
    bounds: tuple[float, float] = (-np.inf, np.inf),
    start: float = 0.5,
    given: dict[str, ca.SX] | None = None,
) -> Program:
    n = x.numel()
    return Program(
        name="small",
        variables=(Variable("x", x, 1.0, np.full(n, bounds[0]), np.full(n, bounds[1]), np.full(n, start)),),
        constraints=tuple(ConstraintBlock(name, *row) for name, row in rows.items()),
        cost=cost,
        parameters=given or {},
    )


@pytest.fixture
def compiler() -> Compiler:
    found = find_compiler({"PATH": "/usr/bin:/usr/local/bin:/bin"})
    assert isinstance(found, Compiler)
    return found


def both(small: Program) -> tuple[Solver, Solver]:
    return Solver(small, NATIVE), Solver(small, SolverOptions())


def test_the_native_method_solves_where_it_is_asked_for() -> None:
    x = ca.SX.sym("x", 2)
    solver = Solver(program(ca.sumsqr(x), x, {"sum": (x[0] + x[1], 1.0, 1.0)}), NATIVE)
    assert solver.native
    assert not solver.by_ipopt.native
    assert available(NATIVE) == NATIVE


def test_closed_form_with_its_multipliers() -> None:
    """Nearest point of the line x + y = b to the origin, with y at most 0.2: (b - 0.2, 0.2).

    Stationarity: 2 x + l = 0, 2 y + l + z = 0; the cost's slope by b is -l.
    """
    x, b = ca.SX.sym("x", 2), ca.SX.sym("b")
    small = Program(
        name="line",
        variables=(Variable("x", x, 1.0, np.full(2, -np.inf), np.array([np.inf, 0.2]), np.zeros(2)),),
        constraints=(ConstraintBlock("line", x[0] + x[1] - b, 0.0, 0.0),),
        cost=ca.sumsqr(x),
        parameters={"b": b},
    )
    found = Solver(small, NATIVE).solve({"b": 1.0}, {})
    assert found.method is MethodName.NATIVE
    assert found.status is Status.SOLVED
    assert found.values["x"] == pytest.approx([0.8, 0.2], abs=1e-7)
    assert found.multipliers.constraints == pytest.approx([-1.6], abs=1e-7)
    assert found.multipliers.bounds == pytest.approx([0.0, 1.2], abs=1e-6)
    assert found.cost_slope == pytest.approx([1.6], abs=1e-7)


def test_known_optimum_of_a_curved_program() -> None:
    """Hock and Schittkowski 71: the published optimum, and IPOPT's multipliers."""
    x = ca.SX.sym("x", 4)
    cost = x[0] * x[3] * (x[0] + x[1] + x[2]) + x[2]
    rows = {"product": (x[0] * x[1] * x[2] * x[3], 25.0, np.inf), "sphere": (ca.sumsqr(x), 40.0, 40.0)}
    ours, theirs = (
        solver.solve({}, {"x": [1.0, 5.0, 5.0, 1.0]})
        for solver in both(program(cost, x, rows, bounds=(1.0, 5.0)))
    )
    assert ours.cost == pytest.approx(17.0140173, abs=1e-6)
    assert ours.iterations == theirs.iterations
    assert ours.multipliers.constraints == pytest.approx(theirs.multipliers.constraints, abs=1e-7)
    assert ours.multipliers.bounds == pytest.approx(theirs.multipliers.bounds, abs=1e-7)


@pytest.mark.parametrize("convex", [True, False], ids=["convex", "curved"])
@pytest.mark.parametrize("seed", range(2))
def test_random_programs_as_ipopt_has_them(seed: int, convex: bool) -> None:
    assert compare(seed, convex=convex, draws=15) == 0


@pytest.mark.slow
@pytest.mark.parametrize("convex", [True, False], ids=["convex", "curved"])
def test_a_thousand_random_programs_as_ipopt_has_them(convex: bool) -> None:
    """At most 0.3 % of what IPOPT solves may be lost, and nothing convex."""
    lost = sum(compare(seed, convex=convex, draws=50) for seed in range(2, 12))
    assert lost <= (0 if convex else 0.003 * 500)


def compare(seed: int, *, convex: bool, draws: int) -> int:
    """How many programs only IPOPT solves. A convex one has one optimum; curved ones may lead elsewhere."""
    random = random_program(seed, convex=convex)
    native, ipopt = both(random.program)
    rng = np.random.default_rng(seed)
    solved, lost, worse, better = 0, 0, 0, 0
    for _ in range(draws):
        given = {"numbers": rng.normal(size=random.numbers)}
        ours, theirs = (solver.solve(given, {}) for solver in (native, ipopt))
        if theirs.status is not Status.SOLVED:
            continue
        if ours.status is not Status.SOLVED:
            lost += 1
            continue
        solved += 1
        gap = (ours.cost - theirs.cost) / max(1.0, abs(theirs.cost))
        worse, better = worse + (gap > 1e-6), better + (gap < -1e-6)
        if abs(gap) <= 1e-6:
            stationary(random.program, given["numbers"], ours)
    assert solved >= draws // 2
    assert worse == better == 0 if convex else worse <= 0.1 * draws
    return lost


def stationary(random: Program, numbers: np.ndarray, found: object) -> None:
    """The optimality conditions, from expressions of their own: nothing of the C is used."""
    x, p = random.symbols, random.given
    y, z = found.multipliers.constraints, found.multipliers.bounds  # type: ignore[attr-defined]
    slope = ca.Function("slope", [x, p], [ca.gradient(random.cost, x) + ca.jacobian(random.rows, x).T @ y])
    at = found.values["x"]  # type: ignore[attr-defined]
    assert np.abs(np.asarray(slope(at, numbers)).ravel() + z).max() <= 1e-5 * max(
        1.0, np.abs(y).max(initial=0.0)
    )


@pytest.mark.parametrize("seed", range(3))
def test_factors_hold_every_fill(seed: int) -> None:
    """The pattern of L against the numbers of a dense factorisation of a system of that pattern."""
    random = random_program(seed, convex=False).program
    x = random.symbols
    y = ca.SX.sym("y", random.rows.numel())
    hessian = ca.triu(ca.hessian(random.cost + ca.dot(y, random.rows), x)[0])
    jacobian = ca.jacobian(random.rows, x)
    equalities = np.asarray(random.limits[0] == random.limits[1])
    found = elimination(Entries.of(hessian), Entries.of(jacobian), determined(jacobian, equalities))
    n, unknowns = x.numel(), x.numel() + random.rows.numel()
    rng = np.random.default_rng(seed)
    system = np.zeros((unknowns, unknowns))
    rows, columns = (np.asarray(part) for part in hessian.sparsity().get_triplet())
    system[rows, columns] = rng.normal(size=len(rows))
    rows, columns = (np.asarray(part) for part in jacobian.sparsity().get_triplet())
    system[columns, rows + n] = rng.normal(size=len(rows))
    system = np.triu(system, 1) + np.triu(system, 1).T
    system += np.diag(np.where(np.arange(unknowns) < n, 50.0, -50.0))
    left = system[np.ix_(found.order, found.order)]
    lower = np.eye(unknowns)
    for k in range(unknowns):
        lower[k + 1 :, k] = left[k + 1 :, k] / left[k, k]
        left = left - np.outer(lower[:, k], left[k]) * (np.arange(unknowns) > k)[:, None]
    pattern = np.zeros((unknowns, unknowns), bool)
    for column in range(unknowns):
        first, last = found.factor_starts[column : column + 2]
        pattern[found.factor_rows[first:last], column] = True
    assert not (np.abs(np.tril(lower, -1)) > 1e-14)[~pattern].any()
    assert sorted(found.order) == list(range(unknowns))
    by_rows = [
        (r, c)
        for r in range(unknowns)
        for c in found.pattern[found.pattern_starts[r] : found.pattern_starts[r + 1]]
    ]
    assert by_rows == [tuple(each) for each in np.argwhere(pattern)]


def test_no_feasible_point_is_said_and_soon() -> None:
    x = ca.SX.sym("x", 2)
    small = program(x[0], x, {"circle": (ca.sumsqr(x), 1.0, 1.0), "far": (x[0], 3.0, np.inf)})
    found = Solver(small, NATIVE).solve({}, {})
    assert found.status is Status.INFEASIBLE
    assert found.reason == "Infeasible_Problem_Detected"
    assert found.iterations < 150


def test_restorations_count_among_iterations() -> None:
    """A solve that is given up early ends as soon in a search for a feasible point."""
    x = ca.SX.sym("x", 2)
    small = program(x[0], x, {"circle": (ca.sumsqr(x), 1.0, 1.0), "far": (x[0], 3.0, np.inf)})
    whole = Solver(small, NATIVE).solve({}, {}).iterations
    assert whole > 10
    for limit in range(2, whole, 3):
        few = Solver(small, replace(NATIVE, iterations=limit)).solve({}, {})
        assert (few.status, few.iterations) == (Status.ITERATION_LIMIT, limit)


def test_a_number_that_is_none_is_a_failure_with_a_reason() -> None:
    x, p = ca.SX.sym("x", 2), ca.SX.sym("p")
    small = program(ca.sumsqr(x - p), x, {"sum": (x[0] + x[1], 1.0, 1.0)}, given={"p": p})
    solver = Solver(small, NATIVE)
    found = solver.solve({"p": np.nan}, {})
    assert found.status is Status.NUMERICAL_FAILURE
    assert found.reason == "Invalid_Number_Detected"
    assert solver.solve({"p": 1.0}, {}).status is Status.SOLVED  # nothing of it is left behind


def test_limits_of_iterations_and_time() -> None:
    x = ca.SX.sym("x", 2)
    valley = 100.0 * (x[1] - x[0] ** 2) ** 2 + (1.0 - x[0]) ** 2
    small = program(valley, x, {"box": (x[0], -2.0, 2.0)}, start=-1.0)
    few = SolverOptions(iterations=2, compiled=True, method=MethodName.NATIVE)
    short = SolverOptions(seconds=1e-9, compiled=True, method=MethodName.NATIVE)
    assert Solver(small, few).solve({}, {}).status is Status.ITERATION_LIMIT
    assert Solver(small, short).solve({}, {}).status is Status.TIME_LIMIT
    assert Solver(small, NATIVE).solve({}, {}).values["x"] == pytest.approx([1.0, 1.0], abs=1e-6)


@pytest.mark.parametrize("width", [1e-9, 1e-7, 0.0])
def test_narrow_rows_and_equalities_twice_over(width: float) -> None:
    x = ca.SX.sym("x", 3)
    line = x[0] + x[1] + x[2]
    rows = {"narrow": (line, 1.0, 1.0 + width), "again": (2.0 * line, 2.0, 2.0), "third": (-line, -1.0, -1.0)}
    found = Solver(program(ca.sumsqr(x), x, rows), NATIVE).solve({}, {})
    assert found.status is Status.SOLVED
    assert found.values["x"] == pytest.approx([1 / 3] * 3, abs=1e-5)


def test_everything_held_and_no_rows() -> None:
    x = ca.SX.sym("x", 2)
    held = Program(
        name="held",
        variables=(Variable("x", x, 1.0, np.array([0.5, -1.0]), np.array([0.5, 1.0]), np.array([0.5, 0.0])),),
        constraints=(),
        cost=(x[0] - 2.0 * x[1]) ** 2,
        parameters={},
    )
    found = Solver(held, NATIVE).solve({}, {})
    assert found.values["x"] == pytest.approx([0.5, 0.25], abs=1e-6)
    assert found.multipliers.bounds == pytest.approx([0.0, 0.0], abs=1e-6)


def test_the_same_bits_every_time() -> None:
    random = random_program(3, convex=False)
    given = {"numbers": np.random.default_rng(0).normal(size=random.numbers)}
    first, second = Solver(random.program, NATIVE), Solver(random.program, NATIVE)
    second.solve({"numbers": -given["numbers"]}, {})  # what was solved before does not count
    one, other = first.solve(given, {}), second.solve(given, {})
    assert one.values["x"].tobytes() == other.values["x"].tobytes()
    assert (one.cost, one.iterations) == (other.cost, other.iterations)


def test_threads_take_turns() -> None:
    random = random_program(3, convex=False)
    rng = np.random.default_rng(1)
    given = [{"numbers": rng.normal(size=random.numbers)} for _ in range(40)]
    solver = Solver(random.program, NATIVE)
    alone = [solver.solve(each, {}).cost for each in given]
    with ThreadPoolExecutor(4) as pool:
        assert list(pool.map(lambda each: solver.solve(each, {}).cost, given * 5)) == alone * 5


def test_near_solves_keep_the_solution() -> None:
    random = random_program(1, convex=True)
    given = {"numbers": np.random.default_rng(0).normal(size=random.numbers)}
    solver = Solver(random.program, NATIVE)
    far = solver.solve(given, {})
    near = solver.near.solve(given, far.values)
    assert near.status is Status.SOLVED
    assert near.values["x"] == pytest.approx(far.values["x"], abs=1e-6)
    assert near.iterations < far.iterations
