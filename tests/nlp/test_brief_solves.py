"""Slow solves are given up where that is asked for, unless all of them are; and where solves are dear."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from types import SimpleNamespace
from typing import Any

from evodesign.collision.rules import CollisionRules
from evodesign.mechanics.disturbance import Disturbance, Disturbances
from evodesign.nlp.solver import BRIEF, Solver, SolverOptions
from evodesign.problem.build import DesignProblem
from evodesign.records import Status

NEEDED = {"quick": 10, "slow": 90, "hopeless": 999}
"""Iterations of a solve by where it starts; hopeless ones find no posture."""


class Counted(Solver):
    """Solves that need some iterations, and what was asked for: where each began, and its limit."""

    def __init__(self) -> None:
        self.options = SolverOptions()
        self.asked: list[tuple[str, int]] = []

    def solve(self, parameters: object, start: Any) -> Any:
        """What a start leads to."""
        limit = self.options.iterations
        self.asked.append((start, limit))
        status = Status.SOLVED if NEEDED[start] <= limit else Status.ITERATION_LIMIT
        return SimpleNamespace(status=Status.INFEASIBLE if start == "hopeless" else status)

    def ends(self, *starts: Any, brief: bool = True) -> list[Status]:
        """Where starts lead to."""
        return [raw.status for raw in self.solved_each({}, starts, brief=brief)]


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


def test_no_solve_is_given_up_unless_that_is_asked_for() -> None:
    solver = Counted()
    assert solver.ends("slow", "quick", brief=False) == [Status.SOLVED, Status.SOLVED]
    assert solver.asked == [("slow", 300), ("quick", 300)]


def test_scenes_are_dear_with_bodies_apart_and_several_disturbances(problem: DesignProblem) -> None:
    pushes = [Disturbance(name, push=(push, 0.0, 0.0)) for name, push in (("to", 9.0), ("fro", -9.0))]
    rules = CollisionRules(0.005, ())
    for collisions, count in product((None, rules), range(3)):
        robot = replace(problem.scene.robot, collisions=collisions)
        scene = replace(problem.scene, robot=robot, disturbances=Disturbances(tuple(pushes[:count])))
        assert scene.is_dear is (collisions is not None and count == 2)
