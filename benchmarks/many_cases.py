"""What a design with several people and loads costs, and what starts from neighbouring cases save.

Random designs of problems/three_people_three_loads.toml (nine pairs of a person and a load, three heights),
evaluated on one core: designs per second; the same with every person solved from the start portfolio, as if
alone; how far the cost of a posture that began beside another person is from the one that began at the
portfolio; and the point-grasp problem (one pair, three heights) in the same run. Results go to
benchmarks/results/many_cases.json.

    python -m benchmarks.many_cases [--designs 40] [--problem FILE]
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.inner_problem import HERE, PROBLEM, Design, known_at, random_designs
from evodesign.evaluation.evaluate import Evaluator
from evodesign.posture.results import CaseSolution
from evodesign.problem.build import build_problem
from evodesign.problem.source import read_source
from evodesign.quantities.design_result import DesignResult
from evodesign.records import Status

SEVERAL = PROBLEM.parent / "three_people_three_loads.toml"


def main() -> None:
    """Measure, write and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--designs", type=int, default=40)
    parser.add_argument("--problem", type=Path, default=SEVERAL)
    options = parser.parse_args()
    problem, default = (build_problem(read_source(path)) for path in (options.problem, PROBLEM))
    several = Evaluator(problem, known_at(problem, 2))
    single = Evaluator(default, known_at(default, 2))
    designs = random_designs(problem, options.designs)
    together = _timed(several, designs)
    apart = _timed(_Apart(several), designs)
    found = {
        "designs": options.designs,
        "cases": len(problem.scenes) * len(problem.tasks),
        **{f"together_{name}": value for name, value in together.items() if name != "results"},
        **{f"apart_{name}": value for name, value in apart.items() if name != "results"},
        "single_case_designs_per_second_processor": _timed(single, random_designs(default, options.designs))[
            "designs_per_second_processor"
        ],
        **_compared(together["results"], apart["results"]),
    }
    target = HERE / "results" / "many_cases.json"
    target.write_text(json.dumps(found, indent=2) + "\n")
    print(json.dumps(found, indent=2))


class _Apart:
    """The same evaluation with every scene as a problem of its own: nothing begins beside another person."""

    def __init__(self, whole: Evaluator) -> None:
        self._parts = [
            Evaluator(replace(whole.problem, scenes=(scene,)), whole.known) for scene in whole.problem.scenes
        ]

    def solve(self, values: Sequence[float]) -> list[CaseSolution]:
        """Every case of a design, in the order of the whole."""
        return [case for part in self._parts for case in part.solve(values).cases]


def _timed(evaluator: Evaluator | _Apart, designs: Sequence[Design]) -> dict[str, Any]:
    """Rates and results, after one design to warm up with."""
    evaluator.solve(designs[0])
    wall, processor = time.perf_counter(), time.process_time()
    results = [evaluator.solve(design) for design in designs]
    wall, processor = time.perf_counter() - wall, time.process_time() - processor
    return {
        "designs_per_second_wall": len(designs) / wall,
        "designs_per_second_processor": len(designs) / processor,
        "results": [r.cases if isinstance(r, DesignResult) else r for r in results],
    }


def _compared(
    together: Sequence[Sequence[CaseSolution]], apart: Sequence[Sequence[CaseSolution]]
) -> dict[str, float]:
    """Costs of the same cases both ways."""
    pairs = [
        (one, other) for t, a in zip(together, apart, strict=True) for one, other in zip(t, a, strict=True)
    ]
    both = [(_cost(one), _cost(other)) for one, other in pairs if one.solved and other.solved]
    excess = np.array([one / other - 1.0 for one, other in both])
    return {
        "solved_cases_together": sum(one.solved for one, _ in pairs),
        "solved_cases_apart": sum(other.solved for _, other in pairs),
        "largest_cost_above_apart": float(excess.max()),
        "share_within_one_percent": float((excess <= 0.01).mean()),
    }


def _cost(case: CaseSolution) -> float:
    return min(a.cost for a in case.attempts if a.status is Status.SOLVED)


if __name__ == "__main__":
    main()
