"""In how many postures bodies pass through each other, and which.

    python -m benchmarks.clearance [--problem NAME] [--designs N] [--gap]
    python -m benchmarks.clearance --front RUN [--designs N]

Random designs of a problem, with a `[collisions]` table, without, and with `--gap` also with a gap of 5 mm
between the feet instead: solved postures in which two bodies overlap by more than 5 mm, the pairs, how deep
they are at worst, processor time per design, and each case that was lost with its reason. Or designs of a
run's front, evenly from the least robot torque to the largest, without the table and with it: the lowest and
the highest load, the deepest overlap at the task's heights, and how far the robot's arms are raised sideways
there at most (the angle of an upper arm and the plane y = 0).
Written to benchmarks/results/clearance.json, printed as a table.
"""

from __future__ import annotations

import argparse
import json
import re
import time
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import msgspec
import numpy as np

from benchmarks.inner_problem import Design, processors
from evodesign.analysis.front import front
from evodesign.body.placement import Placement
from evodesign.evaluation.clearance import solved_distances
from evodesign.evaluation.evaluate import Evaluator, detail_of
from evodesign.evaluation.factory import evaluator_of
from evodesign.mechanics.agent import ROBOT
from evodesign.posture.results import CaseSolution
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.source import read_source
from evodesign.quantities.design_result import DesignResult
from evodesign.records import CaseDetail, ProblemSource
from evodesign.report.subset import subsample
from evodesign.runlog.run import read_run
from evodesign.tree.frames import link_frames

RESULTS = Path(__file__).parent / "results" / "clearance.json"
DEEP = 0.005  # [m]
GAP = 0.005  # [m]
SHOWN = 8
UPPER_ARMS = (("l_upper_arm", "l_forearm"), ("r_upper_arm", "r_forearm"))
TABLE = re.compile(r"^\[collisions\].*?(?=^\[|\Z)", re.MULTILINE | re.DOTALL)
COLUMNS = (("lowest_m", 3), ("highest_m", 3), ("deepest_mm", 0), ("arms_deg", 0))


@dataclass
class Found:
    """What random designs of a problem led to."""

    evaluator: Evaluator
    seconds: float = 0.0
    solved: int = 0
    deepest: float = 0.0
    lost: list[str] = field(default_factory=list)
    pairs: Counter[str] = field(default_factory=Counter)
    depths: dict[str, float] = field(default_factory=dict)

    def add(self, number: int, values: Design) -> None:
        """Solve another design."""
        began = time.process_time()
        result = self.evaluator.solve(values)
        self.seconds += time.process_time() - began
        self.lost += [
            f"design {number}, {case.case.name}: {case.status}: {case.reason}"
            for case in result.cases
            if not case.solved
        ]
        for gap in solved_distances(result).values():
            self.solved += 1
            self.deepest = max(self.deepest, -gap.distance)
            if gap.distance < -DEEP:
                name = f"{gap.first}, {gap.second}"
                self.pairs[name] += 1
                self.depths[name] = min(self.depths.get(name, 0.0), gap.distance)

    def told(self, designs: int) -> dict[str, object]:
        """For the table."""
        most = [name for name, _ in self.pairs.most_common(SHOWN)]
        return {
            "solved": self.solved,
            "not_solved": len(self.lost),
            "overlapping": self.pairs.total(),
            "deepest_of_all_mm": round(1e3 * self.deepest, 2),
            "pairs": {name: self.pairs[name] for name in most},
            "deepest_mm": {name: round(-1e3 * self.depths[name], 1) for name in most},
            "milliseconds_per_design": round(1e3 * self.seconds / designs, 2),
            "lost": self.lost,
        }


def measured(problems: Mapping[str, DesignProblem], designs: int) -> dict[str, dict[str, object]]:
    """Overlaps in the postures of random designs of some problems with the same parameters, in turn."""
    found = {name: Found(evaluator_of(problem, processors())) for name, problem in problems.items()}
    space, rng = next(iter(problems.values())).space, np.random.default_rng(0)
    for each in found.values():  # compiles
        each.evaluator.solve(space.unscaled(each.evaluator.problem.scene.robot.tree))
    for number in range(designs):
        values = space.values(tuple(rng.random(len(space.parameters)).tolist()))
        for each in found.values():
            each.add(number, values)
    return {name: each.told(designs) for name, each in found.items()}


