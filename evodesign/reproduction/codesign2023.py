"""The sequel's experiment: its robots with its people and loads at their best postures, and our own search.

The search minimises the sequel's cost and, because that counts the robot's torques a hundredth, robot torque
as well. Shown is its design of least robot torque among those that cost no more than the robot of the
sequel's genetic algorithm; where there is none, of least cost.

Source: Sartore et al. 2023, arXiv 2312.07459, and its published code.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec

from evodesign.errors import InputError
from evodesign.problem.build import DesignProblem
from evodesign.problem.designs import read_designs
from evodesign.problem.named_files import read_text
from evodesign.problem.shipped import SHIPPED
from evodesign.quantities.design_result import DesignResult
from evodesign.quantities.objectives import bodies_apart, objective_value
from evodesign.records import Evaluation
from evodesign.reproduction.claims2022 import Claim
from evodesign.reproduction.claims2023 import (
    GA,
    LOGGED,
    RobotFigures,
    SearchFigures,
    failure_claim,
    gain_claim,
    log_claim,
    order_claim,
    robot_claim,
    search_claim,
)
from evodesign.reproduction.experiment import STRICTER, Experiment, changed_problem, chosen, value_of
from evodesign.reproduction.files2022 import write_robot
from evodesign.runlog.run import RunLog
from evodesign.tree.model import Tree

OURS = "search"
COST, ROBOT_TORQUE = "paper2023_cost", "robot_torque"
ROBOTS = SHIPPED.parent / "populations" / "sartore2023_robots.toml"


def sequel_reproduction(experiment: Experiment) -> SequelReproduction:
    """Run everything.

    Raises:
        InputError: the problem does not minimise the sequel's cost and robot torque, or has other parameters
            than the sequel's robots.
    """
    problem, effort = experiment.problem, experiment.effort
    if [objective.name for objective in problem.objectives] != [COST, ROBOT_TORQUE]:
        found = ", ".join(objective.name for objective in problem.objectives)
        raise InputError(problem.source.path, "objectives", f"{COST} and {ROBOT_TORQUE}", found)
    strict = changed_problem(problem, [*STRICTER.values()][-1])
    space, base = problem.space, problem.scene.designed_tree
    designs = dict(read_designs(read_text(ROBOTS, str(ROBOTS), ""), str(ROBOTS), space, base))
    results = experiment.solved(problem, designs, "the robots of the sequel")
    ga = _figures(GA, problem, results[GA])
    run = experiment.logged(OURS, problem.settings(seed=effort.seed), effort.evaluations, 1.0)
    minutes = (time.monotonic() - experiment.began) / 60.0
    ours = chosen(run, value_of(COST), ga.cost, value_of(ROBOT_TORQUE))
    if ours is not None:
        designs[OURS] = tuple(ours.assessment.design.values())
        results |= experiment.solved(problem, {OURS: designs[OURS]}, "the robot of the search")
    robots = {name: _figures(name, problem, result) for name, result in results.items()}
    strictly = experiment.solved(strict, designs, "the robots with grips and collisions")
    stricter = {name: _figures(name, strict, result) for name, result in strictly.items()}
    search = _search_figures(run, ga, minutes, effort.jobs)
    return SequelReproduction(
        robots=robots,
        stricter=stricter,
        trees={name: result.tree for name, result in results.items()},
        designs={name: space.named(values) for name, values in designs.items()},
        chosen=None if ours is None else ours.number,
        run=run,
        search=search,
        claims=(
            log_claim(robots),
            order_claim(robots),
            robot_claim(robots),
            gain_claim(robots, search),
            failure_claim(robots, search),
            search_claim(search),
        ),
    )


def _figures(name: str, problem: DesignProblem, result: DesignResult) -> RobotFigures:
    cost, robot, human = (objective_value(each, result) for each in (COST, ROBOT_TORQUE, "human_torque"))
    held = sum(solution.solved for solution in result.cases)
    mass = float(result.tree.mass)
    cases, apart = len(problem.cases), bodies_apart(result)
    return RobotFigures(name, cost, robot, human, mass, result.reach.highest, held, cases, apart)


def _values(evaluation: Evaluation) -> tuple[float, float]:
    """Cost and robot torque; infinite for a design that is not feasible."""
    if not evaluation.feasible:
        return math.inf, math.inf
    return evaluation.assessment.objectives[COST], evaluation.assessment.objectives[ROBOT_TORQUE]


def _search_figures(run: RunLog, ga: RobotFigures, minutes: float, jobs: int) -> SearchFigures:
    values = [_values(evaluation) for evaluation in run.evaluations]
    costs = [cost for cost, _ in values if cost < math.inf]
    reached = dominated = None
    if ga.cost is not None and ga.robot_torque is not None:
        reached = next((number for number, (cost, _) in enumerate(values, 1) if cost <= ga.cost), None)
        better = (
            number
            for number, (cost, at_joints) in enumerate(values, 1)
            if cost <= ga.cost and at_joints < ga.robot_torque
        )
        dominated = next(better, None)
    return SearchFigures(
        evaluations=len(values),
        infeasible=len(values) - len(costs),
        minutes=minutes,
        jobs=jobs,
        reached=reached,
        dominated=dominated,
        least=min(costs, default=None),
        most=max(costs, default=None),
    )


@dataclass(frozen=True, slots=True)
class SequelReproduction:
    """Everything that is shown.

    Args:
        robots: the sequel's, then those of our search, by name.
        stricter: the same with grips and bodies that keep clear of each other.
        trees: of the robots, by name.
        designs: their parameters, by name.
        chosen: number of our search's robot in its run; None where that has no feasible one.
        run: our search.
        search: what it took and found.
        claims: each with its verdict.
    """

    robots: Mapping[str, RobotFigures]
    stricter: Mapping[str, RobotFigures]
    trees: Mapping[str, Tree]
    designs: Mapping[str, Mapping[str, float]]
    chosen: int | None
    run: RunLog
    search: SearchFigures
    claims: tuple[Claim, ...]


def write_sequel(directory: Path, done: SequelReproduction) -> tuple[Path, ...]:
    """Write every robot into an existing directory.

    Raises:
        InputError: a file cannot be written.
    """
    return tuple(write_robot(directory, name, tree) for name, tree in done.trees.items())


def sequel_json(
    done: SequelReproduction, directory: Path, files: Iterable[Path], seconds: float
) -> dict[str, Any]:
    """A reproduction of the sequel as a JSON object; its shape is a promise. [N m], [kg], [m]."""
    return {
        "directory": str(directory),
        "robots": {
            name: {
                **msgspec.to_builtins(robot),
                "fitness": robot.fitness,
                "logged_fitness": LOGGED.get(name),
                "with_grips_and_collisions": msgspec.to_builtins(done.stricter[name]),
                "parameters": dict(done.designs[name]),
            }
            for name, robot in done.robots.items()
        },
        "claims": msgspec.to_builtins(list(done.claims)),
        "search": {
            "run": str(done.run.directory),
            "evaluation": done.chosen,
            **msgspec.to_builtins(done.search),
        },
        "files": [str(path) for path in files],
        "seconds": seconds,
    }
