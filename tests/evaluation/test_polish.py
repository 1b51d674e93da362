"""Polishing designs of the point-grasp problem."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from evodesign.body.material import CATALOGUE
from evodesign.design.space import DesignSpace
from evodesign.errors import InputError
from evodesign.evaluation.evaluate import Evaluator
from evodesign.evaluation.polish import Step, aim_of, polish
from evodesign.problem.build import DesignProblem
from evodesign.problem.designs import designs_text, read_designs
from evodesign.records import Genome, Hold

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def unscaled(problem: DesignProblem) -> Genome:
    return problem.space.genome(problem.space.unscaled(problem.scene.robot.tree))


def test_one_objective_gets_better_and_every_height_is_held(
    problem: DesignProblem, evaluator: Evaluator, unscaled: Genome
) -> None:
    seen: list[Step] = []
    done = polish(evaluator, unscaled, aim_of(problem, {"robot_torque": 1.0}, ""), 6, seen.append)
    assert done.after.objectives["robot_torque"] < 0.8 * done.before.objectives["robot_torque"]
    assert done.after.violation == 0.0
    assert done.evaluations == 6
    assert [step.number for step in seen] == [2, 3, 4, 5, 6]


def test_height_at_the_edge_of_reach_stays_within(problem: DesignProblem, unscaled: Genome) -> None:
    """Shorter arms and legs would need less torque, but the unscaled robot only just reaches this height."""
    edge = replace(problem, tasks=(Hold(height_m=1.277),))
    seen: list[Step] = []
    done = polish(Evaluator(edge), unscaled, aim_of(edge, {"robot_torque": 1.0}, ""), 8, seen.append)
    assert done.before.reach is not None
    assert done.before.reach.highest_m == pytest.approx(1.278, abs=1e-3)
    assert done.after.objectives["robot_torque"] < 0.95 * done.before.objectives["robot_torque"]
    assert done.after.violation == 0.0
    missed = [step for step in seen if step.assessment.violation != 0.0]
    assert len(missed) <= 2, "the descent knows where reach ends"


def test_polished_design_has_the_results_that_were_reported(
    problem: DesignProblem, evaluator: Evaluator, unscaled: Genome
) -> None:
    """Also after a way through a file of designs, whose numbers are exact."""
    done = polish(evaluator, unscaled, aim_of(problem, {"reach_height": 1.0}, ""), 3, lambda step: None)
    text = designs_text("polished", {"better": done.values}, problem.space, "a remark")
    values = read_designs(text, "polished.toml", problem.space, problem.scene.robot.tree)["better"]
    assert values == done.values
    again = evaluator.assessment(values, evaluator.solve(values))
    assert again.objectives == done.after.objectives


def test_without_weights_nothing_gets_worse(
    problem: DesignProblem, evaluator: Evaluator, unscaled: Genome
) -> None:
    done = polish(evaluator, unscaled, aim_of(problem, {}, ""), 8, lambda step: None)
    before, after = done.before.objectives, done.after.objectives
    assert after["robot_torque"] <= before["robot_torque"] * (1.0 + 1e-6)
    assert after["human_torque"] <= before["human_torque"] * (1.0 + 1e-6)
    assert after["reach_height"] >= before["reach_height"] * (1.0 - 1e-6)
    assert after["robot_torque"] < before["robot_torque"] * 0.99, "and something gets better"


def test_design_that_misses_a_height_is_refused(problem: DesignProblem, evaluator: Evaluator) -> None:
    smallest = tuple(np.zeros(len(problem.space.parameters)).tolist())
    with pytest.raises(InputError, match="every required height"):
        polish(evaluator, smallest, aim_of(problem, {}, ""), 3, lambda step: None)


@pytest.mark.parametrize(
    ("weights", "words"),
    [({"robot_torqe": 1.0}, "did you mean 'robot_torque'"), ({"robot_torque": -1.0}, "positive weight")],
)
def test_wrong_weights_are_explained(problem: DesignProblem, weights: dict[str, float], words: str) -> None:
    with pytest.raises(InputError, match=words):
        aim_of(problem, weights, "--weights")


def test_polish_moves_lengths_and_leaves_materials_as_they_are(problem: DesignProblem) -> None:
    choices = (CATALOGUE["abs"], CATALOGUE["aluminium_6061"])
    parameters = tuple(
        replace(each, lower=1050.0, upper=2700.0, materials=choices) if each.kind == "density" else each
        for each in problem.space.parameters
    )
    chosen = replace(problem, space=DesignSpace(parameters), tasks=(Hold(height_m=1.0),), start=())
    genome = (*(0.45,) * 8, *(0.25, 0.75) * 4)
    done = polish(Evaluator(chosen), genome, aim_of(chosen, {"robot_torque": 1.0}, ""), 4, lambda step: None)
    assert done.after.objectives["robot_torque"] < done.before.objectives["robot_torque"]
    before, after = done.before.design, done.after.design
    moved = {name for name in before if before[name] != after[name]}
    assert moved
    assert all(name.startswith("length.") for name in moved)
    assert [after[name] for name in after if name.startswith("density.")] == [1050.0, 2700.0] * 4
