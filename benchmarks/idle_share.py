"""How long workers wait for work: a search on a simulated pool of many workers, with a simulated clock.

The loop, the search, the log and its syncing to disk are the real ones; only the evaluations are simulated,
each by a time drawn between 0.05 and 5 s and a synthetic outcome. What the main process really takes between
two ends (to log one, to tell the search, to ask it again) is measured and passes on the simulated clock too,
one after another: its time on the processor, or, with `--clock wall`, whatever passes, which on a shared
machine is other people's work as well. Waiting is counted up to the moment when nothing is left to hand out.

    python benchmarks/idle_share.py --workers 1000 --evaluations 10000
"""

from __future__ import annotations

import argparse
import heapq
import math
import random
import tempfile
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any

import msgspec

from evodesign.evolve import start
from evodesign.pool.base import Finished, Pool
from evodesign.records import (
    FORMAT_VERSION,
    Assessed,
    Assessment,
    Genome,
    Objective,
    Parameter,
    ProblemSource,
    RunHeader,
    SearchSettings,
    Sense,
    Status,
    design_of,
)
from evodesign.runlog.session_log import Silent

SHORTEST, LONGEST = 0.05, 5.0
DIMENSION = 16
NAMES = ("first", "second", "third")
PARAMETERS = tuple(Parameter(name=f"p{i}", lower=0.5, upper=2.0, unit="1") for i in range(DIMENSION))


def uniform(pick: random.Random) -> float:
    """A time [s] between the shortest and the longest."""
    return pick.uniform(SHORTEST, LONGEST)


def log_uniform(pick: random.Random) -> float:
    """A time [s] of which every order of magnitude is as frequent."""
    return math.exp(pick.uniform(math.log(SHORTEST), math.log(LONGEST)))


RESULTS = Path(__file__).parent / "results" / "idle_share.json"
CLOCKS: dict[str, Callable[[], float]] = {"cpu": time.process_time, "wall": time.perf_counter}
TIMES: dict[str, Callable[[random.Random], float]] = {"uniform": uniform, "log-uniform": log_uniform}

CASES = (
    ("nsga2", True, "uniform", 0),
    ("nsga2", True, "uniform", 1),
    ("cma-es", True, "uniform", 0),
    ("cma-es", True, "uniform", 1),
    ("nsga2", True, "log-uniform", 1),
    ("cma-es", True, "log-uniform", 1),
    ("nsga2", False, "uniform", 0),
    ("cma-es", False, "uniform", 0),
)
"""Search, whether asynchronous, times, prefetched arguments of each worker."""


def assess(genome: Genome) -> Assessed:
    """Three bowls, and a corner that is forbidden."""
    values = {
        name: sum((coordinate - 0.2 - 0.3 * index) ** 2 for coordinate in genome)
        for index, name in enumerate(NAMES)
    }
    assessment = Assessment(
        design=design_of(PARAMETERS, genome),
        objectives=values,
        violation=max(0.0, sum(genome) / DIMENSION - 0.7),
        status=Status.SOLVED,
        reason="",
    )
    return Assessed(assessment=assessment)


