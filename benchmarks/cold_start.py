"""A public robot's first search with an empty cache: forecasts on its way, and what fixed starts would give.

    python -m benchmarks.cold_start [--robot NAME] [--evaluations N]

The same designs are evaluated from start portfolios and from fixed starts alone, each with an empty cache:
seconds until all of them are evaluated, and how far their results differ. Written to
benchmarks/results/cold_start.json, printed as tables.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

from evodesign.records import Evaluation
from evodesign.runlog.run import RunLog, read_run
from tests.robots import HUMANOIDS

RESULTS = Path(__file__).parent / "results" / "cold_start.json"
COMMAND = [sys.executable, "-m", "evodesign"]
READY = re.compile(r"ready \d+/\d+: (?P<piece>.*) \((?P<seconds>\d+) s(?:, (?P<left>.*))?\)")
NEAR = 0.01
"""Results that differ by more are told apart."""


def searched(folder: Path, problem: str, evaluations: int) -> tuple[RunLog, float, list[dict[str, Any]]]:
    """A search of quasi-random designs with an empty cache: its run, its seconds, and what was forecast."""
    run = folder / Path(problem).stem
    sizes = ("--algorithm", "random", "--evaluations", str(evaluations), "--population", "12", "--jobs", "2")
    began = time.monotonic()
    done = subprocess.run(
        [*COMMAND, "search", problem, "--run", str(run), *sizes],
        cwd=folder,
        env={**os.environ, "EVODESIGN_CACHE": str(folder / f"{run.name} cache"), "OMP_NUM_THREADS": "1"},
        capture_output=True,
        text=True,
        check=True,
    )
    seconds = time.monotonic() - began
    told = [found.groupdict() for found in map(READY.match, done.stderr.splitlines()) if found]
    last = int(told[-1]["seconds"])
    forecasts = [{**each, "true_s": last - int(each["seconds"])} for each in told]
    return read_run(run), seconds, forecasts


def torques(evaluations: tuple[Evaluation, ...]) -> dict[tuple[Any, Any], float]:
    """Norm of all torques [N m] of each posture that was found, by design and case."""
    return {
        (each.genome, case.case): float(np.hypot(case.robot_torque_norm, case.human_torque_norm))
        for each in evaluations
        for case in each.assessment.cases
        if case.robot_torque_norm is not None and case.human_torque_norm is not None
    }


def differences(fixed: RunLog, portfolio: RunLog) -> dict[str, Any]:
    """How far results from fixed starts are from those from portfolios."""
    ours, theirs = torques(portfolio.evaluations), torques(fixed.evaluations)
    ratios = np.array([theirs[key] / ours[key] - 1.0 for key in ours.keys() & theirs.keys()])
    robot = [
        (one.assessment.objectives["robot_torque"], other.assessment.objectives["robot_torque"])
        for one in fixed.evaluations
        for other in portfolio.evaluations
        if one.genome == other.genome and one.feasible and other.feasible
    ]
    moved = np.array([abs(one / other - 1.0) for one, other in robot])
    return {
        "postures": len(ratios),
        "worse": int((ratios > NEAR).sum()),
        "better": int((ratios < -NEAR).sum()),
        "most_worse": float(ratios.max()),
        "most_better": float(ratios.min()),
        "designs": len(moved),
        "robot_torque_differs": int((moved > NEAR).sum()),
        "robot_torque_most": float(moved.max()),
    }


def main() -> None:
    """Search twice, compare, write and print."""
    parser = argparse.ArgumentParser(description="forecasts and fixed starts of a robot's first search")
    parser.add_argument("--robot", default="g1", choices=HUMANOIDS)
    parser.add_argument("--evaluations", type=int, default=48)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        init = [*COMMAND, "init", str(HUMANOIDS[options.robot]), "--to", "portfolio.toml"]
        subprocess.run(init, cwd=folder, check=True, capture_output=True)
        text = (folder / "portfolio.toml").read_text(encoding="utf-8")
        fixed_text = text.replace("[search]", "[solver]\nstart_portfolio = false\n\n[search]")
        (folder / "fixed.toml").write_text(fixed_text, encoding="utf-8")
        portfolio, seconds, forecasts = searched(folder, "portfolio.toml", options.evaluations)
        fixed, fixed_seconds, _ = searched(folder, "fixed.toml", options.evaluations)
    found = {
        "seconds": {"portfolio": seconds, "fixed": fixed_seconds},
        "seconds_per_design": {
            kind: float(np.mean([each.seconds for each in run.evaluations]))
            for kind, run in (("portfolio", portfolio), ("fixed", fixed))
        },
        "forecasts": forecasts,
        "fixed": differences(fixed, portfolio),
    }
    results = json.loads(RESULTS.read_text()) if RESULTS.exists() else {}
    RESULTS.write_text(json.dumps({**results, options.robot: found}, indent=2) + "\n")
    print("| after | forecast | true | done |\n|---|---|---|---|")
    for each in forecasts:
        print(f"| {each['seconds']} s | {each['left'] or '-'} | {each['true_s']} s | {each['piece']} |")
    print(json.dumps({key: found[key] for key in ("seconds", "seconds_per_design", "fixed")}, indent=2))


if __name__ == "__main__":
    main()
