"""In how many postures bodies pass through each other, and which.

    python -m benchmarks.clearance [--problem NAME] [--designs N]

Random designs of a problem, with a gap of 5 mm between the feet and without: solved postures in which two
bodies overlap by more than 5 mm, the pairs, and how deep they are at worst.
Written to benchmarks/results/clearance.json, printed as a table.
"""

from __future__ import annotations

import argparse
import json
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np

from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.clearance import solved_distances
from evodesign.problem.factory import evaluator_of
from evodesign.problem.source import read_source

RESULTS = Path(__file__).parent / "results" / "clearance.json"
DEEP = 0.005  # [m]
GAP = 0.005  # [m]
SHOWN = 8


def measured(problem: DesignProblem, designs: int) -> dict[str, object]:
    """Overlaps in the postures of random designs."""
    evaluator, rng = evaluator_of(problem, 1), np.random.default_rng(0)
    solved, missed, pairs, depths = 0, 0, Counter[str](), dict[str, float]()
    for _ in range(designs):
        values = problem.space.values(tuple(rng.random(len(problem.space.parameters)).tolist()))
        result = evaluator.solve(values)
        gaps = solved_distances(result)
        solved, missed = solved + len(gaps), missed + len(result.cases) - len(gaps)
        for gap in gaps.values():
            if gap.distance < -DEEP:
                name = f"{gap.first}, {gap.second}"
                pairs[name] += 1
                depths[name] = min(depths.get(name, 0.0), gap.distance)
    deepest = {name: round(-1e3 * depths[name], 1) for name, _ in pairs.most_common(SHOWN)}
    return {
        "solved": solved,
        "not_solved": missed,
        "overlapping": pairs.total(),
        "pairs": dict(pairs.most_common(SHOWN)),
        "deepest_mm": deepest,
    }


def main() -> None:
    """Measure, print and write."""
    formatter = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=formatter)
    parser.add_argument("--problem", default="icub_lifting")
    parser.add_argument("--designs", type=int, default=100)
    arguments = parser.parse_args()
    own = build_problem(read_source(Path("problems") / f"{arguments.problem}.toml"))
    found = {}
    for gap in (GAP, None):
        scenes = tuple(replace(each, stance=replace(each.stance, feet_gap=gap)) for each in own.scenes)
        problem = replace(own, scenes=scenes, start_portfolio=False)
        found[f"feet_gap_m = {gap}"] = measured(problem, arguments.designs)
    for name, figures in found.items():
        print(name, json.dumps(figures, indent=2))
    known = json.loads(RESULTS.read_text()) if RESULTS.exists() else {}
    RESULTS.write_text(json.dumps({**known, arguments.problem: found}, indent=2) + "\n")


if __name__ == "__main__":
    main()
