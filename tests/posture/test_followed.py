"""Postures of a design found near those of another one: the same as when they are looked for anew."""

from __future__ import annotations

import numpy as np
import pytest

from evodesign.evaluation.evaluate import Evaluator
from evodesign.mechanics.agent import HUMAN, ROBOT
from evodesign.posture.check import AgentModel, Checker
from evodesign.posture.results import CaseSolution, Neighbour
from evodesign.problem.build import DesignProblem


def torques(solution: CaseSolution, agent: str) -> np.ndarray:
    return np.array(list(solution.postures[agent].torques.values()))


@pytest.mark.parametrize(("learned", "number"), [(True, 1), (False, 0)])
def test_followed_postures_are_those_of_the_design(
    problem: DesignProblem, evaluator: Evaluator, learned: bool, number: int
) -> None:
    asked = evaluator if learned else Evaluator(problem)
    values = problem.space.unscaled(problem.scene.robot.tree)
    moved = [value * 1.01 for value in values]
    before, anew = (asked.solve(each).cases[number] for each in (values, moved))
    postures = asked.inner.postures[before.case.pair]
    followed = postures.followed(moved, before)
    assert followed is not None
    assert torques(followed, ROBOT) == pytest.approx(torques(anew, ROBOT), abs=1e-4)
    tree = problem.space.resized(problem.scene.robot.tree, moved)
    agents = (problem.scene.robot, tree), (problem.scene.human, problem.scene.human.tree)
    checker = Checker(problem.scene, *(AgentModel.of(*each) for each in agents))
    near = Neighbour(followed, unchecked=True)
    ended = postures.solve(moved, before.case.task, checker, near)
    assert ended.solved
    assert max(ended.residuals.values()) < 1e-5
    for agent in (ROBOT, HUMAN):
        assert torques(ended, agent) == pytest.approx(torques(anew, agent), abs=1e-4)


def test_what_has_no_posture_leads_nowhere(problem: DesignProblem, evaluator: Evaluator) -> None:
    values = problem.space.unscaled(problem.scene.robot.tree)
    solution = evaluator.solve(values).cases[0]
    lost = CaseSolution(solution.case, solution.status, "none")
    assert evaluator.inner.postures[solution.case.pair].followed(values, lost) is None