class SimulatedPool(Pool):
    """Workers that only let time pass.

    Args:
        workers: how many.
        prefetch: arguments that wait for each worker, as with Dask.
        seconds: draws the time of an evaluation [s].
        clock: measures what the main process takes [s].
    """

    def __init__(
        self,
        workers: int,
        prefetch: int,
        seconds: Callable[[random.Random], float],
        clock: Callable[[], float],
    ) -> None:
        self._capacity = workers * (1 + prefetch)
        self._workers = workers
        self._seconds = seconds
        self._clock = clock
        self._random = random.Random(1)
        self._now = 0.0
        self._free = deque([0.0] * workers)
        self._working: list[tuple[float, int, Genome]] = []
        self._waiting: deque[tuple[int, Genome]] = deque()
        self._done: deque[tuple[int, Genome]] = deque()
        self._main = 0.0
        self._idle = 0.0
        self.measured: dict[str, float] = {}

    def run(self, factory: Any, arguments: Iterable[Genome]) -> Iterator[Finished[Any]]:
        """Ends as they come on the simulated clock."""
        source = enumerate(arguments)
        left, counted = True, False
        flying = 0
        while left or flying:
            if not self._done and self._working:
                self._until(max(self._now, self._working[0][0]))
            end = self._done.popleft() if self._done else None
            flying -= end is not None
            while left and flying < self._capacity:
                begun = self._clock()
                argument = next(source, None)
                self._pass(begun)
                left = argument is not None
                if argument is not None:
                    flying += 1
                    self._hand_out(argument)
            if not left and not counted:
                counted = True
                self._measure()
            if end is not None:
                finished = Finished(
                    end[0], assess(end[1]), None, False, 0.0, "simulated", more=bool(self._done)
                )
                begun = self._clock()
                yield finished
                self._pass(begun)

    def _hand_out(self, argument: tuple[int, Genome]) -> None:
        self._until(self._now)
        if self._free:
            self._begin(argument, self._free.popleft(), self._now)
        else:
            self._waiting.append(argument)

    def _begin(self, argument: tuple[int, Genome], free_since: float, now: float) -> None:
        self._idle += now - free_since
        index, genome = argument
        heapq.heappush(self._working, (now + self._seconds(self._random), index, genome))

    def _until(self, moment: float) -> None:
        """Let everything happen that happens until a moment."""
        self._now = moment
        while self._working and self._working[0][0] <= moment:
            end, index, genome = heapq.heappop(self._working)
            self._done.append((index, genome))
            if self._waiting:
                self._begin(self._waiting.popleft(), end, end)
            else:
                self._free.append(end)

    def _pass(self, begun: float) -> None:
        """Let the time pass that the main process has taken since it began."""
        taken = self._clock() - begun
        self._main += taken
        self._until(self._now + taken)

    def _measure(self) -> None:
        """All of a run is handed out: what workers have waited until now, since the first run."""
        idle = self._idle + sum(self._now - since for since in self._free)
        self.measured = {
            "idle_share": idle / (self._workers * self._now),
            "simulated_seconds": self._now,
            "main_process_share": self._main / self._now,
        }

    def close(self) -> None:
        """Nothing to release."""


def header_of(algorithm: str, population: int, evaluations: int, asynchronous: bool) -> RunHeader:
    """A run over the synthetic problem."""
    search = SearchSettings(
        algorithm=algorithm,
        dimension=DIMENSION,
        objectives=len(NAMES),
        population=population,
        seed=1,
        asynchronous=asynchronous,
    )
    return RunHeader(
        format_version=FORMAT_VERSION,
        problem=ProblemSource(path="synthetic.toml", text="", files={}),
        problem_name="synthetic",
        parameters=PARAMETERS,
        objectives=tuple(Objective(name=name, sense=Sense.MINIMISE, unit="1") for name in NAMES),
        search=search,
        budget=evaluations,
        versions={},
        git=None,
        started="",
    )


def main() -> None:
    """Simulate, print a Markdown table, write the figures."""
    options = _options()
    rows = []
    print("| search | mode | times | prefetch | waiting | main process busy |")
    print("|---|---|---|---|---|---|")
    for algorithm, asynchronous, name, prefetch in CASES:
        pool = SimulatedPool(options.workers, prefetch, TIMES[name], CLOCKS[options.clock])
        header = header_of(algorithm, options.workers, options.evaluations, asynchronous)
        with tempfile.TemporaryDirectory() as folder:
            start(Path(folder) / "run", header, lambda: assess, pool, Silent())
        mode = "asynchronous" if asynchronous else "generations"
        rows.append({"search": algorithm, "mode": mode, "times": name, "prefetch": prefetch, **pool.measured})
        shares = f"{pool.measured['idle_share']:.1%} | {pool.measured['main_process_share']:.0%}"
        print(f"| {algorithm} | {mode} | {name} | {prefetch} | {shares} |", flush=True)
    figures = {"workers": options.workers, "evaluations": options.evaluations, "cases": rows}
    RESULTS.write_bytes(msgspec.json.format(msgspec.json.encode(figures), indent=2) + b"\n")


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--workers", type=int, default=1000)
    parser.add_argument("--evaluations", type=int, default=10000)
    parser.add_argument("--clock", choices=CLOCKS, default="cpu")
    return parser.parse_args()


if __name__ == "__main__":
    main()
