"""In how many postures bodies pass through each other, and which.

    python -m benchmarks.clearance [--problem NAME] [--designs N]

Random designs of a problem, with a `[collisions]` table, with a gap of 5 mm between the feet, and without
either: solved postures in which two bodies overlap by more than 5 mm, the pairs, how deep they are at worst,
and processor time per design.
Written to benchmarks/results/clearance.json, printed as a table.
"""

from __future__ import annotations

import argparse
import json
import time
from collections import Counter
from dataclasses import replace
from pathlib import Path

import msgspec
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
    evaluator.solve(problem.space.unscaled(problem.scene.robot.tree))  # compiles
    seconds = 0.0
    solved, missed, pairs, depths = 0, 0, Counter[str](), dict[str, float]()
    for _ in range(designs):
        values = problem.space.values(tuple(rng.random(len(problem.space.parameters)).tolist()))
        began = time.process_time()
        result = evaluator.solve(values)
        seconds += time.process_time() - began
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
        "milliseconds_per_design": round(1e3 * seconds / designs, 2),
    }


def main() -> None:
    """Measure, print and write."""
    formatter = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=formatter)
    parser.add_argument("--problem", default="icub_lifting")
    parser.add_argument("--designs", type=int, default=100)
    arguments = parser.parse_args()
    source = read_source(Path("problems") / f"{arguments.problem}.toml")
    own = build_problem(source)
    apart = build_problem(msgspec.structs.replace(source, text=f"{source.text}\n[collisions]\n"))
    found = {"[collisions]": measured(apart, arguments.designs), "neither": measured(own, arguments.designs)}
    scenes = tuple(replace(each, stance=replace(each.stance, feet_gap=GAP)) for each in own.scenes)
    gap = replace(own, scenes=scenes, start_portfolio=False)
    found[f"feet_gap_m = {GAP}"] = measured(gap, arguments.designs)
    for name, figures in found.items():
        print(name, json.dumps(figures, indent=2))
    known = json.loads(RESULTS.read_text()) if RESULTS.exists() else {}
    RESULTS.write_text(json.dumps({**known, arguments.problem: found}, indent=2) + "\n")


if __name__ == "__main__":
    main()