def of_front(run: Path, designs: int) -> list[dict[str, Any]]:
    """Reach and arms of designs of a run's front, without and with the table."""
    log = read_run(run)
    on_front = sorted(
        front(log.header.objectives, log.evaluations),
        key=lambda each: each.assessment.objectives["robot_torque"],
    )
    chosen = subsample(on_front, designs)
    problems = [build_problem(way(log.header.problem)) for way in (without_table, with_table)]
    evaluators = [evaluator_of(problem, 1) for problem in problems]
    rows = []
    for each in chosen:
        values = problems[0].space.values(each.genome)
        found = [figures(evaluator.solve(values)) for evaluator in evaluators]
        rows.append({"design": each.number, "without": found[0], "with": found[1]})
    return rows


def figures(result: DesignResult) -> dict[str, Any]:
    """Reach [m], deepest overlap [mm], arms [deg] and heights that are not held, of a design."""
    gaps = [gap.distance for gap in solved_distances(result).values()]
    arms = [raised_sideways(result, case) for case in map(detail_of, filter(solved, result.cases))]
    return {
        "lowest_m": result.reach.lowest,
        "highest_m": result.reach.highest,
        "deepest_mm": round(1e3 * max(0.0, *(-gap for gap in gaps)), 1),
        "arms_deg": round(max(arms), 1),
        "not_solved": sum(not solved(case) for case in result.cases),
    }


def solved(case: CaseSolution) -> bool:
    """Whether a posture was found."""
    return case.solved


def raised_sideways(result: DesignResult, case: CaseDetail) -> float:
    """The larger angle of the robot's upper arms and the plane y = 0 [deg]."""
    posture = case.agents[ROBOT]
    base = Placement.from_xyz_rpy(posture.base_position_m, posture.base_rpy_rad)
    frames = link_frames(result.tree, base, posture.joints_rad)
    found = []
    for upper, lower in UPPER_ARMS:
        along = np.subtract(frames[lower].translation, frames[upper].translation)
        found.append(np.degrees(np.arcsin(abs(along[1]) / np.linalg.norm(along))))
    return float(max(found))


def with_table(source: ProblemSource) -> ProblemSource:
    """The problem with a `[collisions]` table: its own, or one that says nothing."""
    if TABLE.search(source.text):
        return source
    return msgspec.structs.replace(source, text=f"{source.text}\n[collisions]\n")


def without_table(source: ProblemSource) -> ProblemSource:
    """The problem without its `[collisions]` table."""
    return msgspec.structs.replace(source, text=TABLE.sub("", source.text))


def write(name: str, found: object) -> None:
    """Write what was found beside what others were."""
    known = json.loads(RESULTS.read_text()) if RESULTS.exists() else {}
    RESULTS.write_text(json.dumps({**known, name: found}, indent=2) + "\n")


def main() -> None:
    """Measure, print and write."""
    formatter = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=formatter)
    parser.add_argument("--problem", default="point_grasp")
    parser.add_argument("--designs", type=int, default=100)
    parser.add_argument("--gap", action="store_true")
    parser.add_argument("--front", type=Path)
    arguments = parser.parse_args()
    if arguments.front:
        rows = of_front(arguments.front, arguments.designs)
        print("| design | lowest [m] | with | highest [m] | with | overlap [mm] | with | arms [deg] | with |")
        print("|---|---|---|---|---|---|---|---|---|")
        for row in rows:
            cells = (f"{row[way][key]:.{digits}f}" for key, digits in COLUMNS for way in ("without", "with"))
            print(f"| {row['design']} | {' | '.join(cells)} |")
        write("front", rows)
        return
    source = read_source(Path("problems") / f"{arguments.problem}.toml")
    own = build_problem(without_table(source))
    apart = build_problem(with_table(source))
    problems = {"[collisions]": apart, "neither": own}
    if arguments.gap:
        scenes = tuple(replace(each, stance=replace(each.stance, feet_gap=GAP)) for each in own.scenes)
        problems[f"feet_gap_m = {GAP}"] = replace(own, scenes=scenes, start_portfolio=False)
    found = measured(problems, arguments.designs)
    for name, each in found.items():
        print(name, json.dumps(each, indent=2))
    write(arguments.problem, found)


if __name__ == "__main__":
    main()
