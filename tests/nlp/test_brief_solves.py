"""With rows that can be switched on slow solves are given up, unless all of them are."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

from evodesign.nlp.solver import BRIEF, Solver, SolverOptions
from evodesign.records import Status

NEEDED = {"quick": 10, "slow": 90, "hopeless": 999}
"""Iterations of a solve by where it starts; hopeless ones find no posture."""


class Counted(Solver):
    """Solves that need some iterations, and what was asked for: where each began, and its limit."""

    def __init__(self, switches: object = "some") -> None:
        self.program: Any = SimpleNamespace(switches=switches)
        self.options = SolverOptions()
        self.asked: list[tuple[str, int]] = []

    def solve(self, parameters: object, start: Any) -> Any:
        """What a start leads to."""
        limit = self.options.iterations
        self.asked.append((start, limit))
        status = Status.SOLVED if NEEDED[start] <= limit else Status.ITERATION_LIMIT
        return SimpleNamespace(status=Status.INFEASIBLE if start == "hopeless" else status)

    def ends(self, *starts: Any) -> list[Status]:
        """Where starts lead to."""
        return [raw.status for raw in self.solved_each({}, starts)]


def test_slow_ones_are_given_up_where_another_one_succeeds() -> None:
    solver = Counted()
    assert solver.ends("slow", "quick") == [Status.ITERATION_LIMIT, Status.SOLVED]
    assert solver.asked == [("slow", BRIEF), ("quick", BRIEF)]


def test_all_are_solved_to_their_ends_where_none_succeeds_but_those_that_have_ended() -> None:
    solver = Counted()
    assert solver.ends("slow", "hopeless") == [Status.SOLVED, Status.INFEASIBLE]
    assert solver.asked == [("slow", BRIEF), ("hopeless", BRIEF), ("slow", 300)]


def test_the_only_one_is_solved_to_its_end() -> None:
    solver = Counted()
    assert solver.ends("slow") == [Status.SOLVED]
    assert solver.asked == [("slow", 300)]


def test_no_solve_is_given_up_where_no_rows_can_be_switched_on() -> None:
    solver = Counted(switches=None)
    assert solver.ends("slow", "quick") == [Status.SOLVED, Status.SOLVED]
    assert solver.asked == [("slow", 300), ("quick", 300)]
