"""What a search costs outside its evaluations, at 15 evaluations per second and core.

Every evaluation sleeps for a fifteenth of a second, so that it takes no core from anything else; the loop,
the search, the log, its syncing to disk and the pool are the real ones. Workers wait from the end of one
evaluation to the beginning of the next; with generations also for the slowest of each, which is left out by
giving all the same time and a population that is a multiple of the jobs.

    python benchmarks/overhead.py --jobs 4 --evaluations 1200
"""

from __future__ import annotations

import argparse
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import msgspec
from idle_share import assess, header_of

from evodesign.evolve import start
from evodesign.pool.base import Pool
from evodesign.pool.joblib_pool import JoblibPool
from evodesign.records import Assessed, Genome
from evodesign.runlog.session_log import Silent

SECONDS = 1.0 / 15.0
POPULATION = 48
RESULTS = Path(__file__).parent / "results" / "overhead.json"


def asleep() -> Callable[[Genome], Assessed]:
    """An evaluation that takes its time and no core."""
    return _sleep


def _sleep(genome: Genome) -> Assessed:
    time.sleep(SECONDS)
    return assess(genome)


def measured(pool: Pool, jobs: int, algorithm: str, evaluations: int, asynchronous: bool) -> dict[str, float]:
    """Share of the wall time in which workers wait, once they are started."""
    list(pool.run(asleep, [(0.5,) * 16] * 4 * jobs))
    header = header_of(algorithm, POPULATION, evaluations, asynchronous)
    with tempfile.TemporaryDirectory() as folder:
        begun, main = time.perf_counter(), time.process_time()
        run = start(Path(folder) / "run", header, asleep, pool, Silent())
        wall, main = time.perf_counter() - begun, time.process_time() - main
    worked = sum(evaluation.seconds for evaluation in run.evaluations)
    return {"waiting_share": 1.0 - worked / (wall * jobs), "main_seconds_per_evaluation": main / evaluations}


def main() -> None:
    """Measure, print a Markdown table, write the figures."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--jobs", type=int, default=4)
    parser.add_argument("--evaluations", type=int, default=1200)
    options = parser.parse_args()
    rows = []
    print("| search | mode | waiting | main process per evaluation |")
    print("|---|---|---|---|")
    with JoblibPool(options.jobs) as pool:
        for algorithm in ("nsga2", "cma-es"):
            for asynchronous in (False, True):
                figures = measured(pool, options.jobs, algorithm, options.evaluations, asynchronous)
                mode = "asynchronous" if asynchronous else "generations"
                rows.append({"search": algorithm, "mode": mode, **figures})
                main_ms = 1e3 * figures["main_seconds_per_evaluation"]
                print(
                    f"| {algorithm} | {mode} | {figures['waiting_share']:.1%} | {main_ms:.1f} ms |",
                    flush=True,
                )
    written = {"jobs": options.jobs, "evaluations": options.evaluations, "cases": rows}
    RESULTS.write_bytes(msgspec.json.format(msgspec.json.encode(written), indent=2) + b"\n")


if __name__ == "__main__":
    main()
