"""How much does the result of a design depend on the starting points?

Random designs of a problem that can be built, the load at four heights (at its own for the problem of a
file). Of the heights that reach says can be held: how many are solved and pass the check; how many solved
ones lie within 1 % of the best of 25 random starts of the same program; and, for the first designs of a
symmetric problem, how far robot and person solved one after the other lie from the best of 25 random starts
of both together. The lowest and highest heights are compared with the best of 25 random starts of the reach
problem. Results go to benchmarks/results/inner_quality.json (of another problem, to
inner_quality_NAME.json) and are printed as tables.

    python -m benchmarks.inner_quality [--problem default|longer_arm|load_aside|pushed_aside|FILE]
        [--designs 200] [--joint-designs 50] [--starts 25] [--jobs 2]
"""

from __future__ import annotations

import argparse
import json
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

import numpy as np
from joblib import Parallel, delayed

from benchmarks.inner_problem import DEFAULT, HERE, Design, known_at, problem_named, random_designs
from evodesign.evaluation.evaluate import Evaluator
from evodesign.posture.design_checkers import DesignCheckers, can_be_built
from evodesign.posture.formulations.base import Setting
from evodesign.posture.formulations.reach import HIGHEST, LOWEST, ReachProblem
from evodesign.posture.postures import PostureProblem, Symmetry
from evodesign.posture.precompute.meetings import with_meetings
from evodesign.posture.precompute.precomputed import Precomputed
from evodesign.posture.seeking.budget import BUDGET
from evodesign.posture.seeking.landscape import Landscape
from evodesign.problem.build import DesignProblem
from evodesign.quantities.design_result import DesignResult
from evodesign.records import Status


@dataclass(frozen=True, slots=True)
class Row:
    """One reachable height of one design; costs in 100 N^2 m^2, infinite where nothing was found.

    Args:
        height: of the load [m].
        status: of the evaluation.
        cost: of the posture that the evaluation found, in the program that is solved first.
        checked: cost of both agents' checked postures.
        best: least of the random starts of the same program.
        joint: least of the random starts of both agents together; not a number where that was not asked for.
    """

    height: float
    status: str
    cost: float
    checked: float
    best: float
    joint: float


@dataclass(frozen=True, slots=True)
class Ends:
    """The reach of one design: that of the evaluation and that of the random starts.

    Args:
        lowest, highest: of the evaluation [m].
        best_lowest, best_highest: of the random starts [m], infinite where nothing was found.
    """

    lowest: float
    highest: float
    best_lowest: float
    best_highest: float

    @property
    def short(self) -> tuple[float, float]:
        """How much farther the random starts reach down and up [m]; negative where the evaluation does."""
        return self.lowest - self.best_lowest, self.best_highest - self.highest


class Judge:
    """Evaluates designs, and searches for something better with many random starts."""

    def __init__(self, problem: DesignProblem, known: Precomputed, starts: int) -> None:
        self.problem = problem
        self._starts = starts
        self._evaluator = Evaluator(problem, known)
        self.scenes = [with_meetings(scene, known.meetings) for scene in problem.scenes]
        settings = [Setting(each, problem.space, problem.weights, problem.options) for each in self.scenes]
        self._first, self._joint = (
            {each.scene.pair: PostureProblem(each, problem.symmetry, given) for each in settings}
            for given in (known, Precomputed())
        )
        self._checkers = {each.pair: DesignCheckers(each, problem.space) for each in self.scenes}
        self._reach = ReachProblem(settings[0], symmetric=problem.symmetry is not Symmetry.OFF)

    def judged(self, number: int, design: Design, joint: bool) -> tuple[Ends, list[Row]]:
        """The reach of a design, and a row for each height that it can reach."""
        result = self._evaluator.solve(design)
        return self._ends(number, result), self._rows(number, result, joint)

    def held(self, number: int, design: Design) -> list[Row]:
        """The rows alone."""
        return self._rows(number, self._evaluator.solve(design), joint=False)

    def _rows(self, number: int, result: DesignResult, joint: bool) -> list[Row]:
        design = tuple(result.program_values)  # with the actuators that were sized
        rng = np.random.default_rng((number, 1))
        found = []
        for solution in result.cases:
            if result.reach.distance(solution.case.task.height_m) != 0.0:
                continue
            pair, task = solution.case.pair, solution.case.task
            own = self._first[pair].landscape(task, self._checkers[pair].of)
            costs = [attempt.cost for attempt in solution.attempts if attempt.status is Status.SOLVED]
            best = self._best(own, design, rng)
            both = self._best(self._joint[pair].landscape(task), design, rng) if joint else np.nan
            row = Row(
                solution.case.task.height_m,
                str(solution.status),
                min(costs, default=np.inf),
                solution.attempt.cost if solution.attempt else np.inf,
                best,
                both,
            )
            found.append(row)
        return found

    def _ends(self, number: int, result: DesignResult) -> Ends:
        design, rng = tuple(result.program_values), np.random.default_rng(number)
        up, down = (self._best(self._reach.landscape(sense), design, rng) for sense in (HIGHEST, LOWEST))
        low, high = result.reach.lowest, result.reach.highest
        return Ends(np.inf if low is None else low, -np.inf if high is None else high, down, -up)

    def _best(self, landscape: Landscape, design: Design, rng: np.random.Generator) -> float:
        ends = [landscape.solve(design, landscape.free_start(rng)) for _ in range(self._starts)]
        return min((end.cost for end in ends if end.status is Status.SOLVED), default=np.inf)


