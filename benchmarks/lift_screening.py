"""Whether statics could spare a search of lifts some of its motions, told from a search that made them all.

Every design of a run is held still at five heights. Then the run is gone through again, generation by
generation: a design gets a motion only where the torques that it might have, those of its holds times a low
quantile of what motion made of designs before it, are not beaten by a design that was moved. Results go to
benchmarks/results/lift_screening.json: processor time of holds and lifts of a design [s], and for each
quantile how many motions are spared, how many of these wrongly (they would have been on the front of those
before them), and the share of the time.

    python -m benchmarks.lift_screening RUN
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.inner_problem import HERE, processors
from evodesign.evaluation.factory import evaluator_of
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.records import Hold
from evodesign.runlog.run import read_run

HEIGHTS = (0.8, 0.9, 1.0, 1.1, 1.2)
TORQUES, REACH = ("robot_torque", "human_torque"), "reach_height"
QUANTILES = (0.0, 0.02, 0.05, 0.1)

Array = NDArray[np.float64]


def main() -> None:
    """Measure, write and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("run", type=Path)
    run = read_run(parser.parse_args().run)
    problem = held_still(build_problem(run.header.problem))
    evaluator, moved, still = evaluator_of(problem, processors()), [], []
    evaluator.assess_values(problem.space.unscaled(problem.scene.robot.tree))  # makes everything ready
    began = time.process_time()
    for each in run.evaluations:
        values = [each.assessment.design[parameter.name] for parameter in problem.space.parameters]
        held = evaluator.assess_values(values).assessment
        if each.feasible and held.objectives:
            moved.append((each.generation, each.seconds, objectives(each.assessment.objectives)))
            still.append(objectives(held.objectives))
    seconds = (time.process_time() - began) / len(run.evaluations)
    generations, times, lifts = (np.array(column) for column in zip(*moved, strict=True))
    result = {
        "designs": len(lifts),
        "seconds_of_holds": round(seconds, 4),
        "seconds_of_lifts": round(float(times.mean()), 3),
        "torque_of_lift_over_holds": dict(
            zip(TORQUES, np.quantile(lifts / np.array(still), 0.5, axis=0)[:2].round(3).tolist(), strict=True)
        ),
        "by_quantile": {f"{q:g}": spared(generations, times, lifts, np.array(still), q) for q in QUANTILES},
    }
    (HERE / "results" / "lift_screening.json").write_text(json.dumps(result, indent=2) + "\n")
    print(json.dumps(result, indent=2))


def held_still(problem: DesignProblem) -> DesignProblem:
    """The problem with holds in place of its lifts."""
    return replace(problem, tasks=tuple(Hold(height_m=height) for height in HEIGHTS))


def objectives(found: Mapping[str, float]) -> list[float]:
    """Torques and reach, all to be made small."""
    return [*(found[name] for name in TORQUES), -found[REACH]]


def spared(generations: Array, times: Array, lifts: Array, still: Array, quantile: float) -> dict[str, Any]:
    """What screening with a quantile spares."""
    skipped: list[int] = []
    wrongly = 0
    for place in range(len(lifts)):
        before = [k for k in range(place) if generations[k] < generations[place] and k not in skipped]
        if not before:
            continue
        known, hopeful = lifts[before], still[place].copy()
        hopeful[:2] *= np.quantile(known[:, :2] / still[before][:, :2], quantile, axis=0)
        if beaten(hopeful, known):
            skipped.append(place)
            wrongly += not beaten(lifts[place], known)
    return {
        "spared": len(skipped),
        "wrongly": wrongly,
        "share_of_time": round(float(times[skipped].sum() / times.sum()), 3),
    }


def beaten(one: Array, others: Array) -> bool:
    """Whether another is no worse in anything and better in something."""
    return bool(((others <= one).all(axis=1) & (others < one).any(axis=1)).any())


if __name__ == "__main__":
    main()
