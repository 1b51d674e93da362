"""The paper's experiment: the published setting, the robot as it is, and robots found in two ways.

Source: Sartore et al. 2022, Section IV.
"""

from __future__ import annotations

import math
from collections import Counter

from evodesign.analysis.front import front
from evodesign.evaluation.baseline import GENERATION, Baseline, broken_limits, held_at, torque_difference
from evodesign.evaluation.evaluate import detail_of
from evodesign.posture.formulations.codesign import JointSolution
from evodesign.problem.build import DesignProblem
from evodesign.records import Evaluation
from evodesign.report.scene_models import SceneModels
from evodesign.reproduction.claims2022 import (
    AT,
    PAPER_ORIGINAL,
    human_claim,
    reach_claim,
    reduction_claim,
    table_claim,
)
from evodesign.reproduction.experiment import (
    MEASURED,
    STRICTER,
    Experiment,
    changed_problem,
    reproduced,
    torque_norms,
)
from evodesign.reproduction.files2022 import Found, Published, ReproducedRobot, Reproduction
from evodesign.runlog.run import RunLog
from evodesign.searches.base import JOINT_STARTS
from evodesign.searches.registry import make_search

GRADIENT, EVOLUTION, ORIGINAL = "gradient", "evolution", "original"

SHARE_OF_BASELINE = 0.4
"""Of the time that is given, for the gradient baseline at most."""

PUBLISHED_STARTS = 5
"""Starts of the published setting that are tried until one is solved, the paper's own first."""


def reproduction(experiment: Experiment, without: DesignProblem, starts: int) -> Reproduction:
    """Run everything.

    Args:
        experiment: the problem under physical limits, with one objective, the cost.
        without: the published setting.
        starts: of the joint problem.
    """
    problem = experiment.problem
    problems = {name: changed_problem(problem, tables) for name, tables in STRICTER.items()}
    experiment.display.note("the published setting")
    published = _published(without)
    by_gradient = _found(experiment, GRADIENT, starts)
    space, tree = problem.space, problem.scene.designed_tree
    robots = {ORIGINAL: space.unscaled(tree)}
    as_it_is = experiment.solved(problem, robots, "the robot as it is")[ORIGINAL]
    original = reproduced(problem, ORIGINAL, "the robot as it is", as_it_is)
    runs = (by_gradient, _found(experiment, EVOLUTION, starts))
    claims = [
        table_claim(
            "published setting",
            published.original.torque_norms,
            published.optimised.torque_norms,
            published.broken,
        )
    ]
    every = [evaluation for one in runs for evaluation in one.run.evaluations if evaluation.feasible]
    least = min((_robot_norm(evaluation, AT) for evaluation in every), default=math.inf)
    for one in runs:
        norms = (original.torque_norms, one.robot.torque_norms)
        name = one.robot.name
        if not one.run.evaluations:
            experiment.display.note(f"{name}: had no time for a design, so no claim is held against it")
            continue
        claims += [
            reach_claim(name, *norms),
            reduction_claim(name, *norms, least, len(every)),
            human_claim(name, *norms),
        ]
    robots |= {one.robot.name: tuple(one.design.values()) for one in runs if one.design}
    problems["with a measured person"] = changed_problem(problem, MEASURED)
    stricter = {
        name: {
            robot: torque_norms(result)
            for robot, result in experiment.solved(each, robots, f"the robots {name}").items()
        }
        for name, each in problems.items()
    }
    measured = stricter.pop("with a measured person")
    highest = as_it_is.reach.highest
    return Reproduction(published, original, highest, runs, tuple(claims), stricter, measured)


def _found(experiment: Experiment, name: str, starts: int) -> Found:
    """The best robot of a new run, with its logged postures: of the joint problem, or of the search."""
    effort = experiment.effort
    if name == GRADIENT:
        settings = experiment.problem.settings(JOINT_STARTS, min(starts, GENERATION), effort.seed)
        run = experiment.logged(name, settings, starts, SHARE_OF_BASELINE)
        title = "the best robot found by the joint problem"
    else:
        settings = experiment.problem.settings(seed=effort.seed)
        run = experiment.logged(name, settings, effort.evaluations, 1.0)
        title = f"the best robot found by {run.header.search.algorithm}"
    return _best(experiment.problem, run, name, title)


def _best(problem: DesignProblem, run: RunLog, name: str, title: str) -> Found:
    """The feasible evaluation of least cost."""
    scene = problem.scene
    best = front(run.header.objectives, run.evaluations)
    if not best:
        return Found(
            ReproducedRobot(name, title, SceneModels.of(scene, scene.designed_tree), ()), run, None, {}
        )
    design = best[0].assessment.design
    details = {detail.evaluation: detail.cases for detail in run.details}
    models = SceneModels.of(scene, problem.space.resized(scene.designed_tree, list(design.values())))
    robot = ReproducedRobot(name, title, models, details[best[0].number])
    (objective,) = run.header.objectives
    return Found(robot, run, best[0].assessment.objectives[objective.name], design)


def _robot_norm(evaluation: Evaluation, height: float) -> float:
    """The robot's torque norm at a height [N m]; infinite where there is none."""
    norms = {o.case.task.heights[0]: o.robot_torque_norm for o in evaluation.assessment.cases}
    found = norms.get(height)
    return math.inf if found is None else found


def _published(problem: DesignProblem) -> Published:
    """The setting without limits: the unscaled robot at the heights of the paper, and the optimised one."""
    unscaled = problem.space.genome(problem.space.unscaled(problem.scene.designed_tree))
    held = held_at(problem, unscaled, [task for task in problem.holds if task.height_m in PAPER_ORIGINAL])
    baseline = Baseline(problem)
    search = make_search(problem.settings(JOINT_STARTS, PUBLISHED_STARTS, problem.search.seed))
    ended: list[JointSolution] = []
    for genome in search.ask():
        ended.append(baseline.solve(genome))
        if ended[-1].solved:
            break
    optimised = ended[-1]
    solved = [solution for solution in (held, optimised) if solution.solved]
    return Published(
        original=_robot(problem, "published_original", "published setting: the robot as it is", held),
        optimised=_robot(problem, "published_optimised", "published setting: the optimised robot", optimised),
        broken=broken_limits(solved),
        difference=max((torque_difference(problem, solution) for solution in solved), default=0.0),
        statuses=Counter(solution.attempt.status for solution in (held, *ended)),
    )


def _robot(problem: DesignProblem, name: str, title: str, solution: JointSolution) -> ReproducedRobot:
    tree = problem.space.resized(problem.scene.designed_tree, solution.design)
    cases = tuple(detail_of(case) for case in solution.cases if case.solved)
    return ReproducedRobot(name, title, SceneModels.of(problem.scene, tree), cases)
