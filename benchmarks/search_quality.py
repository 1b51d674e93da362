"""Does a search find a better front than random sampling with the same budget?

Every algorithm searches the point-grasp problem with every seed; hypervolumes are taken against one reference
point, the worst of all feasible evaluations of all runs made worse by a tenth of the range. Results go to
benchmarks/results/search_quality.json and are printed as a Markdown table.

    python benchmarks/search_quality.py [--evaluations 480] [--population 48] [--seeds 3] [--jobs 2]
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

from evodesign.analysis.hypervolume import hypervolume, reference_point
from evodesign.runlog.run import RunLog, read_run

HERE = Path(__file__).parent
PROBLEM = HERE.parent / "problems" / "point_grasp.toml"
ALGORITHMS = ("random", "nsga2", "cma-es")


Runs = dict[tuple[str, int], RunLog]
"""By algorithm and seed."""


def main() -> None:
    """Run all searches, compare, write and print."""
    options = read_options("Searches against random sampling.")
    report(PROBLEM, search_all(PROBLEM, options), options, "search_quality.json")


def search_all(problem: Path, options: argparse.Namespace) -> Runs:
    """Every algorithm's run of a problem with every seed."""
    with tempfile.TemporaryDirectory() as folder:
        return {
            (algorithm, seed): _search(problem, Path(folder), algorithm, seed, options)
            for algorithm in ALGORITHMS
            for seed in range(1, options.seeds + 1)
        }


def report(problem: Path, runs: Runs, options: argparse.Namespace, name: str) -> None:
    """Compare runs of a problem by hypervolume; write the results to a file of a name, and print a table."""
    objectives = next(iter(runs.values())).header.objectives
    reference = reference_point(objectives, [e for run in runs.values() for e in run.evaluations])
    if reference is None:
        sys.exit("no run found a feasible design")
    volumes = {key: hypervolume(objectives, run.evaluations, reference) for key, run in runs.items()}
    rows = [
        {
            "algorithm": algorithm,
            "seed": seed,
            "hypervolume": volume,
            "ratio_to_random": volume / volumes["random", seed],
        }
        for (algorithm, seed), volume in volumes.items()
    ]
    result = {
        "problem": problem.name,
        "evaluations": options.evaluations,
        "population": options.population,
        "reference": reference,
        "rows": rows,
    }
    target = HERE / "results" / name
    target.parent.mkdir(exist_ok=True)
    target.write_text(json.dumps(result, indent=2) + "\n")
    print(f"| algorithm | seed | hypervolume | ratio to random |\n|---|---|---|---|\n{_table(rows)}")


def read_options(description: str) -> argparse.Namespace:
    """The command line's numbers."""
    parser = argparse.ArgumentParser(description=description)
    for name, default in (("evaluations", 480), ("population", 48), ("seeds", 3), ("jobs", 2)):
        parser.add_argument(f"--{name}", type=int, default=default)
    return parser.parse_args()


def _search(problem: Path, folder: Path, algorithm: str, seed: int, options: argparse.Namespace) -> RunLog:
    run = folder / f"{algorithm}-{seed}"
    numbers = {
        "--seed": seed,
        "--evaluations": options.evaluations,
        "--population": options.population,
        "--jobs": options.jobs,
    }
    command = [sys.executable, "-m", "evodesign", "search", str(problem)]
    command += ["--run", str(run), "--algorithm", algorithm, "--json"]
    command += [str(part) for pair in numbers.items() for part in pair]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return read_run(run)


def _table(rows: list[dict[str, str | int | float]]) -> str:
    return "\n".join(
        f"| {row['algorithm']} | {row['seed']} | {row['hypervolume']:.3f} | {row['ratio_to_random']:.2f} |"
        for row in rows
    )


if __name__ == "__main__":
    main()
