"""What hardware genes cost: processor time of an evaluation, as a multiple of the point-grasp problem's.

    python -m benchmarks.hardware_speed [--designs N]

Random designs of each problem, evaluated in turns in one process: the point-grasp problem, actuators sized by
demand, rated torques as genes, and the sequel's three motors with nine people and loads.
Written to benchmarks/results/hardware_speed.json, printed as a table.
"""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path

import msgspec
import numpy as np

from evodesign.evaluation.evaluate import Evaluator
from evodesign.evaluation.factory import evaluator_of
from evodesign.problem.build import build_problem
from evodesign.problem.source import read_source
from evodesign.records import ProblemSource, Status

RESULTS = Path(__file__).parent / "results" / "hardware_speed.json"
DEFAULT, SIZED, RATED, MOTORS = "default", "sized", "rated", "three motors"


def sources() -> dict[str, ProblemSource]:
    """The problems that are compared, by name."""
    sized = read_source("icub-hardware")
    rated = sized.text.replace("margin = [1.0, 4.0]", "rated_torque_n_m = [2.0, 100.0]")
    return {
        DEFAULT: read_source("point-grasp"),
        SIZED: sized,
        RATED: msgspec.structs.replace(sized, text=rated),
        MOTORS: read_source("sartore2023-motors"),
    }


def measured(evaluators: dict[str, Evaluator], designs: int) -> dict[str, dict[str, float]]:
    """Milliseconds of processor time per design, and multiples of the point-grasp problem's median."""
    seconds = {name: np.zeros(designs) for name in evaluators}
    holds = {name: np.zeros(designs, bool) for name in evaluators}
    for number in range(designs):
        for name, evaluator in evaluators.items():
            generator = np.random.default_rng(number)
            genome = tuple(generator.random(len(evaluator.problem.space.parameters)).tolist())
            began = time.process_time()
            assessed = evaluator.assess(genome)
            seconds[name][number] = time.process_time() - began
            holds[name][number] = assessed.assessment.status is Status.SOLVED
    usual = float(np.median(seconds[DEFAULT]))
    return {
        name: {
            "median_ms": round(1e3 * float(np.median(each)), 1),
            "mean_ms": round(1e3 * float(each.mean()), 1),
            "held": int(holds[name].sum()),
            "ratio_of_held": round(float(np.median(each[holds[name]])) / usual, 2),
            "ratio_of_means": round(float(each.mean() / seconds[DEFAULT].mean()), 2),
            "designs_per_second": round(1.0 / float(each.mean()), 1),
        }
        for name, each in seconds.items()
    }


def main() -> None:
    """Measure, print a Markdown table, write the figures."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--designs", type=int, default=40)
    options = parser.parse_args()
    evaluators = {name: evaluator_of(build_problem(source), 2) for name, source in sources().items()}
    for evaluator in evaluators.values():  # compiles
        evaluator.assess((0.5,) * len(evaluator.problem.space.parameters))
    rows = measured(evaluators, options.designs)
    columns = list(rows[DEFAULT])
    print("| problem |", " | ".join(columns), "|")
    print("|---" * (1 + len(columns)) + "|")
    for name, row in rows.items():
        print(f"| {name} |", " | ".join(str(row[column]) for column in columns), "|")
    RESULTS.write_text(json.dumps({"designs": options.designs, "problems": rows}, indent=2) + "\n")


if __name__ == "__main__":
    main()
