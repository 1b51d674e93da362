"""A session with signals as on the command line: python -m tests.cli.stopped_session DIR SECONDS GRACE HOURS.

Each of 40 evaluations takes so many seconds; two run at the same time.
"""

from __future__ import annotations

import sys
from pathlib import Path

from evodesign.cli.stopping import SignalledStop
from evodesign.errors import Interrupted
from evodesign.evolve import start
from evodesign.pool.registry import make_pool
from tests.faults.session import Reporter
from tests.faults.synthetic import Synthetic, synthetic_header


def main() -> int:
    directory, seconds, grace, hours = sys.argv[1:]
    header = synthetic_header(budget=40, seed=1, population=20)
    stop = SignalledStop(float(hours) or None, Path(directory), float(grace))
    with make_pool("joblib", 2) as pool:
        try:
            with stop.heeded():
                start(Path(directory), header, Synthetic(header, float(seconds)), pool, Reporter(), stop=stop)
        except Interrupted as interrupted:
            sys.stderr.write(f"{stop.why}|{interrupted}\n")
            return 3
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
