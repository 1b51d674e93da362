"""Slow ones of several solves are given up, unless all of them are."""

from __future__ import annotations

from copy import copy
from types import SimpleNamespace
from typing import Any

import casadi as ca
import pytest

from evodesign.nlp.method import SolverOptions
from evodesign.nlp.program import Program, Variable
from evodesign.nlp.solver import Solver
from evodesign.posture.seeking.budget import BUDGET
from evodesign.posture.seeking.seeker import Seeker
from evodesign.records import Status

NEEDED = {"quick": 10, "slow": 90, "hopeless": 999}
"""Iterations of a solve by where it starts; hopeless ones find no posture."""


class Counted(Solver):
    """Solves that need some iterations, and what was asked for: where each began, and its limit."""

    def __init__(self) -> None:
        self.options = SolverOptions()
        self.asked: list[tuple[str, int]] = []

    def with_options(self, options: SolverOptions) -> Solver:
        """The same, asked in the same way."""
        other = copy(self)
        other.options = options
        return other

    def solve(self, parameters: object, start: Any) -> Any:
        """What a start leads to."""
        limit = self.options.iterations
        self.asked.append((start, limit))
        status = Status.SOLVED if NEEDED[start] <= limit else Status.ITERATION_LIMIT
        return SimpleNamespace(status=Status.INFEASIBLE if start == "hopeless" else status)

    def ends(self, *starts: Any) -> list[Status]:
        """Where starts lead to."""
        return [raw.status for raw in Seeker(self).ends({}, starts)]


def test_slow_ones_are_given_up_where_another_one_succeeds() -> None:
    solver = Counted()
    assert solver.ends("slow", "quick") == [Status.ITERATION_LIMIT, Status.SOLVED]
    assert solver.asked == [("slow", BUDGET.brief), ("quick", BUDGET.brief)]


def test_all_are_solved_to_their_ends_where_none_succeeds_but_those_that_have_ended() -> None:
    solver = Counted()
    assert solver.ends("slow", "hopeless") == [Status.SOLVED, Status.INFEASIBLE]
    assert solver.asked == [("slow", BUDGET.brief), ("hopeless", BUDGET.brief), ("slow", 300)]


def test_the_only_one_is_solved_to_its_end() -> None:
    solver = Counted()
    assert solver.ends("slow") == [Status.SOLVED]
    assert solver.asked == [("slow", 300)]


def test_a_solve_that_was_given_up_goes_on_where_it_ended() -> None:
    """In a bent valley, whose least cost is at (1, 1); the work of both parts is told."""
    place = Variable.column("place", [-2.0, -2.0], [2.0, 2.0], [0.0, 0.0], 1.0)
    x, y = ca.vertsplit(place.value)
    program = Program("valley", (place,), (), (1.0 - x) ** 2 + 100.0 * (y - x**2) ** 2, {})
    start = {"place": [-1.9, 2.0]}
    given_up = Solver(program, SolverOptions(iterations=5)).solve({}, start)
    assert given_up.status is Status.ITERATION_LIMIT
    found = Seeker(Solver(program, SolverOptions())).continued({}, given_up)
    assert found.status is Status.SOLVED
    assert found.values["place"] == pytest.approx([1.0, 1.0], abs=1e-4)
    assert found.start == start
    assert found.iterations > given_up.iterations == 5
