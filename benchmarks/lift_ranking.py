"""How motion reorders designs: the same random designs held still, and lifted in 3, 1.5 and 1 s.

Of each design of point-grasp the mean and the largest torque norm of the robot: over holds at five
heights from 0.8 to 1.2 m, each in a stance of its own; and over lifts of 3, 1.5 and 1 s, in one stance.
Kendall's tau is that with the ranking of holds, over the designs that have all of them.
Results go to benchmarks/results/lift_ranking.json.

    python -m benchmarks.lift_ranking [--designs 50]
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Mapping

import numpy as np
from scipy.stats import kendalltau

from benchmarks.inner_problem import HERE, Design, problem_at, processors, random_designs
from evodesign.evaluation.factory import evaluator_of
from evodesign.evaluation.lifts import Lifts
from evodesign.problem.build import DesignProblem
from evodesign.tasks import Lift

HEIGHTS = (0.8, 0.9, 1.0, 1.1, 1.2)
SECONDS = (3.0, 1.5, 1.0)
HOLDS = "holds"

Torques = Mapping[str, tuple[float, float]]


def main() -> None:
    """Measure, write and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--designs", type=int, default=50)
    designs = parser.parse_args().designs
    problem = problem_at(HEIGHTS)
    ranked = _Ranked(problem)
    found = [ranked.torques(design) for design in random_designs(problem, designs)]
    rows = [each for each in found if each is not None]
    result: dict[str, object] = {"designs": designs, "with_all": len(rows)}
    for name in rows[0]:
        mean, peak = np.array([row[name] for row in rows]).T
        held_mean, held_peak = np.array([row[HOLDS] for row in rows]).T
        result[name] = {
            "mean_over_holds": float(np.median(mean / held_mean)),
            "peak_over_holds": float(np.median(peak / held_peak)),
            "tau_of_mean": float(kendalltau(mean, held_mean).statistic),
            "tau_of_peak": float(kendalltau(peak, held_peak).statistic),
        }
    (HERE / "results" / "lift_ranking.json").write_text(json.dumps(result, indent=2) + "\n")
    print(json.dumps(result, indent=2))


class _Ranked:
    """Holds and lifts of a problem's designs."""

    def __init__(self, problem: DesignProblem) -> None:
        self._asked = [Lift(HEIGHTS[0], HEIGHTS[-1], seconds) for seconds in SECONDS]
        self._evaluator = evaluator_of(problem, processors(), lifts=self._asked)
        self._lifts = Lifts(self._evaluator, self._evaluator.known)

    def torques(self, design: Design) -> Torques | None:
        """Mean and largest torque norm of the robot [N m]; None where a hold or a lift is missing."""
        held = self._evaluator.solve(design).cases
        if not all(each.solved for each in held):
            return None
        norms = [each.postures["robot"].torque_norm for each in held]
        found = {HOLDS: (float(np.mean(norms)), max(norms))}
        for lift in self._asked:
            (solution,) = self._lifts.solve(design, lift).values()
            if not solution.solved:
                return None
            effort = solution.efforts["robot"]
            found[f"{lift.seconds:g} s"] = effort.mean_torque, effort.peak_torque
        return found


if __name__ == "__main__":
    main()
