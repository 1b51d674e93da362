"""A session in a process of its own, to be killed: python -m tests.runlog.slow_session DIR.

It stops in the middle of its fourth generation, and goes on for ever.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

from evodesign.evolve import start
from evodesign.runlog.session_log import Silent
from tests.runlog.toys import OrderedPool, ToySearch, ToyTask, toy_header

LAST, FOR_EVER = 17, 3600.0


def main() -> None:
    header = toy_header(population=5, budget=200)
    task = ToyTask(header, before=lambda call: time.sleep(FOR_EVER if call == LAST else 0.02))
    start(Path(sys.argv[1]), header, task, OrderedPool(), Silent(), make_search=ToySearch)


if __name__ == "__main__":
    main()
