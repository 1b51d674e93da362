"""`[constraints]` of a problem file: bounds of quantities that could be objectives.

A key is the quantity's name with the suffix of its unit: `mass_kg`, `reach_height_m`,
`q90_robot_torque_n_m`. A quantity of unit 1, and one whose unit has no suffix, is its own key: `peak_torque`,
`paper_cost`.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from evodesign.design.space import DesignSpace
from evodesign.errors import InputError, offered
from evodesign.mechanics.agent import Agent
from evodesign.problem.file import BoundsTable, ProblemFile
from evodesign.problem.torque_limits import PEAK_TORQUE, refuse_unlimited_peak
from evodesign.problem.unanswered_quantities import refuse_unanswered_quantity
from evodesign.quantities.design_result import ObjectiveKind
from evodesign.quantities.objectives import OTHERWISE_CALLED, QUANTITIES, objective_kind, objective_kinds
from evodesign.records import Constraint, ProblemSource
from evodesign.violations import BODIES_APART, PARTS_APART

SUFFIXES: Mapping[str, str] = {
    "N m": "_n_m",
    "N s": "_n_s",
    "N": "_n",
    "kg": "_kg",
    "m": "_m",
    "W": "_w",
    "mm": "_mm",
    "EUR": "_eur",
    "J": "_j",
    "deg C": "_c",
}
"""How a key ends, by the unit of its quantity."""


def constraint_key(name: str) -> str:
    """The key in `[constraints]` of a quantity.

    Raises:
        KeyError: there is no such quantity.
    """
    kind = objective_kind(name)
    if kind is None:
        raise KeyError(name)
    return name + SUFFIXES.get(kind.unit, "")


def constraints_of(
    tables: ProblemFile, source: ProblemSource, robots: Sequence[Agent], people: Sequence[Agent]
) -> tuple[Constraint, ...]:
    """The constraints of a problem file, in its order.

    Raises:
        InputError: a key that is no quantity with its unit, no bound, bounds that leave nothing between them,
            or a quantity that needs strengths or torque limits which are not known.
    """
    found = []
    for key, table in tables.constraints.items():
        place = f"constraints.{key}"
        name, kind = _quantity(key, source)
        _check_bounds(table, place, source)
        refuse_unanswered_quantity(place, name, tables, source, people)
        for robot in robots if name.endswith(PEAK_TORQUE) else ():
            refuse_unlimited_peak(place, name, tables, source, robot)
        found.append(Constraint(name=name, unit=kind.unit, lower=table.lower, upper=table.upper))
    return tuple(found)


def _quantity(key: str, source: ProblemSource) -> tuple[str, ObjectiveKind]:
    """The quantity of a key."""
    for suffix in (*SUFFIXES.values(), ""):
        name = key.removesuffix(suffix)
        kind = objective_kind(name)
        if kind is not None and constraint_key(name) == key:
            return name, kind
    keys = [constraint_key(name) for name in objective_kinds()]
    quantile = re.match(r"q[1-9]\d?_", key)
    quantiles = [constraint_key(f"{quantile[0]}{name}") for name in QUANTITIES] if quantile else []
    meant = OTHERWISE_CALLED.get(key.removesuffix("_w"), key)
    known, found = offered(keys, key, meant, quantiles)
    raise InputError(source.path, f"constraints.{key}", f"one of the keys {known}", found)


def _check_bounds(table: BoundsTable, place: str, source: ProblemSource) -> None:
    lower, upper = table.lower, table.upper
    if lower is None and upper is None:
        raise InputError(source.path, place, "lower, upper or both", "neither")
    if lower is not None and upper is not None and lower >= upper:
        raise InputError(source.path, f"{place}.lower", f"less than upper ({upper:g})", f"{lower:g}")


def with_what_can_be_built(
    constraints: Sequence[Constraint], robots: Sequence[Agent], space: DesignSpace
) -> tuple[Constraint, ...]:
    """Constraints of a file, and that a design can be built: that its bodies, and its parts, are apart."""
    named = {constraint.name for constraint in constraints}
    asked = {
        BODIES_APART: any(robot.collisions is not None and robot.collisions.built_in for robot in robots),
        PARTS_APART: any(parameter.mountings for parameter in space.parameters),
    }
    added = [name for name, may_not in asked.items() if may_not and name not in named]
    return (*constraints, *(Constraint(name=name, unit="m", lower=0.0, upper=None) for name in added))


def refuse_constraints(constraints: Sequence[Constraint], source: ProblemSource) -> None:
    """Refuse constraints for the paper's joint problem, whose program does not hold them.

    Raises:
        InputError: naming the first one.
    """
    asked = [constraint.name for constraint in constraints if constraint.name != BODIES_APART]
    if asked:
        key = f"constraints.{constraint_key(asked[0])}"
        raise InputError(source.path, key, "no [constraints] in the joint problem", "a bound")
