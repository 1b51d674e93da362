"""The paper's experiment: the published setting, the robot as it is, and robots found in two ways."""

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
    Claim,
    human_claim,
    reach_claim,
    reduction_claim,
    table_claim,
)
from evodesign.cli.baseline import GENERATION
from evodesign.cli.making import making
from evodesign.cli.output import show_notes
from evodesign.cli.progress import observer
from evodesign.errors import Interrupted
from evodesign.pool.registry import make_pool
from evodesign.posture.formulations.codesign import JointSolution
from evodesign.problem.baseline import Baseline
from evodesign.problem.build import Problem
from evodesign.problem.evaluate import detail_of
from evodesign.problem.factory import evaluation_factory, evaluator_of
from evodesign.problem.paper_setting import broken_limits, held_at, torque_difference
from evodesign.records import Evaluation, SearchSettings, Status
from evodesign.report.reproduction import ReproducedRobot
from evodesign.report.scene_models import SceneModels
from evodesign.runlog.header import header_of
from evodesign.runlog.run import Run, read_run
from evodesign.search.base import JOINT_STARTS
from evodesign.search.registry import make_search

__all__ = ["Effort", "Found", "Published", "Reproduction", "reproduction"]

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
class Published:
    """What the published setting gives; a robot without heights had no start that was solved.

    Args:
        original, optimised: robots and postures.
        broken: physical limits that the postures break, in words.
        difference: largest difference of a torque from the paper's formula [N m].
        statuses: how the starts ended.
    """

    original: ReproducedRobot
    optimised: ReproducedRobot
    broken: str
    difference: float
    statuses: Counter[Status]


@dataclass(frozen=True, slots=True)
class Found:
    """The best robot of a run; without heights when the run holds no feasible one."""

    robot: ReproducedRobot
    run: Run
    cost: float | None
    design: dict[str, float]

    @property
    def statuses(self) -> Counter[Status]:
        """How the evaluations ended."""
        return Counter(evaluation.assessment.status for evaluation in self.run.evaluations)


@dataclass(frozen=True, slots=True)
class Reproduction:
    """Everything that is shown.

    Args:
        published: the paper's setting, without limits.
        original: the robot as it is, with limits.
        highest: load that it can hold [m]; None when not solved.
        found: the best robots with limits: by gradients, by evolution.
        claims: each with its verdict.
    """

    published: Published
    original: ReproducedRobot
    highest: float | None
    found: tuple[Found, ...]
    claims: tuple[Claim, ...]


def reproduction(
    with_limits: Problem, without: Problem, directory: Path, effort: Effort, began: float
) -> Reproduction:
    """Run everything.

    Args:
        with_limits: the problem under physical limits.
        without: the published setting.
        directory: for the logged runs.
        effort: how much.
        began: when the time given began [s], as `time.monotonic` has it.
    """
    show_notes(["the published setting"])
    published = _published(without)
    by_gradient = _searched(with_limits, GRADIENT, directory, effort, began)
    show_notes(["the robot as it is"])
    original, highest = _original(with_limits, effort.jobs)
    runs = (by_gradient, _searched(with_limits, EVOLUTION, directory, effort, began))
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
        claims += [
            reach_claim(name, *torque_norms),
            reduction_claim(name, *torque_norms, least, len(every)),
            human_claim(name, *torque_norms),
        ]
    return Reproduction(published, original, highest, runs, tuple(claims))


def _searched(problem: Problem, name: str, directory: Path, effort: Effort, began: float) -> Found:
    """The best robot of a new run: of the joint problem, or of the problem's search."""
    if name == GRADIENT:
        settings = problem.settings(JOINT_STARTS, min(effort.starts, GENERATION), effort.seed)
        end = began + 60.0 * effort.minutes * SHARE_OF_BASELINE
        return _best(problem, _logged(problem, settings, effort.starts, directory / name, effort, end), name)
    table = problem.search
    settings = problem.settings(table.algorithm, table.population, effort.seed)
    end = began + 60.0 * effort.minutes
    return _best(problem, _logged(problem, settings, effort.evaluations, directory / name, effort, end), name)


def _robot_norm(evaluation: Evaluation, height: float) -> float:
    """The robot's torque norm at a height [N m]; infinite where there is none."""
    norms = {outcome.height_m: outcome.robot_torque_norm for outcome in evaluation.assessment.heights}
    found = norms.get(height)
    return math.inf if found is None else found


def _published(problem: Problem) -> Published:
    """The setting without limits: the unscaled robot at the heights of the paper, and the optimised one."""
    unscaled = problem.space.genome(problem.space.unscaled(problem.scene.robot.tree))
    held = held_at(problem, unscaled, tuple(height for height in problem.heights if height in PAPER_ORIGINAL))
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


def _robot(problem: Problem, name: str, title: str, solution: JointSolution) -> ReproducedRobot:
    tree = problem.space.resized(problem.scene.robot.tree, solution.design)
    heights = tuple(detail_of(height, problem.scene) for height in solution.heights if height.solved)
    return ReproducedRobot(name, title, SceneModels.of(problem.scene, tree), heights)


def _original(problem: Problem, jobs: int) -> tuple[ReproducedRobot, float | None]:
    """The unscaled robot at its own best postures, and its reach [m]."""
    with making() as progress:
        evaluator = evaluator_of(problem, jobs, progress)
    result = evaluator.solve(problem.space.unscaled(problem.scene.robot.tree))
    heights = tuple(detail_of(height, problem.scene) for height in result.heights if height.solved)
    robot = ReproducedRobot(
        ORIGINAL, "the robot as it is", SceneModels.of(problem.scene, result.tree), heights
    )
    return robot, result.reach.highest


def _logged(
    problem: Problem, settings: SearchSettings, budget: int, directory: Path, effort: Effort, end: float
) -> Run:
    """A logged run that ends with its budget or with its time."""
    header = header_of(problem, settings, budget)

    def late() -> bool:
        return time.monotonic() > end

    with make_pool(effort.pool, effort.jobs) as workers:
        with making() as progress:
            factory = evaluation_factory(header, workers, progress)
        try:
            with observer() as watching:
                return evolve.start(directory, header, factory, workers, watching, stop=late)
        except Interrupted:
            if not late():
                raise
    run = read_run(directory)
    show_notes([f"{directory.name}: its time is over after {len(run.evaluations)} of {budget} evaluations"])
    return run


def _best(problem: Problem, run: Run, name: str) -> Found:
    """The feasible evaluation of least cost, with its logged postures."""
    (objective,) = run.header.objectives
    title = (
        f"the best robot found by {'the joint problem' if name == GRADIENT else run.header.search.algorithm}"
    )
    best = front(run.header.objectives, run.evaluations)
    if not best:
        return Found(
            ReproducedRobot(name, title, SceneModels.of(problem.scene, problem.scene.robot.tree), ()),
            run,
            None,
            {},
        )
    design = best[0].assessment.design
    details = {detail.evaluation: detail.heights for detail in run.details}
    tree = problem.space.resized(problem.scene.robot.tree, list(design.values()))
    robot = ReproducedRobot(name, title, SceneModels.of(problem.scene, tree), details[best[0].number])
    return Found(robot, run, best[0].assessment.objectives[objective.name], design)
