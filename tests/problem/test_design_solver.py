"""Reach and postures of one design: what is tried where a case has ruled the design out."""

from __future__ import annotations

from dataclasses import replace

import pytest

from evodesign.nlp.method import MethodName
from evodesign.posture.postures import PostureProblem
from evodesign.posture.results import Attempt, CaseSolution
from evodesign.problem.build import DesignProblem
from evodesign.problem.design_solver import LESS
from evodesign.problem.evaluate import Evaluator
from evodesign.records import Case, Hold, Status, Task

HEIGHTS = (0.9, 1.0, 1.1)


def failed(task: Task) -> CaseSolution:
    attempt = Attempt("whole", "start 1", Status.INFEASIBLE, "no", 10, 0.1, 1.0, MethodName.IPOPT)
    return CaseSolution(Case(task=task), Status.INFEASIBLE, f"none at {task}", attempts=(attempt,))


def test_after_a_case_without_posture_no_refuge_is_sought_in_others(
    problem: DesignProblem, monkeypatch: pytest.MonkeyPatch
) -> None:
    three = replace(problem, tasks=tuple(Hold(height_m=height) for height in HEIGHTS))
    asked: list[tuple[str, float]] = []

    def answer(way: str) -> object:
        def solve(self: PostureProblem, design: object, task: Hold, *others: object) -> CaseSolution:
            asked.append((way, task.height_m))
            return failed(task)

        return solve

    monkeypatch.setattr(PostureProblem, "solve", answer("solve"))
    monkeypatch.setattr(PostureProblem, "begun", answer("begun"))
    result = Evaluator(three).solve(problem.space.unscaled(problem.scene.robot.tree))
    assert asked == [("solve", 0.9), ("begun", 1.0), ("begun", 1.1)]
    reasons = [solution.reason for solution in result.cases]
    assert [LESS in reason for reason in reasons] == [False, True, True]
