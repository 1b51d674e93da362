"""A session in a process of its own, slow enough to be killed: python -m tests.runlog.slow_session DIR."""

from __future__ import annotations

import sys
import time
from pathlib import Path

from evodesign.evolve import Silent, start
from tests.runlog.toys import OrderedPool, ToySearch, ToyTask, toy_header

SECONDS = 0.02


def main() -> None:
    header = toy_header(population=5, budget=200)
    task = ToyTask(header, before=lambda call: time.sleep(SECONDS))
    start(Path(sys.argv[1]), header, task, OrderedPool(), Silent(), make_search=ToySearch)


if __name__ == "__main__":
    main()
