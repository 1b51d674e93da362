"""A session in a process of its own, to be killed.

    python -m tests.faults.session DIR SEED SIZE [SCHEDULER]

SIZE is a `Size` as JSON. Begins a run or goes on with it. Prints a line when it is about to, and a number and
a checksum of every evaluation that is reported as done.
"""

from __future__ import annotations

import os
import sys
import zlib
from pathlib import Path

import msgspec

from evodesign.evolve import resume, start
from evodesign.pool.registry import make_pool
from evodesign.records import Evaluation
from evodesign.runlog.directory import segments
from evodesign.runlog.session_log import Silent
from tests.faults.synthetic import Size, Synthetic

BEGINNING = b"beginning"


class Reporter(Silent):
    def evaluated(self, evaluation: Evaluation, done: int, budget: int) -> None:
        os.write(1, f"{evaluation.number} {checksum(evaluation)}\n".encode())


def checksum(evaluation: Evaluation) -> int:
    return zlib.crc32(msgspec.json.encode(evaluation))


def main() -> None:
    directory, seed = Path(sys.argv[1]), int(sys.argv[2])
    size = msgspec.json.decode(sys.argv[3], type=Size)
    header = size.header(seed)
    with make_pool(size.pool, size.jobs, *sys.argv[4:]) as pool:
        os.write(1, BEGINNING + b"\n")
        if segments(directory):
            resume(directory, lambda header: Synthetic(header, size.seconds), pool, Reporter(), None)
        else:
            start(directory, header, Synthetic(header, size.seconds), pool, Reporter())


if __name__ == "__main__":
    main()
