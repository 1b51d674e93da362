"""What do disturbances cost? Time of a compiled symmetric posture solve and of a reach solve, by cases.

A case is the undisturbed load or one of the disturbances; random designs of the point-grasp problem, three
heights, the program's own starts. Times are processor time, so that other work on the machine counts little.
Results go to benchmarks/results/disturbed_speed.json and are printed as a table.

    python -m benchmarks.disturbed_speed [--designs 8]
"""

from __future__ import annotations

import argparse
import json
import time
from dataclasses import asdict, dataclass, replace

import numpy as np

from benchmarks.disturbed_ranking import HEIGHTS, LOADS
from benchmarks.inner_problem import HERE, Design, problem_at, random_designs
from evodesign.mechanics.disturbance import Disturbance, Disturbances, OverCases, PushedAt
from evodesign.mechanics.scene import Scene
from evodesign.posture.formulations.base import Setting
from evodesign.posture.formulations.reach import HIGHEST, LOWEST, ReachProblem
from evodesign.posture.postures import PostureProblem
from evodesign.problem.build import DesignProblem
from evodesign.records import Hold, Status

DISTURBANCES = (
    Disturbance("heavier", mass_share=0.2),
    Disturbance("load pushed to the person", push=(20.0, 0.0, 0.0)),
    Disturbance("load pushed to the robot", push=(-20.0, 0.0, 0.0)),
    Disturbance("robot pushed", push=(-20.0, 0.0, 0.0), at=PushedAt.ROBOT),
)


@dataclass(frozen=True, slots=True)
class Cost:
    """Of one program.

    Args:
        symbols, rows: its size.
        milliseconds: of processor time, median over solves.
        iterations: median.
        reach_milliseconds: of processor time of one reach solve, median.
        solved: share of posture solves.
    """

    symbols: int
    rows: int
    milliseconds: float
    iterations: float
    reach_milliseconds: float
    solved: float


def measured(problem: DesignProblem, scene: Scene, designs: list[Design]) -> Cost:
    """The cost of a scene's programs."""
    setting = Setting(scene, problem.space, problem.weights, problem.options)
    postures = PostureProblem(setting, problem.symmetry)
    landscapes = [postures.landscape(Hold(height_m=height)) for height in HEIGHTS]
    reach = ReachProblem(setting, symmetric=True)
    times, counts, statuses, reach_times = [], [], [], []
    for design in designs:
        for landscape in landscapes:
            for start in landscape.starts:
                began = time.process_time()
                end = landscape.solve(design, start)
                times.append(time.process_time() - began)
                counts.append(end.iterations)
                statuses.append(end.status is Status.SOLVED)
        for sense in (HIGHEST, LOWEST):
            began = time.process_time()
            solves = reach.solves(design, sense)
            reach_times.append((time.process_time() - began) / len(solves))
    program = landscapes[0].seeker.program
    return Cost(
        symbols=program.symbols.numel(),
        rows=program.rows.numel(),
        milliseconds=1e3 * float(np.median(times)),
        iterations=float(np.median(counts)),
        reach_milliseconds=1e3 * float(np.median(reach_times)),
        solved=float(np.mean(statuses)),
    )


def main() -> None:
    """Measure all, write and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--designs", type=int, default=8)
    options = parser.parse_args()
    problem = problem_at(HEIGHTS)
    designs = random_designs(problem, options.designs)
    costs = {}
    for load, (grasp, mass) in LOADS.items():
        held = replace(problem.scene, payload=replace(problem.scene.payload, grasp=grasp, mass=mass))
        for count in (0, 2, 3, 4):
            for effort in OverCases if count else (OverCases.WORST,):
                scene = replace(held, disturbances=Disturbances(DISTURBANCES[:count], effort))
                name = f"{load} | {count + 1} | {effort if count else '-'}"
                costs[name] = measured(problem, scene, designs)
                print(f"{name}: {costs[name].milliseconds:.1f} ms", flush=True)
    target = HERE / "results" / "disturbed_speed.json"
    shown = {name: asdict(cost) for name, cost in costs.items()}
    target.write_text(json.dumps({**vars(options), "figures": shown}, indent=2) + "\n")
    print(_table(costs))


def _table(costs: dict[str, Cost]) -> str:
    head = (
        "| load | cases | together | variables | rows | solve [ms] | iterations | reach solve [ms] | solved |"
    )
    return "\n".join(
        [head, "|---" * 9 + "|"]
        + [
            f"| {name} | {cost.symbols} | {cost.rows} | {cost.milliseconds:.1f} | {cost.iterations:.0f} "
            f"| {cost.reach_milliseconds:.1f} | {cost.solved:.1%} |"
            for name, cost in costs.items()
        ]
    )


if __name__ == "__main__":
    main()
