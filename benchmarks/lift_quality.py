"""Lifts of random designs: how many are found and checked, and how far they are from the best known.

Random designs of the point-grasp problem lift from 0.8 to 1.2 m and from 0.6 to 1.2 m in 1.5 s. Each lift is
solved as `evodesign lift` does it, from the holds at both ends. Then it is solved from further starts: the
same holds with joints, base and stance moved at random (standard deviation 0.3 rad and 0.1 m), followed along
the lift. A motion exists where any start led to one. Results go to benchmarks/results/lift_quality.json, the
lifts that were not found or are not within 1 % of the best among them.

    python -m benchmarks.lift_quality [--designs 50] [--starts 10] [--seconds 1.5]
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from benchmarks.inner_problem import HERE, Design, problem_at, random_designs
from benchmarks.lift_speed import ENDS
from evodesign.motion.instant import KnotBlocks
from evodesign.motion.lifting import TOLERANCE_OF_LIFTS, LiftProblem
from evodesign.motion.program import LiftProgram
from evodesign.motion.solution import LiftSolution
from evodesign.nlp.solver import status_of
from evodesign.posture.check import AgentModel, Checker
from evodesign.posture.formulations.base import Setting
from evodesign.posture.postures import PostureProblem, Symmetry
from evodesign.posture.results import AgentPosture
from evodesign.posture.symmetry import symmetric_forms
from evodesign.records import Hold, Status
from evodesign.tasks import Lift

KNOTS = 12
NEAR = 0.01
JOINTS_MOVED, BASE_MOVED = 0.3, 0.1


@dataclass(frozen=True)
class Outcome:
    """One lift of one design.

    Args:
        design: its number.
        lift: what was asked for.
        ends: whether the load can be held at both ends.
        solution: as `evodesign lift` gives it.
        cost: from the holds at both ends, with as many knots as asked for; infinite without a motion.
        best: of all starts, likewise.
        further: how many further starts led to one.
    """

    design: int
    lift: Lift
    ends: bool
    solution: LiftSolution
    cost: float
    best: float
    further: int

    @property
    def exists(self) -> bool:
        """Whether any start led to a motion."""
        return self.ends and np.isfinite(self.best)

    @property
    def above(self) -> float:
        """Share by which the cost is above the best known."""
        return self.cost / self.best - 1.0

    def told(self) -> dict[str, object]:
        """For those who look into it."""
        above = round(self.above, 4) if self.exists and np.isfinite(self.cost) else None
        told = {"design": self.design, "lift": str(self.lift), "reason": self.solution.reason}
        return {**told, "above_best": above, "further_starts_solved": self.further}


def main() -> None:
    """Measure, write and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--designs", type=int, default=50)
    parser.add_argument("--starts", type=int, default=10)
    parser.add_argument("--seconds", type=float, default=1.5)
    options = parser.parse_args()
    found = list(outcomes(options.designs, options.starts, options.seconds))
    exists = [each for each in found if each.exists]
    solved = [each for each in exists if each.solution.solved]
    near = [each for each in exists if each.above <= NEAR]
    result = {
        "lifts": len(found),
        "ends_held": sum(each.ends for each in found),
        "motion_exists": len(exists),
        "solved_and_checked": len(solved),
        "more_knots": sum(each.solution.lift.knots > KNOTS for each in solved),
        "solved_share": len(solved) / len(exists),
        "starts": options.starts,
        "near_best_share": len(near) / len(exists),
        "others": [each.told() for each in found if each not in solved or each not in near],
    }
    (HERE / "results" / "lift_quality.json").write_text(json.dumps(result, indent=2) + "\n")
    print(json.dumps(result, indent=2))


def outcomes(designs: int, starts: int, seconds: float) -> Iterator[Outcome]:
    """All lifts of so many random designs."""
    problem = problem_at(ENDS[0])
    setting = Setting(problem.scene, problem.space, problem.weights, problem.options)
    scene, mass = setting.scene, setting.scene.payload.mass
    options = replace(setting.options, tolerance=TOLERANCE_OF_LIFTS)
    program = LiftProgram(KnotBlocks(symmetric_forms(scene), setting), KNOTS, options)
    holds, lifts = PostureProblem(setting, Symmetry.ON), LiftProblem(setting, symmetric=True)
    human = AgentModel.of(scene.human, scene.human.tree)
    rng = np.random.default_rng(21)
    for number, design in enumerate(random_designs(problem, designs)):
        robot = AgentModel.of(scene.robot, setting.space.resized(scene.robot.tree, design))
        checker = Checker(scene, robot, human)
        for low, high in ENDS:
            lift = Lift(low, high, seconds, knots=KNOTS)
            ends = [holds.solve(design, Hold(height_m=height), checker) for height in (low, high)]
            solution = lifts.solve(design, lift, ends, robot, human)
            if not all(end.solved for end in ends):
                yield Outcome(number, lift, False, solution, np.inf, np.inf, 0)
                continue
            postures = [end.postures for end in ends]
            known = _costs(program, lift, design, mass, list(zip(postures, (0, KNOTS - 1), strict=True)))
            moved = [(_moved(postures[k % 2], rng), (KNOTS - 1) * (k % 2)) for k in range(starts - 2)]
            further = _costs(program, lift, design, mass, moved)
            cost = min(known, default=np.inf)
            best = min([cost, *further])
            yield Outcome(number, lift, True, solution, cost, best, len(further))


def _costs(
    program: LiftProgram,
    lift: Lift,
    design: Design,
    mass: float,
    begins: Sequence[tuple[Mapping[str, AgentPosture], int]],
) -> list[float]:
    """Of the starts that lead to a motion."""
    costs = []
    for postures, knot in begins:
        start = program.followed(lift, postures, knot, design)
        ending, _ = program.solve(lift, start, design, mass)
        if status_of(ending.word) is Status.SOLVED:
            costs.append(ending.cost)
    return costs


def _moved(postures: Mapping[str, AgentPosture], rng: np.random.Generator) -> dict[str, AgentPosture]:
    """Joints and bases moved at random."""
    return {
        name: replace(
            posture,
            joints={joint: value + JOINTS_MOVED * rng.normal() for joint, value in posture.joints.items()},
            base_position=posture.base_position + BASE_MOVED * rng.normal(size=3),
        )
        for name, posture in postures.items()
    }


if __name__ == "__main__":
    main()
