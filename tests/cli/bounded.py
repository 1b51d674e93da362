"""Commands in processes that may use 300 MB beyond what they import, and six times its processor time.

Importing takes 1.3 s on an idle machine, and about as much longer as everything else on a slow or busy one.
What grows faster than its input takes many times as long.
"""

from __future__ import annotations

import math
import os
import resource
import subprocess
import sys
from pathlib import Path

IMPORTS, BYTES = 6, 300_000_000


def evodesign_bounded(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    """What a command does within the bounds; beyond them it is killed, or fails with a traceback."""
    command = [sys.executable, "-m", "tests.cli.bounded", *map(str, arguments)]
    root = Path(__file__).parents[2]
    environment = os.environ | {"OPENBLAS_NUM_THREADS": "1"}  # stacks of idle threads are no memory of ours
    return subprocess.run(
        command, cwd=root, env=environment, capture_output=True, text=True, timeout=120, check=False
    )


def _bound() -> None:
    """Set the bounds from what this process has used so far."""
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
    room = pages * resource.getpagesize() + BYTES
    resource.setrlimit(resource.RLIMIT_AS, (room, room))
    usage = resource.getrusage(resource.RUSAGE_SELF)
    seconds = math.ceil((1 + IMPORTS) * max(usage.ru_utime + usage.ru_stime, 1.0))
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))


if __name__ == "__main__":
    import casadi  # noqa: F401
    import lxml.etree  # noqa: F401
    import scipy.interpolate  # what a command loads when it needs it counts as what it imports
    import scipy.optimize
    import scipy.spatial  # noqa: F401

    import evodesign.cli.check
    import evodesign.guess.preflight
    import evodesign.problem.inertia_rules
    import evodesign.problem.mesh_reading  # noqa: F401
    from evodesign.cli import main

    _bound()
    main()
