"""Lifts of random designs: how many are found and checked, and how far they are from the best known.

Random designs of the point-grasp problem lift from 0.8 to 1.2 m and from 0.6 to 1.2 m in 1.5 s. Each lift is
solved as `evodesign lift` does it, from the starts of the problem. Then it is solved from further ones: the
holds at both ends, and these with joints, base and stance moved at random (standard deviation 0.3 rad and 0.1
m), followed along the lift; half of them with the solution's person. A motion exists where any start led
to one. Results go to benchmarks/results/lift_quality.json, the lifts that were not found or are not within
1 % of the best among them.

    python -m benchmarks.lift_quality [--designs 50] [--starts 10] [--seconds 1.5]
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from benchmarks.inner_problem import HERE, Design, problem_at, processors, random_designs
from benchmarks.lift_speed import ENDS
from evodesign.evaluation.evaluate import Evaluator
from evodesign.evaluation.factory import evaluator_of
from evodesign.evaluation.lifts import Lifts
from evodesign.mechanics.agent import HUMAN
from evodesign.motion.lift_program import LiftProgram
from evodesign.motion.lifting import lift_program, moved_posture
from evodesign.motion.solution import LiftSolution
from evodesign.nlp.program import Start
from evodesign.nlp.solver import status_of
from evodesign.posture.check import Unchecked
from evodesign.posture.formulations.base import Setting
from evodesign.posture.results import AgentPosture, Attempt
from evodesign.records import Hold, Status
from evodesign.tasks import Lift
from evodesign.tasks.lift import KNOTS

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
        cost: from the problem's starts, with as many knots as asked for; infinite without a motion.
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
    problem = problem_at(sorted({height for ends in ENDS for height in ends}))
    asked = [Lift(low, high, seconds) for low, high in ENDS]
    evaluator = evaluator_of(problem, processors(), lifts=asked)
    lifts, further = Lifts(evaluator, evaluator.known), FurtherStarts(evaluator, starts)
    for number, design in enumerate(random_designs(problem, designs)):
        for lift in asked:
            ((pair, solution),) = lifts.solve(design, lift).items()
            found = evaluator.inner.postures[pair]
            ends = [found.solve(design, Hold(height_m=h), Unchecked()) for h in lift.heights]
            if not all(end.solved for end in ends):
                yield Outcome(number, lift, False, solution, np.inf, np.inf, 0)
                continue
            costs = further.costs(design, lift, [end.postures for end in ends], solution)
            cost = min((each.cost for each in solution.attempts if _begins(each)), default=np.inf)
            yield Outcome(number, lift, True, solution, cost, min([cost, *costs]), len(costs))


def _begins(attempt: Attempt) -> bool:
    """Whether it was solved, with as many knots as asked for."""
    return attempt.status is Status.SOLVED and not attempt.start.startswith("motion")


class FurtherStarts:
    """Solves of lifts from starts that the problem does not have.

    Args:
        evaluator: of the problem, with one person and load.
        count: of the starts.
    """

    def __init__(self, evaluator: Evaluator, count: int) -> None:
        problem, self._count = evaluator.problem, count
        self._setting = Setting(problem.scene, problem.space, problem.weights, problem.options)
        self._programs: dict[int, LiftProgram] = {}
        self._rng = np.random.default_rng(21)

    def costs(
        self,
        design: Design,
        lift: Lift,
        ends: Sequence[Mapping[str, AgentPosture]],
        solution: LiftSolution,
    ) -> list[float]:
        """Of those that lead to a motion."""
        program, mass = self._program(lift.knots), self._setting.scene.payload.mass
        begins = [(postures, place, {}) for place, postures in enumerate(ends)]
        for number in range(self._count - len(begins)):
            person = self._person(solution) if number % 4 > 1 else {}
            begins.append((_moved(ends[number % 2], self._rng), number % 2, person))
        costs = []
        for postures, place, person in begins:
            begun = program.followed(lift, postures, place * (lift.knots - 1), design)
            ending, _ = program.solve(lift, program.beside(begun, person), design, mass)
            if status_of(ending.word) is Status.SOLVED:
                costs.append(ending.cost)
        return costs

    def _person(self, solution: LiftSolution) -> Start:
        """How the person of a solution moves; of none: nothing is said."""
        if solution.start is None or solution.ending is None:
            return {}
        found = replace(solution.start, symbols=solution.ending.symbols)
        return self._program(solution.lift.knots).motion_of(HUMAN, found)

    def _program(self, knots: int) -> LiftProgram:
        if knots not in self._programs:
            self._programs[knots] = lift_program(self._setting, knots, symmetric=True)
        return self._programs[knots]


def _moved(postures: Mapping[str, AgentPosture], rng: np.random.Generator) -> dict[str, AgentPosture]:
    """Joints and bases moved at random."""
    found = {}
    for name, posture in postures.items():
        scales = np.r_[np.full(3, BASE_MOVED), np.full(len(posture.joints), JOINTS_MOVED)]
        found[name] = moved_posture(posture, scales * rng.normal(size=len(scales)))
    return found


if __name__ == "__main__":
    main()
