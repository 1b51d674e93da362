"""Writes the golden runs of this format version: python -m tests.golden.write_run. Never written over.

One is of toys, the other of real robots in a problem that has everything that the log can hold. The latter is
the run of the format before, recovered: solvers have become better since it was searched.
"""

from __future__ import annotations

from pathlib import Path

from evodesign.evolve import resume, start
from evodesign.records import FORMAT_VERSION
from evodesign.runlog.rewrite import recover
from evodesign.runlog.session_log import Silent
from tests.faults.synthetic import synthetic_header
from tests.runlog.toys import OrderedPool, ToyTask, shuffled

FOLDER = Path(__file__).parent
LIFTING = FOLDER / "lifting"


def main() -> None:
    directory = FOLDER / f"format-{FORMAT_VERSION}"
    header = synthetic_header(budget=13, seed=6, population=6)
    start(directory, header, ToyTask(header), OrderedPool(shuffled(2)), Silent())
    resume(directory, ToyTask, OrderedPool(shuffled(3)), Silent(), 20)
    real = LIFTING / f"format-{FORMAT_VERSION}"
    recover(LIFTING / f"format-{FORMAT_VERSION - 1}", real)
    for run in (directory, real):
        (run / "lock").unlink()


if __name__ == "__main__":
    main()
