"""Do worse disturbances cost more? Random designs under disturbances of growing size.

At size zero the least cost must be that of the undisturbed problem, whether the mean or the worst case
counts; growing disturbances must never lower the worst-case optimum. A posture that holds large disturbances
holds smaller ones too, so each size is also solved from the posture of the next larger one; otherwise only
the luck of local optima would be seen. Results go to benchmarks/results/disturbed_growth.json.

    python -m benchmarks.disturbed_growth [--designs 10]
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from itertools import pairwise

from benchmarks.inner_problem import HERE, Design, problem_at, random_designs
from evodesign.mechanics.disturbance import Disturbance, Disturbances, OverCases
from evodesign.mechanics.scene import Scene
from evodesign.nlp.solver import SolverCache
from evodesign.posture.check import AgentModel, Checker
from evodesign.posture.formulations.base import Setting
from evodesign.posture.postures import PostureProblem
from evodesign.posture.precompute.precomputed import Precomputed
from evodesign.posture.results import AgentPosture, CaseSolution, Instant
from evodesign.posture.seeking.start_portfolio import Coverage, StartPortfolio
from evodesign.posture.symmetry import symmetric_forms
from evodesign.posture.warm_start import start_from
from evodesign.problem.build import DesignProblem
from evodesign.records import Case, Hold

HEIGHT = 1.0
HOLD = Hold(height_m=HEIGHT)
SIZES = (2.0, 1.5, 1.0, 0.75, 0.5, 0.25, 0.0)

Postures = Mapping[str, AgentPosture]


def disturbances_of(size: float, effort: OverCases) -> Disturbances:
    """20 % more load, its centre of mass 0.05 m aside, and pushes of 20 N, times a size."""
    return Disturbances(
        (
            Disturbance("heavier", mass_share=0.2 * size),
            Disturbance("leaning", center_of_mass=(0.05 * size, 0.0, 0.0)),
            Disturbance("pushed to the person", push=(20.0 * size, 0.0, 0.0)),
            Disturbance("pushed to the robot", push=(-20.0 * size, 0.0, 0.0)),
        ),
        effort,
    )


class Bench:
    """A scene's posture problem with its check."""

    def __init__(self, problem: DesignProblem, scene: Scene) -> None:
        self._problem, self._scene, self._solvers = problem, scene, SolverCache()
        options = replace(problem.options, compiled=False)
        self._setting = Setting(scene, problem.space, problem.weights, options)
        bare = PostureProblem(self._setting, problem.symmetry, solvers=self._solvers)
        self._landscape = bare.landscape(HOLD)
        self._human = AgentModel.of(scene.human, scene.human.tree)

    def best(self, design: Design, like: Postures | None) -> CaseSolution:
        """The cheapest checked posture from the program's own starts and from a known posture."""
        tree = self._problem.space.resized(self._scene.robot.tree, design)
        starts = self._landscape.starts
        if like is not None:
            like_known = start_from(
                self._landscape.seeker.program, symmetric_forms(self._scene), [Instant(0.0, like)]
            )
            starts = (like_known, *starts)
        known = Precomputed(
            postures={Case(person="", payload="", task=HOLD): StartPortfolio(starts, Coverage(0, 0, 0.0))}
        )
        postures = PostureProblem(self._setting, self._problem.symmetry, known, self._solvers)
        return postures.solve(
            design, HOLD, Checker(self._scene, AgentModel.of(self._scene.robot, tree), self._human)
        )


def cost_of(solution: CaseSolution) -> float:
    """The cost of the start that won; infinite where none did."""
    return solution.attempt.cost if solution.attempt else float("inf")


@dataclass(frozen=True, slots=True)
class Row:
    """Least costs of one design [(10 N m)^2].

    Args:
        worst_case: by size, from the largest on.
        undisturbed: without disturbances.
        at_zero: with disturbances of size zero, by the way in which cases count.
    """

    worst_case: Mapping[str, float]
    undisturbed: float
    at_zero: Mapping[str, float]

    @property
    def least_growth(self) -> float:
        """The least difference of cost from a size to the next larger one."""
        return min(larger - smaller for larger, smaller in pairwise(self.worst_case.values()))


def main() -> None:
    """Solve all, write and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--designs", type=int, default=10)
    options = parser.parse_args()
    problem = problem_at((HEIGHT,))
    growing = {
        size: Bench(problem, replace(problem.scene, disturbances=disturbances_of(size, OverCases.WORST)))
        for size in SIZES
    }
    undisturbed_bench = Bench(problem, problem.scene)
    mean = Bench(problem, replace(problem.scene, disturbances=disturbances_of(0.0, OverCases.MEAN)))
    rows = []
    for design in random_designs(problem, options.designs):
        costs: dict[str, float] = {}
        like: Postures | None = None
        for size, bench in growing.items():
            found = bench.best(design, like)
            costs[f"{size:g}"] = cost_of(found)
            like = found.postures or None
        undisturbed = undisturbed_bench.best(design, like)
        at_zero = {
            "worst": cost_of(growing[0.0].best(design, undisturbed.postures)),
            "mean": cost_of(mean.best(design, undisturbed.postures)),
        }
        rows.append(Row(costs, cost_of(undisturbed), at_zero))
    figures = {
        "designs": len(rows),
        "least_growth": min(row.least_growth for row in rows),
        "largest_difference_at_zero": {
            way: max(abs(row.at_zero[way] - row.undisturbed) for row in rows) for way in OverCases
        },
    }
    target = HERE / "results" / "disturbed_growth.json"
    target.write_text(
        json.dumps({**figures, "sizes": SIZES, "rows": [asdict(row) for row in rows]}, indent=2) + "\n"
    )
    print(json.dumps(figures, indent=2))


if __name__ == "__main__":
    main()
