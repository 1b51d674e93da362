"""Least times of lifts of random designs of icub_lift whose joints have torque limits.

Each design is evaluated with `lift_seconds` as an objective. Told are the objective, the time of the quickest
motion alone, the objective with fewer knots, the processor time of all and the wall time of the solves for
the least time. Results go to benchmarks/results/least_time.json.

    python -m benchmarks.least_time [--designs 10] [--limit 30]
"""

from __future__ import annotations

import argparse
import json
import time

import msgspec
import numpy as np

from benchmarks.inner_problem import HERE
from evodesign.evaluation.evaluate import Evaluator
from evodesign.motion.solution import MotionCase
from evodesign.problem.build import build_problem
from evodesign.problem.source import read_source

PROBLEM = HERE.parent / "problems" / "icub_lift.toml"


def main() -> None:
    """Measure, write and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--designs", type=int, default=10)
    parser.add_argument("--limit", type=float, default=30.0, help="of every joint of the robot [N m]")
    options = parser.parse_args()
    source = read_source(PROBLEM)
    text = source.text.replace('"human_torque"', '"human_torque", "lift_seconds"')
    limits = f'torque_limits = "hard"\n[robot.torque_limits_n_m]\n"*" = {options.limit}\n\n[human]'
    problem = build_problem(msgspec.structs.replace(source, text=text.replace("[human]", limits, 1)))
    evaluator, rng = Evaluator(problem), np.random.default_rng(11)
    found: list[dict[str, object]] = []
    for _ in range(options.designs):
        values = problem.space.values(tuple(rng.uniform(size=len(problem.space.parameters)).tolist()))
        began = time.process_time()
        (case,) = evaluator.solve(values).cases
        found.append({"processor_seconds": round(time.process_time() - began, 1), **_told(case)})
        print(found[-1], flush=True)
    text = json.dumps({"limit_n_m": options.limit, "lifts": found}, indent=2)
    (HERE / "results" / "least_time.json").write_text(text + "\n")


def _told(case: object) -> dict[str, object]:
    if not isinstance(case, MotionCase) or case.motion is None or case.motion.least is None:
        return {"reason": getattr(case, "reason", "")}
    least, course = case.motion.least, case.motion.least.course
    return {
        "lift_seconds": round(least.seconds, 5),
        "motion_seconds": None if course is None else round(course.lift.seconds, 5),
        "knots": least.lift.knots,
        "with_fewer_knots": [
            round(each.cost * least.lift.seconds, 5)
            for each in least.attempts[:-1]
            if each.status == "solved"
        ],
        "iterations": [each.iterations for each in least.attempts],
        "solve_seconds": round(sum(each.seconds for each in least.attempts), 1),
    }


if __name__ == "__main__":
    main()
