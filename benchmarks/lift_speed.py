"""Lifts by the native method against IPOPT, its judge: the same starts in turn, in one process.

Random designs of the point-grasp problem lift from 0.8 to 1.2 m and from 0.6 to 1.2 m in 1.5 s. Both methods
begin at the hold at the lower end, followed along the lift. Processor time per solve and per iteration,
iterations, solved lifts, and how many have the same cost within 1e-4; what is compiled or prepared before the
first solve does not count. Results go to benchmarks/results/lift_speed.json.

    python -m benchmarks.lift_speed [--designs 10] [--knots 12]
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from statistics import median

import numpy as np

from benchmarks.inner_problem import HERE, Design, checker_of, problem_at, random_designs
from evodesign.motion.instant import KnotBlocks
from evodesign.motion.lift_program import LiftProgram, LiftStart
from evodesign.motion.lifting import TOLERANCE_OF_LIFTS
from evodesign.nlp.method import MethodName
from evodesign.posture.formulations.base import Setting
from evodesign.posture.postures import PostureProblem, Symmetry
from evodesign.posture.symmetry import symmetric_forms
from evodesign.problem.build import DesignProblem
from evodesign.records import Hold
from evodesign.tasks import Lift

ENDS = ((0.8, 1.2), (0.6, 1.2))
ALIKE = 1e-4


@dataclass(frozen=True)
class Case:
    """A lift of a design, and where both methods begin."""

    design: Design
    lift: Lift
    start: LiftStart


def main() -> None:
    """Measure, write and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--designs", type=int, default=10)
    parser.add_argument("--knots", type=int, default=12)
    options = parser.parse_args()
    result = measured(problem_at((0.8, 1.2)), options.designs, options.knots)
    (HERE / "results" / "lift_speed.json").write_text(json.dumps(result, indent=2) + "\n")
    print(json.dumps(result, indent=2))


def measured(problem: DesignProblem, designs: int, knots: int) -> dict[str, object]:
    """Medians of both methods over all lifts."""
    setting = Setting(problem.scene, problem.space, problem.weights, problem.options)
    programs = {
        method: LiftProgram(
            KnotBlocks(symmetric_forms(setting.scene), setting),
            knots,
            replace(setting.options, tolerance=TOLERANCE_OF_LIFTS, method=method),
        )
        for method in MethodName
    }
    cases = list(_cases(problem, setting, programs[MethodName.NATIVE], designs, knots))
    rows: list[dict[str, tuple[float, int, str, float]]] = []
    for number, case in enumerate([cases[0], *cases]):
        row = {}
        for method, program in programs.items():
            began = time.process_time()
            ending, _ = program.solve(case.lift, case.start, case.design, setting.scene.payload.mass)
            row[method.value] = time.process_time() - began, ending.iterations, ending.word, ending.cost
        if number:  # the first makes everything ready
            rows.append(row)
    native, ipopt = ([row[method.value] for row in rows] for method in MethodName)
    alike = [abs(a[3] - b[3]) <= ALIKE * abs(b[3]) for a, b in zip(native, ipopt, strict=True)]
    return {
        "lifts": len(rows),
        "knots": knots,
        **{
            method.value: {
                "seconds": median(each[0] for each in found),
                "iterations": median(each[1] for each in found),
                "milliseconds_per_iteration": 1e3 * median(each[0] / each[1] for each in found),
                "solved": sum(each[2].startswith("Solve") for each in found),
            }
            for method, found in zip(MethodName, (native, ipopt), strict=True)
        },
        "ratio_of_sums": sum(each[0] for each in ipopt) / sum(each[0] for each in native),
        "median_ratio": float(np.median([b[0] / a[0] for a, b in zip(native, ipopt, strict=True)])),
        "same_cost": sum(alike),
    }


def _cases(
    problem: DesignProblem, setting: Setting, program: LiftProgram, designs: int, knots: int
) -> Iterator[Case]:
    holds = PostureProblem(setting, Symmetry.ON)
    for design in random_designs(problem, designs):
        checker = checker_of(problem, design)
        for low, high in ENDS:
            hold = holds.solve(design, Hold(height_m=low), checker)
            if hold.solved:
                lift = Lift(low, high, 1.5, knots=knots)
                yield Case(design, lift, program.followed(lift, hold.postures, 0, design))


if __name__ == "__main__":
    main()
