"""The paper's experiment: the published setting, the robot as it is, and robots found in two ways.

Source: Sartore et al. 2022, Section IV.
"""

from __future__ import annotations

import math
import time
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

from evodesign import evolve
from evodesign.analysis.front import front
from evodesign.analysis.paper_claims import (
    AT,
    PAPER_ORIGINAL,
    human_claim,
    reach_claim,
    reduction_claim,
    table_claim,
)
from evodesign.errors import Interrupted
from evodesign.pool.registry import make_pool
from evodesign.posture.formulations.codesign import JointSolution
from evodesign.problem.baseline import GENERATION, Baseline, broken_limits, held_at, torque_difference
from evodesign.problem.build import DesignProblem
from evodesign.problem.evaluate import detail_of
from evodesign.problem.factory import evaluation_factory, evaluator_of
from evodesign.records import Evaluation, SearchSettings
from evodesign.report.reproduction import Found, Published, ReproducedRobot, Reproduction
from evodesign.report.scene_models import SceneModels
from evodesign.runlog.header import header_of
from evodesign.runlog.run import RunLog, read_run
from evodesign.searches.base import JOINT_STARTS
from evodesign.searches.registry import make_search
from evodesign.session import Display

__all__ = [
    "Effort",
    "Experiment",
    "reproduction",
]

GRADIENT, EVOLUTION, ORIGINAL = "gradient", "evolution", "original"

SHARE_OF_BASELINE = 0.4
"""Of the time that is given, for the gradient baseline at most."""

PUBLISHED_STARTS = 5
"""Starts of the published setting that are tried until one is solved, the paper's own first."""


@dataclass(frozen=True, slots=True)
class Effort:
    """How much is computed.

    Args:
        starts: of the joint problem.
        evaluations: of the search.
        seed: of both.
        minutes: after which both have ended, with what they have by then.
        jobs, pool: where they run.
    """

    starts: int
    evaluations: int
    seed: int
    minutes: float
    jobs: int
    pool: str


@dataclass(frozen=True, slots=True)
class Experiment:
    """The problem under physical limits, and how it is solved.

    Args:
        problem: with one objective, the cost.
        directory: for the logged runs.
        effort: how much is computed.
        began: when the time given began [s], as `time.monotonic` has it.
        display: shows what is being done.
    """

    problem: DesignProblem
    directory: Path
    effort: Effort
    began: float
    display: Display

    def original(self) -> tuple[ReproducedRobot, float | None]:
        """The unscaled robot at its own best postures, and its reach [m]."""
        problem = self.problem
        with self.display.precompute() as progress:
            evaluator = evaluator_of(problem, self.effort.jobs, progress)
        result = evaluator.solve(problem.space.unscaled(problem.scene.robot.tree))
        cases = tuple(detail_of(case) for case in result.cases if case.solved)
        models = SceneModels.of(problem.scene, result.tree)
        return ReproducedRobot(ORIGINAL, "the robot as it is", models, cases), result.reach.highest

    def found(self, name: str) -> Found:
        """The best robot of a new run, with its logged postures: of the joint problem, or of the search."""
        effort = self.effort
        if name == GRADIENT:
            settings = self.problem.settings(JOINT_STARTS, min(effort.starts, GENERATION), effort.seed)
            run = self._logged(name, settings, effort.starts, SHARE_OF_BASELINE)
            title = "the best robot found by the joint problem"
        else:
            settings = self.problem.settings(seed=effort.seed)
            run = self._logged(name, settings, effort.evaluations, 1.0)
            title = f"the best robot found by {run.header.search.algorithm}"
        return self._best(run, name, title)

    def _logged(self, name: str, settings: SearchSettings, budget: int, share: float) -> RunLog:
        """A logged run that ends with its budget, or with a share of the time."""
        directory, header = self.directory / name, header_of(self.problem, settings, budget)
        end = self.began + 60.0 * self.effort.minutes * share

        def late() -> bool:
            return time.monotonic() > end

        with make_pool(self.effort.pool, self.effort.jobs) as workers:
            with self.display.precompute() as progress:
                factory = evaluation_factory(header, workers, progress)
            try:
                with self.display.search() as observer:
                    return evolve.start(directory, header, factory, workers, observer, stop=late)
            except Interrupted:
                if not late():
                    raise
        run = read_run(directory)
        self.display.note(f"{name}: its time is over after {len(run.evaluations)} of {budget} evaluations")
        return run

    def _best(self, run: RunLog, name: str, title: str) -> Found:
        """The feasible evaluation of least cost."""
        scene = self.problem.scene
        best = front(run.header.objectives, run.evaluations)
        if not best:
            return Found(
                ReproducedRobot(name, title, SceneModels.of(scene, scene.robot.tree), ()), run, None, {}
            )
        design = best[0].assessment.design
        details = {detail.evaluation: detail.cases for detail in run.details}
        models = SceneModels.of(scene, self.problem.space.resized(scene.robot.tree, list(design.values())))
        robot = ReproducedRobot(name, title, models, details[best[0].number])
        (objective,) = run.header.objectives
        return Found(robot, run, best[0].assessment.objectives[objective.name], design)


def reproduction(experiment: Experiment, without: DesignProblem) -> Reproduction:
    """Run everything.

    Args:
        experiment: the problem under physical limits, and how it is solved.
        without: the published setting.
    """
    experiment.display.note("the published setting")
    published = _published(without)
    by_gradient = experiment.found(GRADIENT)
    experiment.display.note("the robot as it is")
    original, highest = experiment.original()
    runs = (by_gradient, experiment.found(EVOLUTION))
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
        torque_norms = (original.torque_norms, one.robot.torque_norms)
        name = one.robot.name
        if not one.run.evaluations:
            experiment.display.note(f"{name}: had no time for a design, so no claim is held against it")
            continue
        claims += [
            reach_claim(name, *torque_norms),
            reduction_claim(name, *torque_norms, least, len(every)),
            human_claim(name, *torque_norms),
        ]
    return Reproduction(published, original, highest, runs, tuple(claims))


def _robot_norm(evaluation: Evaluation, height: float) -> float:
    """The robot's torque norm at a height [N m]; infinite where there is none."""
    norms = {o.case.task.height_m: o.robot_torque_norm for o in evaluation.assessment.cases}
    found = norms.get(height)
    return math.inf if found is None else found


def _published(problem: DesignProblem) -> Published:
    """The setting without limits: the unscaled robot at the heights of the paper, and the optimised one."""
    unscaled = problem.space.genome(problem.space.unscaled(problem.scene.robot.tree))
    held = held_at(problem, unscaled, [task for task in problem.tasks if task.height_m in PAPER_ORIGINAL])
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
    tree = problem.space.resized(problem.scene.robot.tree, solution.design)
    cases = tuple(detail_of(case) for case in solution.cases if case.solved)
    return ReproducedRobot(name, title, SceneModels.of(problem.scene, tree), cases)
