"""Lifts of random designs whose bodies keep clear of each other, and under disturbances: how many are found.

Random designs lift from 0.8 to 1.2 m in 1.5 s, with every person and load of a problem. Each lift is solved
from the holds at both ends; then with bodies that no row keeps apart, where the check refuses those that
overlap; and where the problem has disturbances, without them. Results go to
benchmarks/results/lift_bodies.json, under the problem's name: statuses, processor time of the lifts without
their holds [s], and why others were not found.

    python -m benchmarks.lift_bodies [--problem point-grasp] [--designs 12] [--ways apart overlapping]

`point-grasp` is that problem with a [collisions] table, `point-grasp-disturbed` the one with a push
of 20 N, `point-grasp-pushed` the one with both; other problems are files.
"""

from __future__ import annotations

import argparse
import json
import time
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace

import msgspec

from benchmarks.inner_problem import HERE, PROBLEM, Design, processors, random_designs
from evodesign.evaluation.evaluate import Evaluator
from evodesign.evaluation.factory import evaluator_of
from evodesign.mechanics.scene import Scene
from evodesign.motion.lifting import LiftProblem
from evodesign.motion.solution import LiftSolution
from evodesign.posture.allocation import shared_scene
from evodesign.posture.check import AgentModel, Checker
from evodesign.posture.formulations.base import Setting
from evodesign.posture.postures import Symmetry
from evodesign.posture.precompute.meetings import with_meetings
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.source import read_source
from evodesign.records import Hold
from evodesign.tasks import Lift

COLLISIONS = "\n[collisions]\n"
PUSH = "\n[[disturbance]]\npush_n = [-20.0, 0.0, 0.0]\n"
VARIANTS: Mapping[str, str] = {
    "point-grasp": COLLISIONS,
    "point-grasp-disturbed": PUSH,
    "point-grasp-pushed": COLLISIONS + PUSH,
}
"""What is added to the point-grasp problem."""
LIFT = Lift(0.8, 1.2, 1.5)


@dataclass
class Tally:
    """What came of the lifts in one way.

    Attributes:
        statuses: how many ended so.
        seconds: processor time of all [s].
        others: why lifts were not found, by design, person and load.
    """

    statuses: Counter[str] = field(default_factory=Counter)
    seconds: float = 0.0
    others: dict[str, str] = field(default_factory=dict)

    def add(self, name: str, solution: LiftSolution, seconds: float) -> None:
        """Count a lift."""
        self.statuses[str(solution.status)] += 1
        self.seconds += seconds
        if not solution.solved:
            self.others[name] = solution.reason


def main() -> None:
    """Measure, write and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--problem", default="point-grasp")
    parser.add_argument("--designs", type=int, default=12)
    parser.add_argument("--ways", nargs="+", default=["apart", "overlapping", "undisturbed"])
    options = parser.parse_args()
    problem = problem_of(options.problem)
    evaluator = evaluator_of(problem, processors())
    ways = {way: each for way, each in ways_of(problem, evaluator).items() if way in options.ways}
    tallies = {name: Tally() for name in ways}
    designs = random_designs(problem, options.designs)
    for _ in lifts(evaluator, ways, designs[0]):
        pass  # programs are built and compiled
    for number, design in enumerate(designs):
        for way, name, solution, seconds in lifts(evaluator, ways, design):
            tallies[way].add(f"{number} {name}", solution, seconds)
            print(number, name, way, solution.status, f"{seconds:.1f} s", flush=True)
    place = HERE / "results" / "lift_bodies.json"
    known = json.loads(place.read_text()) if place.exists() else {}
    key = options.problem if options.problem in VARIANTS else problem.name
    known[key] = known.get(key, {}) | {
        way: {"statuses": dict(each.statuses), "seconds": round(each.seconds, 1), "others": each.others}
        for way, each in tallies.items()
    }
    place.write_text(json.dumps(known, indent=2) + "\n")
    print(json.dumps(known[key], indent=2))


def problem_of(name: str) -> DesignProblem:
    """A variant of the point-grasp problem, or a problem of a file."""
    if name not in VARIANTS:
        return build_problem(read_source(name))
    source = read_source(PROBLEM)
    return build_problem(msgspec.structs.replace(source, text=source.text + VARIANTS[name]))


def ways_of(problem: DesignProblem, evaluator: Evaluator) -> dict[str, Mapping[tuple[str, str], LiftProblem]]:
    """Lifts of every person and load, in each way."""
    scenes = {"apart": [with_meetings(scene, evaluator.known.meetings) for scene in problem.scenes]}
    scenes["overlapping"] = [_without_rows(scene) for scene in problem.scenes]
    if problem.scene.disturbances:
        scenes["undisturbed"] = [scene.undisturbed for scene in scenes["apart"]]
    symmetric = problem.symmetry is not Symmetry.OFF
    return {
        way: {
            scene.pair: LiftProblem(
                Setting(scene, problem.space, problem.weights, problem.options), symmetric=symmetric
            )
            for scene in each
        }
        for way, each in scenes.items()
    }


def _without_rows(scene: Scene) -> Scene:
    """The scene with bodies that are checked and that no row parts."""
    robot, human = (
        replace(agent, collisions=agent.collisions and replace(agent.collisions, parted=()))
        for agent in scene.agents
    )
    return scene.with_agents(robot, human)


def lifts(
    evaluator: Evaluator, ways: Mapping[str, Mapping[tuple[str, str], LiftProblem]], design: Design
) -> Iterator[tuple[str, str, LiftSolution, float]]:
    """Way, names of person and load, what came of it, and processor time [s]."""
    problem, space = evaluator.problem, evaluator.problem.space
    values = evaluator.solve(design).rated if space.margins else design
    unscaled = problem.scene.robot
    robot = AgentModel.of(unscaled, unscaled.tree).resized(space.resized(unscaled.tree, values))
    for plain in problem.scenes:
        scene = shared_scene(plain, space, values)
        human = AgentModel.of(scene.human, scene.human.tree)
        checker, postures = Checker(scene, robot, human), evaluator.inner.postures[plain.pair]
        heights = LIFT.from_m, LIFT.to_m
        ends = [postures.solve(values, Hold(height_m=height), checker) for height in heights]
        for way, problems in ways.items():
            began = time.process_time()
            solution = problems[plain.pair].solve(values, LIFT, ends, robot, human, slowly=False)
            yield way, " ".join(plain.pair).strip(), solution, time.process_time() - began


if __name__ == "__main__":
    main()
