"""How much does the result of a design depend on the starting points?

Random designs of the default problem, the load at four heights. Of the heights that reach says can be held:
how many are solved and pass the check; how many solved ones lie within 1 % of the best of 25 random starts of
the same program; and how far robot and person solved one after the other lie from the best of 25 random
starts of both together. Results go to benchmarks/results/inner_quality.json and are printed as a table.

    python -m benchmarks.inner_quality [--designs 200] [--joint-designs 50] [--starts 25] [--jobs 2]
"""

from __future__ import annotations

import argparse
import json
from dataclasses import dataclass

import numpy as np
from joblib import Parallel, delayed

from benchmarks.inner_problem import HEIGHTS, HERE, Design, known_at, problem_at, random_designs
from evodesign.nlp.start_portfolio import Landscape, random_start
from evodesign.posture.formulations.base import Setting
from evodesign.posture.postures import PostureProblem
from evodesign.posture.precompute.precomputed import Precomputed
from evodesign.problem.build import DesignProblem
from evodesign.problem.evaluate import Evaluator
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


class Judge:
    """Evaluates designs, and searches for something better with many random starts."""

    def __init__(self, problem: DesignProblem, known: Precomputed, starts: int) -> None:
        self.problem = problem
        self._starts = starts
        self._evaluator = Evaluator(problem, known)
        setting = Setting(problem.scene, problem.space, problem.weights, problem.options)
        self._decoupled, self._joint = (
            PostureProblem(setting, problem.symmetry, given) for given in (known, Precomputed())
        )

    def rows(self, number: int, design: Design, joint: bool) -> list[Row]:
        """A row for each height that the design can reach."""
        result = self._evaluator.solve(design)
        rng = np.random.default_rng(number)
        found = []
        for solution in result.cases:
            if result.reach.distance(solution.case.task.height_m) != 0.0:
                continue
            own = self._decoupled.landscape(solution.case.task)
            costs = [attempt.cost for attempt in solution.attempts if attempt.status is Status.SOLVED]
            best = self._best(own, design, rng)
            both = self._best(self._joint.landscape(solution.case.task), design, rng) if joint else np.nan
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

    def _best(self, landscape: Landscape, design: Design, rng: np.random.Generator) -> float:
        ends = [landscape.solve(design, random_start(landscape, rng)) for _ in range(self._starts)]
        return min((end.cost for end in ends if end.status is Status.SOLVED), default=np.inf)


def judge(first: int, designs: list[Design], joint: int, starts: int) -> list[Row]:
    """The rows of some designs, numbered from `first`; the first `joint` of all are also solved jointly."""
    problem = problem_at(HEIGHTS)
    here = Judge(problem, known_at(problem, 1), starts)
    return [
        row
        for number, design in enumerate(designs, first)
        for row in here.rows(number, design, number < joint)
    ]


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
        "worst_excess_over_best": float(np.max(cost / best - 1.0)),
        "joint_heights": len(both),
        "mean_error_to_joint": float(error.mean()) if both else 0.0,
        "worst_error_to_joint": float(error.max()) if both else 0.0,
        "mean_difference_to_joint": float(signed.mean()) if both else 0.0,
    }


def main() -> None:
    """Judge all designs, write and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--designs", type=int, default=200)
    parser.add_argument("--joint-designs", type=int, default=50)
    parser.add_argument("--starts", type=int, default=25)
    parser.add_argument("--jobs", type=int, default=2)
    options = parser.parse_args()
    problem = problem_at(HEIGHTS)
    known_at(problem, options.jobs)
    designs = random_designs(problem, options.designs)
    chunks = [(first, designs[first : first + 5]) for first in range(0, len(designs), 5)]
    work = (delayed(judge)(first, chunk, options.joint_designs, options.starts) for first, chunk in chunks)
    rows = [row for part in Parallel(options.jobs)(work) for row in part]
    by_height = {
        f"{height:g} m": summary([row for row in rows if row.height == height]) for height in HEIGHTS
    }
    figures = {**by_height, "all": summary(rows)}
    target = HERE / "results" / "inner_quality.json"
    target.write_text(json.dumps({**vars(options), "figures": figures}, indent=2) + "\n")
    print(_table(figures))


def _table(figures: dict[str, dict[str, float]]) -> str:
    head = (
        "| height | reachable | solved | within 1 % of the best start | worst excess "
        "| jointly | mean error | worst error |\n|---|---|---|---|---|---|---|---|"
    )
    lines = [
        f"| {height} | {row['reachable_heights']} | {row['solved_share']:.1%} "
        f"| {row['within_1_percent_share']:.1%} "
        f"| {row['worst_excess_over_best']:.2%} | {row['joint_heights']} | {row['mean_error_to_joint']:.2%} "
        f"| {row['worst_error_to_joint']:.2%} |"
        for height, row in figures.items()
    ]
    return "\n".join([head, *lines])


if __name__ == "__main__":
    main()
