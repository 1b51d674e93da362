"""Humanoids of other make, from their URDF to a front by default settings: seconds of each step.

    python -m benchmarks.public_robots [--evaluations N] [--robots NAME,...]

Each robot begins with an empty cache. Written to benchmarks/results/public_robots.json, printed as a table.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from tests.robots import HUMANOIDS

RESULTS = Path(__file__).parent / "results" / "public_robots.json"
COMMAND = [sys.executable, "-m", "evodesign"]


def timed(folder: Path, *arguments: object) -> tuple[float, str]:
    """Seconds of a command that must end well, and what it prints."""
    began = time.monotonic()
    done = subprocess.run(
        [*COMMAND, *map(str, arguments)],
        cwd=folder,
        env={**os.environ, "EVODESIGN_CACHE": str(folder / "cache"), "OMP_NUM_THREADS": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode:
        sys.exit(f"{' '.join(map(str, arguments))}: {done.stderr}")
    return time.monotonic() - began, done.stdout


def measured(urdf: Path, evaluations: int) -> dict[str, Any]:
    """Seconds of each step, and what came of it."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        init, _ = timed(folder, "init", urdf, "--to", "robot.toml")
        check, checked = timed(folder, "check", "robot.toml", "--json")
        cold, _ = timed(folder, "evaluate", "robot.toml")
        warm, evaluated = timed(folder, "evaluate", "robot.toml", "--json")
        sizes = ("--evaluations", evaluations, "--population", 12, "--jobs", 2)
        search, _ = timed(folder, "search", "robot.toml", "--run", "run", *sizes)
        _, front = timed(folder, "front", "run", "--json")
    result = json.loads(evaluated)
    return {
        "seconds": {"init": init, "check": check, "cold": cold, "warm": warm, "search": search},
        "parameters": len(json.loads(checked)["parameters"]),
        "reach_m": [result["reach"]["lowest_m"], result["reach"]["highest_m"]],
        "solved": [height["status"] == "solved" for height in result["heights"]],
        "robot_torque_n_m": result["objectives"].get("robot_torque"),
        "front": len(json.loads(front)["designs"]),
    }


def main() -> None:
    """Measure the robots that are asked for."""
    parser = argparse.ArgumentParser(description="public humanoids by default settings")
    parser.add_argument("--evaluations", type=int, default=48)
    parser.add_argument("--robots", default=",".join(HUMANOIDS))
    options = parser.parse_args()
    results = json.loads(RESULTS.read_text()) if RESULTS.exists() else {}
    sys.stdout.write("| robot | reach [m] | init | check | evaluate, cold | warm | search | on the front |\n")
    sys.stdout.write("|---|---|---|---|---|---|---|---|\n")
    for name in options.robots.split(","):
        found = results[name] = measured(HUMANOIDS[name], options.evaluations)
        RESULTS.write_text(json.dumps(results, indent=2) + "\n")
        low, high = found["reach_m"]
        seconds = " | ".join(f"{value:.0f} s" for value in found["seconds"].values())
        sys.stdout.write(f"| {name} | {low:.2f} to {high:.2f} | {seconds} | {found['front']} |\n")
        sys.stdout.flush()


if __name__ == "__main__":
    main()
