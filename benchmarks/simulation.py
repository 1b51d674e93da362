"""Designs of fronts in MuJoCo: how far holds and lifts are from their plans at most.

Every hold of the first designs of each run's front is simulated for 2 s, and their lift from 0.8 to 1.2 m in
1.5 s, as `evodesign simulate` does it. Where no run is named, two are made: 60 evaluations of NSGA-II for
point-grasp and icub-hardware. What is printed is the worst of each run; all of it goes to
benchmarks/results/simulation.json.

    python -m benchmarks.simulation [RUN ..] [--designs 5] [--knots 24]
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import evodesign
from benchmarks.inner_problem import HERE
from evodesign.analysis.front import front
from evodesign.control.gains import Feedback
from evodesign.evaluation.factory import evaluator_of
from evodesign.evaluation.lifts import Lifts
from evodesign.evaluation.progress import SILENT
from evodesign.evaluation.simulation_json import simulations_json
from evodesign.evaluation.simulations import HOLD_SECONDS, simulated_holds, simulated_lifts
from evodesign.records import Lift
from evodesign.report.opened_design import open_design
from evodesign.runlog.run import read_run

FEEDBACK = Feedback()


def simulations(run: Path, designs: int, knots: int) -> Iterator[dict[str, Any]]:
    """Each hold and each lift of the first designs of a front, in JSON's terms."""
    log, lifts = read_run(run), None
    for evaluation in front(log.header.objectives, log.evaluations)[:designs]:
        opened = open_design(log, evaluation.number, 1, SILENT)
        problem, robot = opened.rebuilt.problem, opened.scene_set().robot
        holds = tuple(simulated_holds(problem.scenes, robot, opened.cases, HOLD_SECONDS, FEEDBACK))
        lift = Lift(0.8, 1.2, 1.5, knots=knots)
        if lifts is None:
            evaluator = evaluator_of(problem, 1, SILENT, [lift])
            lifts = Lifts(evaluator, evaluator.known)
        values = [evaluation.assessment.design[each.name] for each in problem.space.parameters]
        found = lifts.solve(values, lift)
        for solution in found.values():
            if not solution.solved:
                print(f"design {evaluation.number}: no lift: {solution.reason}")
        moved = tuple(simulated_lifts(problem.scenes, robot, found, FEEDBACK))
        for kind, each in (("holds", holds), ("lifts", moved)):
            for told in simulations_json(each, FEEDBACK)["simulations"]:
                yield {"design": evaluation.number, "kind": kind, **told}


def worst(found: list[dict[str, Any]]) -> str:
    """The largest figures of some simulations."""
    agents = [agent for each in found for agent in each["agents"].values()]
    torque = max((agent["torque_share"], agent["torque_difference_n_m"]) for agent in agents)
    return (
        f"{len(found)} simulated, {sum(not each['stands'] for each in found)} fell, "
        f"load off by {1e3 * max(each['drift_m'] for each in found):.2f} mm, "
        f"joints by {1e3 * max(agent['tracking_rad'] for agent in agents):.1f} mrad, "
        f"torques by {100.0 * torque[0]:.1f} % ({torque[1]:.2g} N m), "
        f"slip {1e3 * max(agent['slip_m'] for agent in agents):.3f} mm, "
        f"{sum(bool(agent['at_limit']) for agent in agents)} with a torque at its limit"
    )


def made(folder: Path) -> Iterator[Path]:
    """Small runs of both problems."""
    for problem in ("point-grasp", "icub-hardware"):
        evodesign.search(problem, folder / problem, evaluations=60, algorithm="nsga2")
        yield folder / problem


def _add(results: dict[str, list[dict[str, Any]]], run: Path, designs: int, knots: int) -> None:
    name = read_run(run).header.problem_name
    results[name] = found = list(simulations(run, designs, knots))
    for kind in ("holds", "lifts"):
        some = [each for each in found if each["kind"] == kind]
        print(f"{name}, {kind}: {worst(some) if some else 'none'}", flush=True)


def main() -> None:
    """Simulate, print and keep."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("runs", nargs="*", type=Path)
    parser.add_argument("--designs", type=int, default=5)
    parser.add_argument("--knots", type=int, default=24)
    asked = parser.parse_args()
    results: dict[str, list[dict[str, Any]]] = {}
    with TemporaryDirectory() as folder:
        for run in asked.runs or made(Path(folder)):
            _add(results, run, asked.designs, asked.knots)
    text = json.dumps(results, indent=1, sort_keys=True) + "\n"
    (HERE / "results" / "simulation.json").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
