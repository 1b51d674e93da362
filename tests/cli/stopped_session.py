"""A session with signals as on the command line.

    python -m tests.cli.stopped_session DIR HOLD GRACE HOURS [SCHEDULER]

Of 40 evaluations two run at the same time. The first ends at once, the others when the file HOLD is gone.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from evodesign.cli.session import SignalledStop
from evodesign.errors import Interrupted
from evodesign.evolve import start
from evodesign.pool.registry import make_pool
from evodesign.records import Assessed, Genome, RunHeader
from tests.faults.session import Reporter
from tests.faults.synthetic import synthetic_header
from tests.runlog.toys import toy_assessed

JOBS = 2


@dataclass(frozen=True)
class Held:
    """Builds a task that waits while a file is there, unless it is the first of all."""

    header: RunHeader
    hold: str

    def __call__(self) -> Callable[[Genome], Assessed]:
        def task(genome: Genome) -> Assessed:
            try:
                Path(f"{self.hold}.first").touch(exist_ok=False)
            except FileExistsError:
                while Path(self.hold).exists():
                    time.sleep(0.01)
            return toy_assessed(genome, self.header)

        return task


def main() -> int:
    directory, hold, grace, hours, *scheduler = sys.argv[1:]
    header = synthetic_header(budget=40, seed=1, population=20)
    stop = SignalledStop(float(hours) or None, Path(directory), float(grace))
    with make_pool("dask" if scheduler else "joblib", JOBS, *scheduler, stop=stop) as pool:
        try:
            with stop.heeded():
                start(Path(directory), header, Held(header, hold), pool, Reporter(), stop=stop)
        except Interrupted as interrupted:
            sys.stderr.write(f"{stop.why}|{interrupted}\n")
            return 3
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
