"""Reach and postures of one design: what is tried where a case has ruled the design out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import msgspec
import numpy as np
import pytest

from evodesign.evaluation.design_solver import LESS
from evodesign.evaluation.evaluate import Evaluator
from evodesign.nlp.method import MethodName
from evodesign.nlp.program import Start
from evodesign.nlp.solver import SolverCache
from evodesign.posture.formulations.base import Setting
from evodesign.posture.postures import PostureProblem, Symmetry
from evodesign.posture.precompute.precomputed import Precomputed
from evodesign.posture.results import Attempt, CaseSolution, Neighbour
from evodesign.posture.seeking.start_portfolio import Coverage, StartPortfolio
from evodesign.problem.build import DesignProblem, build_problem
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
        def solve(
            self: PostureProblem, design: object, task: Hold, *others: object, polished: bool = False
        ) -> CaseSolution:
            asked.append((way, task.height_m))
            return failed(task)

        return solve

    monkeypatch.setattr(PostureProblem, "solve", answer("solve"))
    monkeypatch.setattr(PostureProblem, "begun", answer("begun"))
    result = Evaluator(three).solve(problem.space.unscaled(problem.scene.robot.tree))
    assert asked == [("begun", 0.9), ("begun", 1.0), ("begun", 1.1), ("solve", 0.9)]
    reasons = [solution.reason for solution in result.cases]
    assert [LESS in reason for reason in reasons] == [False, True, True]


def test_a_hold_that_is_not_found_begins_at_the_nearest_others_and_at_the_ends_of_reach(
    problem: DesignProblem, known: Precomputed, monkeypatch: pytest.MonkeyPatch
) -> None:
    three = replace(problem, tasks=tuple(Hold(height_m=height) for height in (0.8, 1.0, 1.2)))
    begin, given = PostureProblem.begun, []

    def begun(
        self: PostureProblem, design: object, task: Hold, *others: object, polished: bool
    ) -> CaseSolution:
        return failed(task) if task.height_m == 0.8 else begin(self, design, task, *others, polished=polished)

    def solve(
        self: PostureProblem,
        design: object,
        task: Hold,
        checker: object,
        neighbour: object,
        others: Sequence[Neighbour],
        starts: Sequence[Start],
    ) -> CaseSolution:
        given.append(([each.solution.case.task.heights[0] for each in others], starts))
        found = begin(self, design, task, checker, others[0], polished=False)
        return found if found.solved else failed(task)

    monkeypatch.setattr(PostureProblem, "begun", begun)
    monkeypatch.setattr(PostureProblem, "solve", solve)
    result = Evaluator(three, known).solve(problem.space.unscaled(problem.scene.robot.tree))
    assert all(solution.solved for solution in result.cases)
    assert [solution.case.task.heights[0] for solution in result.cases] == [0.8, 1.0, 1.2]
    [(heights, ends)] = given
    assert heights == [1.0, 1.2]
    assert [{name.split(".")[0] for name in end} for end in ends] == [{"robot"}, {"robot"}]


def test_a_posture_near_the_end_of_reach_is_found_from_there(
    problem: DesignProblem, known: Precomputed
) -> None:
    """Where the portfolio leads nowhere, as it has no start from which this height is reached."""
    values = problem.space.unscaled(problem.scene.robot.tree)
    evaluator = Evaluator(problem, known)
    highest = evaluator.solve(values).reach.highest
    assert highest is not None
    nearly = replace(problem, tasks=(Hold(height_m=highest - 0.004),))
    astray = {"robot.base_position": [-3.0, 0.0, 0.2]}
    portfolio = StartPortfolio((astray,), Coverage(0, 0, 0.0))
    result = Evaluator(
        nearly,
        replace(known, postures={Case(person="", payload="", task=nearly.tasks[0]): portfolio}),
    ).solve(values)
    assert result.cases[0].solved, result.cases[0].reason


def test_what_the_robot_does_best_with_one_load_is_tried_with_another_one(problem: DesignProblem) -> None:
    """Two loads of one size, each with one start, of which one leads to a posture that costs more."""
    load = '[payload]\nsize_m = [0.5, 0.5, 0.025]\nmass_kg = 5.0\ngrasp = "point"'
    text = problem.source.text.replace("heights_m = [0.8, 1.0, 1.2]", "heights_m = [1.0]")
    loads = (load.replace("[payload]", "[[payload]]").replace("5.0", mass) for mass in ("5.0", "5.5"))
    source = msgspec.structs.replace(problem.source, text=text.replace(load, "\n".join(loads)))
    two = replace(build_problem(source), options=problem.options)
    (task,), (light, heavy) = two.tasks, two.scenes
    design = two.space.unscaled(two.scene.robot.tree)
    setting, solvers = Setting(heavy, two.space, two.weights, two.options), SolverCache()
    alone = PostureProblem(setting, Symmetry.ON, solvers=solvers)
    landscape, rng = alone.landscape(task), np.random.default_rng(1)
    good = landscape.solve(design, landscape.starts[1])
    ends = (landscape.solve(design, landscape.free_start(rng)) for _ in range(20))
    bad = next(end for end in ends if end.status is Status.SOLVED and end.cost > 1.1 * good.cost)

    def costs(*starts: Start) -> list[float]:
        known = {
            scene.case(task): StartPortfolio((start,), Coverage(0, 0, 0.0))
            for scene, start in zip((light, heavy), starts, strict=True)
        }
        cases = Evaluator(two, Precomputed(postures=known), solvers).solve(design).cases
        return [each.attempt.cost for each in cases if each.attempt]

    alike = costs(good.values, good.values)
    assert alike[1] == pytest.approx(good.cost, rel=1e-6)
    assert costs(good.values, bad.values) == pytest.approx(alike, rel=1e-6)
    assert costs(bad.values, good.values) == pytest.approx(alike, rel=1e-6)
    assert costs(bad.values, bad.values)[1] == pytest.approx(bad.cost, rel=1e-3)
