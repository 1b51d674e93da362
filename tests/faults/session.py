"""A session in a process of its own, to be killed.

    python -m tests.faults.session DIR SEED BUDGET SECONDS JOBS

Begins a run or goes on with it, and prints the number of every evaluation that is reported as done.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

from evodesign.evolve import Silent, resume, start
from evodesign.pool.registry import make_pool
from evodesign.records import Evaluation
from evodesign.runlog.directory import segments
from tests.faults.synthetic import Synthetic, synthetic_header


class Reporter(Silent):
    def evaluated(self, evaluation: Evaluation, done: int, budget: int) -> None:
        os.write(1, f"{evaluation.number}\n".encode())


def main() -> None:
    directory, seed, budget, seconds, jobs = sys.argv[1:]
    header = synthetic_header(int(budget), int(seed))
    task = Synthetic(header, float(seconds))
    with make_pool("joblib" if int(jobs) > 1 else "serial", int(jobs)) as pool:
        if segments(Path(directory)):
            resume(Path(directory), lambda header: Synthetic(header, float(seconds)), pool, Reporter(), None)
        else:
            start(Path(directory), header, task, pool, Reporter())


if __name__ == "__main__":
    main()
