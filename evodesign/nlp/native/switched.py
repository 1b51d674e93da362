"""Rows of a program that are mostly off: functions of their own, which are called where they are on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca

from evodesign.nlp.program import Program


@dataclass(frozen=True, slots=True)
class FunctionSymbols:
    """What functions are of: variables, parameters and multipliers of all rows."""

    free: Any
    given: Any
    multipliers: Any

    def hessian(self, lagrangian: Any) -> Any:
        """Its upper triangle."""
        return ca.triu(ca.hessian(lagrangian, self.free)[0])


@dataclass(frozen=True, slots=True)
class SwitchedRow:
    """A row with functions of its own.

    Args:
        row: its number.
        parameter: which one is zero where it is off.
        functions: its value; and its value and derivatives.
        places: of the derivatives' entries among the program's, by kind.
    """

    row: int
    parameter: int
    functions: tuple[Any, Any]
    places: tuple[tuple[str, list[int]], ...]

    def text(self, number: int) -> str:
        """The row's entry in the table of all."""
        fields = {
            "parameter": self.parameter,
            "row": self.row,
            **{f"{kind}_entries": len(places) for kind, places in self.places},
            **{f"{kind}_places": f"{kind}_of_row_{number}" for kind, places in self.places},
            "values": self.functions[0].name(),
            "derivatives": self.functions[1].name(),
        }
        return f"{{{', '.join(f'.{name} = {value}' for name, value in fields.items())}}}"


def switched_rows(
    program: Program, rows: Any, symbols: FunctionSymbols, hessian: Any, jacobian: Any
) -> list[SwitchedRow]:
    """The rows that may be off: most are, and functions of their own are called for those that are on.

    Common subexpressions are not looked for in them: that would take half of the time in which a program is
    made ready, and save 3 % of their operations.

    Args:
        program: with all rows.
        rows: as they are compiled.
        symbols: of all functions.
        hessian: sparsity of the program's.
        jacobian: likewise.
    """
    if program.switches is None or not program.switched:
        return []
    found = []
    for number, (row, parameter) in enumerate(program.switches.rows_of(program)):
        value = rows[row]
        slope, curvature = ca.jacobian(value, symbols.free), symbols.hessian(symbols.multipliers[row] * value)
        columns = [column for _, column in zip(*slope.sparsity().get_triplet(), strict=True)]
        entries = [*zip(*curvature.sparsity().get_triplet(), strict=True)]
        places = (
            ("jacobian", [jacobian.get_nz(row, column) for column in columns]),
            ("hessian", [hessian.get_nz(*entry) for entry in entries]),
        )
        functions = (
            ca.Function(f"row_{number}", [symbols.free, symbols.given], [ca.densify(value)]),
            ca.Function(
                f"row_{number}_derivatives",
                [symbols.free, symbols.given, symbols.multipliers],
                [ca.densify(value), slope, curvature],
            ),
        )
        found.append(SwitchedRow(row, parameter, functions, places))
    return found
