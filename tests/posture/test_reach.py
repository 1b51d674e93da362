"""The reach problem's interval is where postures exist."""

from __future__ import annotations

from dataclasses import replace

import msgspec
import pytest

from evodesign.evaluation.evaluate import Evaluator
from evodesign.posture.check import AgentModel, Checker
from evodesign.posture.formulations.reach import HIGHEST, LOWEST
from evodesign.posture.solution_derivative import ReachDerivative
from evodesign.problem.build import DesignProblem
from evodesign.problem.designs import read_designs
from evodesign.problem.file import DescriptorTable
from evodesign.records import SUM, Hold, Status


def design(problem: DesignProblem, name: str) -> tuple[float, ...]:
    (text,) = (text for file, text in problem.source.files.items() if file.endswith("icub.toml"))
    return read_designs(text, "icub.toml", problem.space, problem.scene.robot.tree)[name]


@pytest.mark.parametrize(("name", "highest"), [("unscaled", 1.27), ("paper_start", 1.51)])
def test_highest_load_with_arms_held_forward_is_the_papers(
    name: str, highest: float, problem: DesignProblem
) -> None:
    """The paper: the original robot reaches 1.2 m and not 1.5 m, the optimised one 1.5 m.

    The fixed starts lead to arms held forward, as there; the seeds also to arms raised over the head.
    """
    result = Evaluator(problem).solve(design(problem, name))
    assert result.reach.status is Status.SOLVED
    assert result.reach.highest == pytest.approx(highest, abs=0.03)


def test_raised_arms_reach_between_the_papers_heights(problem: DesignProblem, evaluator: Evaluator) -> None:
    """Also with arms raised the original robot reaches 1.2 m and not 1.5 m."""
    highest = evaluator.solve(design(problem, "unscaled")).reach.highest
    assert highest is not None
    assert 1.3 < highest < 1.5


def test_postures_end_where_reach_ends(problem: DesignProblem) -> None:
    """Both from the fixed starts: at heights that are not required there are no seeds of postures."""
    evaluator = Evaluator(problem)
    values = problem.space.unscaled(problem.scene.robot.tree)
    result = evaluator.solve(values)
    scene = problem.scene
    checker = Checker(
        scene, AgentModel.of(scene.robot, result.tree), AgentModel.of(scene.human, scene.human.tree)
    )
    assert result.reach.highest is not None
    (postures,) = evaluator.inner.postures.values()
    below = postures.solve(values, Hold(height_m=result.reach.highest - 0.005), checker)
    above = postures.solve(values, Hold(height_m=result.reach.highest + 0.02), checker)
    assert below.status is Status.SOLVED
    assert above.status is not Status.SOLVED
    assert above.instants == ()
    assert "no posture found" in above.reason


def test_height_out_of_reach_is_a_violation_and_has_no_torque(
    problem: DesignProblem, evaluator: Evaluator
) -> None:
    shortest = tuple(0.0 if p.kind == "length" else 0.5 for p in problem.space.parameters)
    found = evaluator.assess(shortest).assessment
    assert found.reach is not None
    assert found.reach.highest_m is not None
    expected = sum(max(0.0, task.height_m - found.reach.highest_m) for task in problem.tasks)
    assert expected > 0.0
    assert found.violation == pytest.approx(expected)
    assert found.status is Status.INFEASIBLE
    assert "robot_torque" not in found.objectives
    assert "out of reach" in found.reason
    assert found.objectives["reach_height"] == found.reach.highest_m


def test_longer_arms_reach_higher(problem: DesignProblem, evaluator: Evaluator) -> None:
    values = list(problem.space.unscaled(problem.scene.robot.tree))
    names = [parameter.name for parameter in problem.space.parameters]
    longer = list(values)
    longer[names.index("length.forearm")] = 1.5
    before, after = (evaluator.solve(v).reach.highest for v in (values, longer))
    assert before is not None
    assert after is not None
    assert after > before + 0.03


def test_no_load_is_sought_lower_than_is_asked_for(problem: DesignProblem) -> None:
    """A tenth of a metre below the lowest task, or the highest load of who holds none of them."""
    values = problem.space.unscaled(problem.scene.robot.tree)
    lowest = min(height for task in problem.tasks for height in task.heights)
    asked = Evaluator(problem).solve(values).reach
    whole = Evaluator(replace(problem, whole_reach=True)).solve(values).reach
    assert problem.lowest_asked == pytest.approx(lowest - 0.1)
    assert asked.lowest == pytest.approx(lowest - 0.1, abs=1e-6)
    assert asked.or_lower
    assert "or lower" in asked.reason
    assert whole.lowest is not None
    assert whole.lowest < lowest - 0.3
    assert not whole.or_lower
    assert asked.highest == pytest.approx(whole.highest, abs=1e-6)
    beyond = Evaluator(replace(problem, tasks=(Hold(height_m=1.9),))).solve(values).reach
    assert beyond.highest == pytest.approx(whole.highest, abs=1e-6)
    assert beyond.lowest == beyond.highest
    assert beyond.or_lower
    nearly = Evaluator(replace(problem, tasks=(Hold(height_m=whole.highest + 0.099),))).solve(values).reach
    assert nearly.lowest == pytest.approx(whole.highest - 0.001, abs=1e-6)


def test_the_lowest_load_that_is_asked_for_moves_with_no_design(problem: DesignProblem) -> None:
    """But that of a design which holds none of the tasks moves with its highest load."""
    values = problem.space.unscaled(problem.scene.robot.tree)
    (asked,), (beyond,) = (
        Evaluator(each).inner.reaches.values()
        for each in (problem, replace(problem, tasks=(Hold(height_m=1.9),)))
    )
    still = asked.derivative(values, LOWEST)
    highest, lowest = (beyond.derivative(values, sense) for sense in (HIGHEST, LOWEST))
    assert isinstance(still, ReachDerivative)
    assert not still.slope.any()
    assert isinstance(highest, ReachDerivative)
    assert isinstance(lowest, ReachDerivative)
    assert lowest.slope.any()
    assert lowest.slope.tolist() == highest.slope.tolist()


@pytest.mark.parametrize("name", ["lowest_reach", f"lowest_reach{SUM}highest_reach"])
def test_a_search_that_tells_designs_apart_by_their_lowest_load_asks_for_it(
    name: str, problem: DesignProblem
) -> None:
    table = DescriptorTable(name=name, lower=0.0, upper=1.0)
    search = msgspec.structs.replace(problem.search, descriptor=(table,))
    assert replace(problem, search=search).lowest_asked == 0.0
