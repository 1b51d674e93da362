"""Long runs: memory of the search, time to open a run, and what reaching the disk costs.

    python benchmarks/long_runs.py [--evaluations 20000] [--open 100000] [--real 480]

Writes benchmarks/results/long_runs.json.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import msgspec

from evodesign.evaluation.factory import evaluation_factory
from evodesign.evolve import start
from evodesign.pool.registry import make_pool
from evodesign.pool.worker import SerialPool
from evodesign.problem.build import build_problem
from evodesign.problem.source import read_source
from evodesign.records import Evaluation
from evodesign.runlog.header import header_of
from evodesign.runlog.run import read_run
from evodesign.runlog.session_log import Silent
from evodesign.runlog.writer import RunWriter

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))

from tests.faults.synthetic import Synthetic, synthetic_header  # noqa: E402
from tests.runlog.toys import toy_evaluations, toy_header  # noqa: E402

MEGABYTE = 1e6


class Gauge(Silent):
    """Notes memory [MB] and processor time [s] at every tenth of the budget."""

    def __init__(self) -> None:
        self.began = time.process_time()
        self.memory: dict[int, float] = {}
        self.seconds: dict[int, float] = {}

    def evaluated(self, evaluation: Evaluation, done: int, budget: int) -> None:
        """Read both gauges, ten times in all."""
        if done % (budget // 10) == 0:
            self.memory[done] = round(resident() / MEGABYTE, 1)
            self.seconds[done] = round(time.process_time() - self.began, 1)


def resident() -> int:
    """Memory of this process that is in use [byte]."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE")


@contextmanager
def disk_time() -> Iterator[list[float]]:
    """Seconds of every wait for the disk, while this lasts."""
    waits: list[float] = []
    fsync = os.fsync

    def timed(descriptor: int) -> None:
        began = time.perf_counter()
        fsync(descriptor)
        waits.append(time.perf_counter() - began)

    os.fsync = timed
    try:
        yield waits
    finally:
        os.fsync = fsync


def memory_of_a_long_search(folder: Path, algorithm: str, evaluations: int) -> dict[str, Any]:
    """A search of a cheap problem in this process, with its memory and pace."""
    header = synthetic_header(evaluations, seed=1, algorithm=algorithm, population=48)
    gauge = Gauge()
    run = start(folder / algorithm, header, Synthetic(header, 0.0), SerialPool(), gauge)
    front = len(run.fronts[-1].evaluations)
    return {
        "evaluations": evaluations,
        "front": front,
        "memory_mb": gauge.memory,
        "processor_s": gauge.seconds,
    }


def opening(folder: Path, evaluations: int) -> dict[str, Any]:
    """Time of `evodesign front` and of reading alone, on a run of realistic records."""
    header = toy_header(population=48, dimension=16)
    some = toy_evaluations(header, 1000)
    with RunWriter(folder / "large", header) as log:
        for number in range(evaluations):
            log.evaluation(msgspec.structs.replace(some[number % 1000], number=number))
    size = (folder / "large" / "000.mcap").stat().st_size
    command = [sys.executable, "-m", "evodesign", "front", str(folder / "large")]
    began = time.perf_counter()
    subprocess.run(command, check=True, capture_output=True)
    command_seconds = time.perf_counter() - began
    began = time.process_time()
    read_run(folder / "large")
    read_seconds = time.process_time() - began
    return {
        "evaluations": evaluations,
        "megabytes": round(size / MEGABYTE, 1),
        "front_command_s": round(command_seconds, 2),
        "read_run_processor_s": round(read_seconds, 2),
    }


def cost_of_the_disk(folder: Path, evaluations: int) -> dict[str, Any]:
    """A real search on two workers, in this process, with every wait for the disk timed."""
    problem = build_problem(read_source(ROOT / "problems" / "point_grasp.toml"))
    settings = problem.settings(problem.search.algorithm, problem.search.population, problem.search.seed)
    header = header_of(problem, settings, evaluations)
    with disk_time() as waits, make_pool("joblib", 2) as pool:
        began = time.perf_counter()
        start(folder / "real", header, evaluation_factory(header, pool), pool, Silent())
        wall = time.perf_counter() - began
    return {
        "evaluations": evaluations,
        "wall_s": round(wall, 1),
        "disk_s": round(sum(waits), 2),
        "disk_share": round(sum(waits) / wall, 4),
        "median_wait_ms": round(sorted(waits)[len(waits) // 2] * 1e3, 2),
    }


def main() -> None:
    """Measure all and write the figures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--evaluations", type=int, default=20_000)
    parser.add_argument("--open", type=int, default=100_000)
    parser.add_argument("--real", type=int, default=480)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(dir=ROOT / "runs") as name:
        folder = Path(name)
        results = {
            "random": memory_of_a_long_search(folder, "random", options.evaluations),
            "nsga2": memory_of_a_long_search(folder, "nsga2", options.evaluations),
            "opening": opening(folder, options.open),
            "disk": cost_of_the_disk(folder, options.real),
        }
    text = msgspec.json.format(msgspec.json.encode(results), indent=2).decode()
    (ROOT / "benchmarks" / "results" / "long_runs.json").write_text(text + "\n")
    sys.stderr.write(text + "\n")


if __name__ == "__main__":
    main()
