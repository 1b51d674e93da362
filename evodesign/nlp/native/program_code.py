"""C of a program: its functions, and all that the method must know of it beforehand.

Variables with one value only are numbers here, which saves a third of the operations; functions that are
asked for together have common subexpressions.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from evodesign.nlp.native.elimination import Elimination, Entries, determined, elimination
from evodesign.nlp.native.switched import FunctionSymbols, SwitchedRow, switched_rows
from evodesign.nlp.program import Array, Program

PROBLEM = "evodesign_problem"
"""Function of the library that gives the problem."""

UNBOUNDED = 1e20
"""What an infinite limit is written as."""

HERE = Path(__file__).parent

METHOD_FILES = tuple(sorted(path.name for path in HERE.glob("*.[ch]")))
"""The method's own files, in this folder."""


def fixed_variables(program: Program) -> NDArray[np.bool_]:
    """Which symbols have one value only."""
    lower, upper = program.bounds
    return np.asarray(lower == upper)


def program_text(program: Program) -> str:
    """The C of a program."""
    x, given = ca.vertsplit(program.symbols), program.given
    (lower, upper), limits = program.bounds, program.limits
    held = fixed_variables(program)
    free, fixed = (ca.vertcat(*[x[i] for i in np.flatnonzero(which)]) for which in (~held, held))
    multipliers = ca.SX.sym("multipliers", program.rows.numel())
    lagrangian = program.cost + ca.dot(multipliers, program.rows)
    by_fixed = ca.gradient(lagrangian, fixed) if held.any() else ca.SX(0, 1)
    cost, rows, by_fixed, by_given = ca.substitute(
        [program.cost, program.rows, by_fixed, ca.gradient(lagrangian, given)], [fixed], [ca.SX(lower[held])]
    )
    symbols = FunctionSymbols(free, given, multipliers)
    hessian, jacobian = symbols.hessian(cost + ca.dot(multipliers, rows)), ca.jacobian(rows, free)
    sparsities = hessian.sparsity(), jacobian.sparsity()
    switched = switched_rows(program, rows, symbols, *sparsities)
    if switched and program.switches is not None:
        rows = ca.SX(rows)
        for each in switched:
            rows[each.row] = program.switches.off
        hessian, jacobian = (
            ca.project(each, sparsity)
            for each, sparsity in zip(
                (symbols.hessian(cost + ca.dot(multipliers, rows)), ca.jacobian(rows, free)),
                sparsities,
                strict=True,
            )
        )
    functions = [
        ca.Function("values", [free, given], ca.cse([ca.densify(cost), ca.densify(rows)])),
        ca.Function(
            "derivatives",
            [free, given, multipliers],
            ca.cse(
                [ca.densify(cost), ca.densify(ca.gradient(cost, free)), ca.densify(rows), jacobian, hessian]
            ),
        ),
        ca.Function(
            "slopes", [free, given, multipliers], ca.cse([ca.densify(by_given), ca.densify(by_fixed)])
        ),
    ]
    generator = ca.CodeGenerator("functions", {"verbose": False})
    for function in [*functions, *(function for each in switched for function in each.functions)]:
        generator.add(function)
    equalities = np.asarray(limits[0] == limits[1])
    order = elimination(Entries.of(hessian), Entries.of(jacobian), determined(jacobian, equalities))
    vectors = [*(bound[~held] for bound in (lower, upper)), *limits]
    return "\n".join(
        [
            str(generator.dump()),
            (HERE / "interior_point.h").read_text(encoding="ascii"),
            _problem_text(functions, hessian, jacobian, vectors, order, switched),
        ]
    )


def _problem_text(
    functions: Sequence[Any],
    hessian: Any,
    jacobian: Any,
    vectors: Sequence[Array],
    order: Elimination,
    switched: Sequence[SwitchedRow],
) -> str:
    """The definition of the problem, with its arrays."""
    sparse = [(matrix.sparsity().colind(), matrix.sparsity().row()) for matrix in (hessian, jacobian)]
    integers = {
        "hessian_starts": sparse[0][0],
        "hessian_rows": sparse[0][1],
        "jacobian_starts": sparse[1][0],
        "jacobian_rows": sparse[1][1],
        **{name: getattr(order, name) for name in order.__dataclass_fields__},
    }
    reals = dict(zip(("lower", "upper", "row_lower", "row_upper"), vectors, strict=True))
    lines = [_array("int", name, [str(int(value)) for value in values]) for name, values in integers.items()]
    lines += [_array("double", name, [_real(value) for value in values]) for name, values in reals.items()]
    every = [*functions, *(function for each in switched for function in each.functions)]
    for number, each in enumerate(switched):
        lines += [
            _array("int", f"{kind}_of_row_{number}", [*map(str, places)]) for kind, places in each.places
        ]
    if switched:
        inside = ", ".join(each.text(number) for number, each in enumerate(switched))
        lines.append(f"static const SwitchedRow switched[] = {{{inside}}};")
    fields = {
        "variables": hessian.size1(),
        "rows": jacobian.size1(),
        **{name: name for name in (*integers, *reals)},
        **{function.name(): function.name() for function in functions},
        "work": max(function.sz_w() for function in every),
        "integers": max(function.sz_iw() for function in every),
        **({"switched_count": len(switched), "switched": "switched"} if switched else {}),
    }
    inside = ", ".join(f".{name} = {value}" for name, value in fields.items())
    lines += [f"static const Problem problem = {{{inside}}};", f"const Problem *{PROBLEM}(void);"]
    return "\n".join([*lines, f"const Problem *{PROBLEM}(void) {{ return &problem; }}", ""])


def _array(kind: str, name: str, values: Sequence[str]) -> str:
    """An array; one without entries has a place nevertheless, as C wants it."""
    return f"static const {kind} {name}[] = {{{', '.join(values) or '0'}}};"


def _real(value: float) -> str:
    return float(np.clip(value, -UNBOUNDED, UNBOUNDED)).hex()
