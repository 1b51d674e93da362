"""Public humanoids whose bodies keep clear of each other: how near they come, unscaled.

    python -m benchmarks.clear_robots [--robots NAME,...] [--fixed-starts]

Each robot's problem is what `init` writes, and begins with an empty cache. Told
are the pairs that are checked, of robot and person; those that have rows (of the robot, of its reach, of the
person); whether all heights are solved; the smallest distance of two bodies by coal, with the table and
without it; the reach with it; and processor time until the first evaluation begins, compilers included.
With `--fixed-starts` no start portfolios are worked out: they take most of that time in whole postures.
Written to benchmarks/results/clear_robots.json, printed as a table.
"""

from __future__ import annotations

import argparse
import json
import os
import tempfile
from dataclasses import replace
from pathlib import Path
from typing import Any

from benchmarks.clearance import without_table
from benchmarks.public_robots import timed
from evodesign.evaluation.clearance import distance_json, solved_distances
from evodesign.evaluation.evaluate import Evaluator
from evodesign.evaluation.factory import cached_precomputed
from evodesign.mechanics.agent import HUMAN, ROBOT
from evodesign.pool.worker import SerialPool
from evodesign.posture.precompute.meetings import REACH
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.source import read_source
from evodesign.quantities.design_result import DesignResult
from tests.robots import HUMANOIDS, MJCF_HUMANOIDS

HEAD = ("robot", "pairs checked", "with rows", "heights solved", "nearest [mm]", "without", "reach [m]", "s")
ROBOTS = HUMANOIDS | MJCF_HUMANOIDS
RESULTS = Path(__file__).parent / "results" / "clear_robots.json"


def guessed(urdf: Path, folder: Path) -> tuple[DesignProblem, DesignProblem]:
    """The problem that `init` writes for a robot, without and with `[collisions]`."""
    timed(folder, "init", urdf, "--to", "robot.toml")
    source = read_source(folder / "robot.toml")
    return build_problem(without_table(source)), build_problem(source)


def processor_seconds() -> float:
    """Of this process and of those that it waited for."""
    return sum(os.times()[:4])


def solved(evaluator: Evaluator) -> DesignResult:
    """The unscaled robot."""
    return evaluator.solve(evaluator.problem.space.unscaled(evaluator.problem.scene.robot.tree))


def free_of(problem: DesignProblem) -> DesignResult:
    """The unscaled robot of the problem without the table, from fixed starts."""
    options = replace(problem.options, compiled=False)
    return solved(Evaluator(replace(problem, options=options)))


def measured(urdf: Path, folder: Path, *, fixed_starts: bool = False) -> dict[str, Any]:
    """What came of a robot; its problem file is written to a folder."""
    problem, apart = guessed(urdf, folder)
    apart = replace(apart, start_portfolio=not fixed_starts)
    began = processor_seconds()
    with SerialPool() as pool:
        evaluator = Evaluator(apart, cached_precomputed(apart, pool))
    prepared = processor_seconds()
    result, free = solved(evaluator), free_of(problem)
    agents = {agent.name: agent.collisions for agent in apart.scene.agents}
    return {
        "checked": {who: len(rules.checked) if rules else 0 for who, rules in agents.items()},
        "with_rows": {
            who: sum(len(pairs) for (of, _), pairs in evaluator.known.meetings.items() if of == who)
            for who in (ROBOT, REACH, HUMAN)
        },
        "heights": {case.case.name: case.reason for case in result.cases},
        "solved": all(case.solved for case in result.cases),
        "reach_m": [result.reach.lowest, result.reach.highest],
        "free_reach_m": [free.reach.lowest, free.reach.highest],
        "nearest": nearest(result),
        "nearest_free": nearest(free),
        "fixed_starts": fixed_starts,
        "preparation_seconds": round(prepared - began, 1),
    }


def nearest(result: DesignResult) -> dict[str, Any]:
    """The two bodies that come nearest to each other in any posture; nothing if none is solved."""
    gaps = solved_distances(result)
    return min(map(distance_json, gaps.values()), key=lambda gap: gap["distance_m"], default={})


def row(name: str, found: dict[str, Any]) -> str:
    """A line of the table."""
    heights = "all" if found["solved"] else "not all"
    gaps = [f"{1e3 * found[key]['distance_m']:.1f}" for key in ("nearest", "nearest_free") if found[key]]
    low, high = found["reach_m"]
    counts = (" + ".join(str(count) for count in found[key].values()) for key in ("checked", "with_rows"))
    cells = [name, *counts, heights, *gaps, f"{low:.2f} to {high:.2f}", f"{found['preparation_seconds']:.0f}"]
    return f"| {' | '.join(cells)} |\n"


def main() -> None:
    """Measure the robots that are asked for."""
    parser = argparse.ArgumentParser(description="public humanoids whose bodies keep clear of each other")
    parser.add_argument("--robots", default=",".join(ROBOTS))
    parser.add_argument("--fixed-starts", action="store_true")
    options = parser.parse_args()
    print(f"| {' | '.join(HEAD)} |", "|---" * len(HEAD) + "|", sep="\n")
    for name in options.robots.split(","):
        with tempfile.TemporaryDirectory() as folder:
            os.environ["EVODESIGN_CACHE"] = folder
            found = measured(ROBOTS[name], Path(folder), fixed_starts=options.fixed_starts)
        known = json.loads(RESULTS.read_text()) if RESULTS.exists() else {}
        RESULTS.write_text(json.dumps(known | {name: found}, indent=2) + "\n")
        print(row(name, found), end="", flush=True)


if __name__ == "__main__":
    main()
