"""Writes the golden run of this format version: python -m tests.golden.write_run DIR. Never written over."""

from __future__ import annotations

import sys
from pathlib import Path

from evodesign.evolve import Silent, resume, start
from tests.faults.synthetic import synthetic_header
from tests.runlog.toys import OrderedPool, ToyTask, shuffled


def main() -> None:
    directory = Path(sys.argv[1])
    header = synthetic_header(budget=13, seed=6, population=6)
    start(directory, header, ToyTask(header), OrderedPool(shuffled(2)), Silent())
    resume(directory, ToyTask, OrderedPool(shuffled(3)), Silent(), 20)
    (directory / "lock").unlink()


if __name__ == "__main__":
    main()
