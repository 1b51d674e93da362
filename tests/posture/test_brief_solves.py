"""Under several disturbances with bodies kept apart slow solves are given up, unless all of them are."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from types import SimpleNamespace

import pytest

from evodesign.collision.rules import CollisionRules
from evodesign.mechanics.disturbance import Disturbance, Disturbances
from evodesign.nlp.solver import RawSolution
from evodesign.posture.formulations.base import Setting
from evodesign.posture.formulations.joint import JointPostures
from evodesign.posture.postures import PostureProblem, Symmetry
from evodesign.problem.build import DesignProblem
from evodesign.records import Hold, Status

NEEDED = {"quick": 10, "slow": 90, "hopeless": 999}
"""Iterations of a solve by where it starts; hopeless ones find no posture."""


class Counted:
    """Solves that need some iterations."""

    def __init__(self, limit: int = 300) -> None:
        self.limit = limit
        self.asked: list[tuple[str, int]] = []

    @property
    def brief(self) -> Counted:
        """Up to 60 of them."""
        other = Counted(60)
        other.asked = self.asked
        return other

    def solve(self, parameters: object, start: str) -> SimpleNamespace:
        """What a start leads to."""
        self.asked.append((start, self.limit))
        status = Status.SOLVED if NEEDED[start] <= self.limit else Status.ITERATION_LIMIT
        return SimpleNamespace(status=Status.INFEASIBLE if start == "hopeless" else status)


@pytest.fixture
def postures(problem: DesignProblem) -> JointPostures:
    """Of the default problem, whose solver is to be taken for another one."""
    setting = Setting(problem.scene, problem.space, problem.weights, problem.options)
    made = PostureProblem(setting, Symmetry.ON)._formulation("symmetric", Hold(height_m=1.0), "ipopt")
    assert isinstance(made, JointPostures)
    return made


def ends(
    postures: JointPostures, solver: Counted, *starts: str, dear: bool = True
) -> list[tuple[str, RawSolution]]:
    """Where starts lead to."""
    postures._setting = SimpleNamespace(scene=SimpleNamespace(is_dear=dear))
    postures.__dict__["_solver"] = solver
    postures._begun = lambda start, parameters: start
    return [(name, end.status) for name, end in postures._ends({}, [(start, start) for start in starts])]


def test_slow_ones_are_given_up_where_another_one_succeeds(postures: JointPostures) -> None:
    solver = Counted()
    found = ends(postures, solver, "slow", "quick")
    assert found == [("slow", Status.ITERATION_LIMIT), ("quick", Status.SOLVED)]
    assert solver.asked == [("slow", 60), ("quick", 60)]


def test_all_are_solved_to_their_ends_where_none_succeeds_but_those_that_have_ended(
    postures: JointPostures,
) -> None:
    solver = Counted()
    found = ends(postures, solver, "slow", "hopeless")
    assert found == [("slow", Status.SOLVED), ("hopeless", Status.INFEASIBLE)]
    assert solver.asked == [("slow", 60), ("hopeless", 60), ("slow", 300)]


def test_no_solve_is_brief_where_solves_are_quick(postures: JointPostures) -> None:
    solver = Counted()
    found = ends(postures, solver, "slow", "quick", dear=False)
    assert found == [("slow", Status.SOLVED), ("quick", Status.SOLVED)]
    assert solver.asked == [("slow", 300), ("quick", 300)]


def test_scenes_are_dear_with_bodies_apart_and_several_disturbances(problem: DesignProblem) -> None:
    pushes = [Disturbance(name, push=(push, 0.0, 0.0)) for name, push in (("to", 9.0), ("fro", -9.0))]
    rules = CollisionRules(0.005, ())
    for collisions, count in product((None, rules), range(3)):
        robot = replace(problem.scene.robot, collisions=collisions)
        scene = replace(problem.scene, robot=robot, disturbances=Disturbances(tuple(pushes[:count])))
        assert scene.is_dear is (collisions is not None and count == 2)
