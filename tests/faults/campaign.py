"""The long fault campaign (`make faults`): python -m tests.faults.campaign [--kills N]."""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from pathlib import Path

from tests.faults.damage import cut, flip, write_log
from tests.faults.kills import Size, kill_processes, kill_workers, timed


def main() -> None:
    parser = argparse.ArgumentParser(description="kill searches and damage logs")
    parser.add_argument("--kills", type=int, default=100, help="of processes, and as many of workers")
    parser.add_argument("--flips", type=int, default=500, help="bytes changed, one at a time")
    parser.add_argument("--cuts", type=int, default=65536, help="last bytes of a log, each cut off there")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        content = write_log(folder, 160)
        say(f"a log of {len(content)} bytes")
        began = time.monotonic()
        report = flip(folder, content, options.flips, options.seed)
        say(
            f"{report.logs} changed bytes: {report.unharmed} cost nothing, the others one evaluation at most "
            f"({time.monotonic() - began:.0f} s)"
        )
        began = time.monotonic()
        report = cut(folder, content, range(max(len(content) - options.cuts, 0), len(content)))
        say(f"{report.logs} cuts: always a prefix of what was written ({time.monotonic() - began:.0f} s)")
        began = time.monotonic()
        tally = kill_processes(folder, options.kills, Size(600, 0.01, 2), options.seed, longest=2.0)
        say(f"processes: {timed(tally, began)}")
        began = time.monotonic()
        tally = kill_workers(folder, options.kills, Size(1200, 0.01, 2), options.seed)
        say(f"workers: {timed(tally, began)}")


def say(sentence: str) -> None:
    sys.stdout.write(sentence + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    main()
