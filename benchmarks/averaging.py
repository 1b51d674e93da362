"""What averaging a robot with its mirror image does to the torques of its postures.

    python -m benchmarks.averaging [--robots NAME,...]

For the unscaled robot of the problem that `init` guesses, at each height, the norm of the robot's torques in

    symmetric    the symmetric posture of the averaged robot, which a search sees
    missed       what the torques of the robot of the file would have to be otherwise, at any joint, in that
                 very posture with its contact wrenches
    averaged     the whole posture of the averaged robot of least cost
    as it is     that of the robot of the file

Whole postures begin at the symmetric one, and at those that either robot was led to before, in three rounds:
each has several minima near it. So what lies between the last two is due to averaging alone, and what lies
between them and the first to postures that are not symmetric.
Written to benchmarks/results/averaging.json, printed as a table.
"""

from __future__ import annotations

import argparse
import json
import tomllib
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from evodesign.evaluation.evaluate import Evaluator
from evodesign.guess.problem_text import guessed_problem
from evodesign.mechanics.agent import ROBOT
from evodesign.nlp.solver import SolverCache
from evodesign.posture.check import AgentModel, Checker, sizes
from evodesign.posture.formulations.base import Setting
from evodesign.posture.formulations.joint import JointPostures
from evodesign.posture.results import Instant
from evodesign.posture.seeking.candidate import Candidate
from evodesign.posture.symmetry import whole
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.meshes import with_meshes_beside
from evodesign.problem.named_files import read_robot
from evodesign.problem.source import source_of
from evodesign.tasks import Task
from evodesign.tree.urdf_read import InertiaRule, read_urdf
from tests.robots import HUMANOIDS

ROUNDS = 3
Instants = tuple[Instant, ...]
RESULTS = Path(__file__).parent / "results" / "averaging.json"


def guessed(name: str, symmetry: str) -> DesignProblem:
    """The problem that `init` writes for a robot, with one person, no `[collisions]`, and fixed starts."""
    file = HUMANOIDS[name]
    robot = read_robot(file, name, name, "")
    tree = with_meshes_beside(read_urdf(robot.urdf, name, InertiaRule.FILE), file, robot)
    tables = tomllib.loads(guessed_problem(tree, str(file)).text)
    tables["robot"]["meshes"] = False
    del tables["collisions"]
    tables["human"] = tables["human"][:1]
    problem = build_problem(source_of(tables, symmetry=symmetry))
    return replace(problem, options=replace(problem.options, compiled=False))


class WholePostures:
    """Whole postures of a problem's unscaled robot."""

    def __init__(self, problem: DesignProblem) -> None:
        scene, space = problem.scene, problem.space
        setting = Setting(scene, space, problem.weights, problem.options)
        self._design = space.unscaled(scene.robot.tree)
        self._formulation = JointPostures(
            "whole", (whole(scene.robot), whole(scene.human)), setting, SolverCache()
        )
        tree = space.resized(scene.robot.tree, self._design)
        robot, human = AgentModel.of(scene.robot, tree), AgentModel.of(scene.human, scene.human.tree)
        self._checker = Checker(scene, robot, human)

    def best(self, task: Task, starts: Sequence[Instants]) -> Candidate:
        """The posture of least cost that known ones lead to."""
        begun = [[self._formulation.start_at(start)] for start in starts]
        trials = [self._formulation.solve(self._design, task, each, self._checker) for each in begun]
        return min((trial.best for trial in trials if trial.best), key=lambda each: each.attempt.cost)

    def residual(self, task: Task, instants: Instants) -> float:
        """By how much the robot's torques miss the equations of its joints in a posture [N m]."""
        return sizes(self._checker.task_residuals(instants, task.heights))["robot.torque"]


def measured(name: str) -> Iterator[dict[str, float]]:
    """Torques at each height [N m]."""
    averaged, as_it_is = guessed(name, "on"), guessed(name, "off")
    symmetric = Evaluator(averaged).solve(averaged.space.unscaled(averaged.scene.robot.tree))
    both = WholePostures(averaged), WholePostures(as_it_is)
    for solution in symmetric.cases:
        task, known = solution.case.task, [solution.instants]
        for _ in range(ROUNDS):
            known += [postures.best(task, known).instants for postures in both]
        mean, file = (instants[0].postures[ROBOT] for instants in known[-2:])
        yield {
            "height_m": task.height_m,
            "symmetric_n_m": solution.instants[0].postures[ROBOT].torque_norm,
            "missed_n_m": both[1].residual(task, solution.instants),
            "averaged_n_m": mean.torque_norm,
            "as_it_is_n_m": file.torque_norm,
        }


def main() -> None:
    """Measure the robots that are asked for."""
    parser = argparse.ArgumentParser(description="torques of averaged robots")
    parser.add_argument("--robots", default="talos,g1")
    options = parser.parse_args()
    results = json.loads(RESULTS.read_text()) if RESULTS.exists() else {}
    print("| robot | height [m] | symmetric | missed | averaged, whole | as it is, whole |")
    print("|---|---|---|---|---|---|")
    for name in options.robots.split(","):
        results[name] = [*measured(name)]
        RESULTS.write_text(json.dumps(results, indent=2) + "\n")
        for height, *torques in (row.values() for row in results[name]):
            print(f"| {name} | {height:g} | {' | '.join(f'{torque:.4f}' for torque in torques)} |")


if __name__ == "__main__":
    main()