def judge_of(problem: str, starts: int) -> Judge:
    """That of a problem, made ready."""
    built = problem_named(problem)
    return Judge(built, known_at(built, 1), starts)


def judge(
    first: int, designs: list[Design], joint: int, starts: int, problem: str = DEFAULT
) -> list[tuple[Ends, list[Row]]]:
    """What is found of some designs, numbered from `first`; the first `joint` of all are also solved jointly.

    Args:
        first: number of the first design, which seeds its random starts.
        designs: to be judged.
        joint: how many of all are solved jointly as well.
        starts: random ones of each program.
        problem: name of a variant of the point-grasp problem, or a problem file.
    """
    here = judge_of(problem, starts)
    return [here.judged(number, design, number < joint) for number, design in enumerate(designs, first)]


def summary(rows: list[Row]) -> dict[str, float]:
    """The figures of a set of rows."""
    solved = [row for row in rows if row.status == Status.SOLVED]
    cost, best = (np.array([getattr(row, name) for row in solved]) for name in ("cost", "best"))
    best = np.minimum(cost, best)
    both = [row for row in solved if np.isfinite(row.joint)]
    error = np.array([row.checked / min(row.joint, row.checked) - 1.0 for row in both])
    signed = np.array([row.checked / row.joint - 1.0 for row in both])
    return {
        "reachable_heights": len(rows),
        "solved_share": len(solved) / len(rows),
        "within_1_percent_share": float(np.mean(cost <= 1.01 * best)),
        "above_5_percent_share": float(np.mean(cost > 1.05 * best)),
        "worst_excess_over_best": float(np.max(cost / best - 1.0)),
        "joint_heights": len(both),
        "mean_error_to_joint": float(error.mean()) if both else 0.0,
        "worst_error_to_joint": float(error.max()) if both else 0.0,
        "mean_difference_to_joint": float(signed.mean()) if both else 0.0,
    }


def reach_summary(ends: list[Ends]) -> dict[str, float]:
    """The figures of a set of reaches; the costs of the random starts hold up to 0.1 mm of regularisation."""
    down, up = np.array([each.short for each in ends]).T
    return {
        "designs": len(ends),
        "lowest_within_5_mm_share": float(np.mean(down <= BUDGET.near_height)),
        "highest_within_5_mm_share": float(np.mean(up <= BUDGET.near_height)),
        "worst_lowest_short_m": max(0.0, float(down.max())),
        "worst_highest_short_m": max(0.0, float(up.max())),
    }


def main() -> None:
    """Judge all designs, write and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--problem", default=DEFAULT)
    parser.add_argument("--designs", type=int, default=200)
    parser.add_argument("--joint-designs", type=int, default=50)
    parser.add_argument("--starts", type=int, default=25)
    parser.add_argument("--jobs", type=int, default=2)
    options = parser.parse_args()
    problem = problem_named(options.problem)
    known_at(problem, options.jobs)
    built, given = can_be_built(problem.scene, problem.space), problem.space.given
    drawn = random_designs(problem, 10 * options.designs)
    designs = list(islice((each for each in drawn if built(tuple(given(each, {})))), options.designs))
    joint = 0 if problem.symmetry is Symmetry.OFF else options.joint_designs
    chunks = [(first, designs[first : first + 5]) for first in range(0, len(designs), 5)]
    work = (delayed(judge)(first, chunk, joint, options.starts, options.problem) for first, chunk in chunks)
    judged = [each for part in Parallel(options.jobs)(work) for each in part]
    rows = [row for _, found in judged for row in found]
    by_height = {
        f"{height:g} m": summary([row for row in rows if row.height == height])
        for height in sorted({row.height for row in rows})
    }
    figures = {**by_height, "all": summary(rows)}
    reach = reach_summary([ends for ends, _ in judged])
    name = "" if options.problem == DEFAULT else f"_{Path(options.problem).stem}"
    target = HERE / "results" / f"inner_quality{name}.json"
    measured = {**vars(options), "problem": Path(options.problem).name, "figures": figures, "reach": reach}
    target.write_text(json.dumps(measured, indent=2) + "\n")
    print(_table(figures))
    print(json.dumps(reach, indent=2))


def _table(figures: dict[str, dict[str, float]]) -> str:
    head = (
        "| height | reachable | solved | within 1 % of the best start | above 5 % | worst excess "
        "| jointly | mean error | worst error |\n|---|---|---|---|---|---|---|---|---|"
    )
    lines = [
        f"| {height} | {row['reachable_heights']} | {row['solved_share']:.1%} "
        f"| {row['within_1_percent_share']:.1%} | {row['above_5_percent_share']:.1%} "
        f"| {row['worst_excess_over_best']:.2%} | {row['joint_heights']} | {row['mean_error_to_joint']:.2%} "
        f"| {row['worst_error_to_joint']:.2%} |"
        for height, row in figures.items()
    ]
    return "\n".join([head, *lines])


if __name__ == "__main__":
    main()
