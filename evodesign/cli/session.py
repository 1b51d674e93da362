"""What the commands that search share: their display, the end of a session, and how one is stopped.

By Ctrl-C, SIGTERM, or the end of its wall time: the first request lets what is in flight arrive, for half a
minute at most; the next one, or the end of that time, stops at once; a third one does not wait until workers
have ended. Either way everything that had arrived is on the disk, and the run can be resumed.
"""

from __future__ import annotations

import signal
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType

from evodesign.analysis.active_limits import frequent_limits
from evodesign.analysis.growth import growth
from evodesign.analysis.run_state import exhausted
from evodesign.api.stops import SECONDS_PER_HOUR
from evodesign.cli.front import print_front
from evodesign.cli.output import console, print_commands, print_lines, printable, show_notes
from evodesign.cli.progress import precompute_progress, search_progress
from evodesign.cli.tables.result import chosen_designs, next_commands, result_lines, result_table
from evodesign.interrupts import INTERRUPTS
from evodesign.runlog.run import RunLog
from evodesign.session import Display

DISPLAY = Display(lambda note: show_notes([note]), precompute_progress, search_progress)
"""Shows a session on standard error."""


def show_result(run: RunLog, *, json: bool) -> None:
    """A few designs of the front, why the search ended if not for its budget, and what to do next."""
    show_notes(run.faults)
    known = growth(run.generations)
    if len(run.evaluations) < run.header.budget:
        show_notes([f"ended after {len(run.evaluations)} of {run.header.budget} evaluations: {_why(run)}"])
    if known is not None:
        show_notes([known.sentence])
    show_notes(printable(each.sentence) for each in frequent_limits(run))
    if json:
        print_front(run, json=True)
        return
    chosen = chosen_designs(run.header.objectives, run.evaluations)
    if chosen:
        console().print(result_table(run, chosen))
    print_lines(*map(printable, result_lines(run, chosen)), "go on with:")
    print_commands(*next_commands(run, chosen))


def _why(run: RunLog) -> str:
    """Why a search ended before its budget was used up, and how to go on."""
    least, more = run.header.least_growth, f"to go on all the same: evodesign resume {run.directory}"
    if exhausted([(each.evaluations, each.hypervolume) for each in run.generations], least):
        return (
            f"doubling the budget is unlikely to add {least:g} % of hypervolume; {more} "
            "--least-growth-percent 0"
        )
    generations = run.header.stagnation_generations
    return f"the hypervolume stood still for {generations} generations; {more} --stagnation-generations 0"


GRACE_SECONDS = 30.0
"""How long evaluations in flight may take to arrive after a stop was asked for."""


class SignalledStop:
    """Whether a session is to stop; asked by the loop, told by signals.

    Before and after `heeded`, a signal is an interrupt.

    Args:
        hours: wall time of the session from now on; None for no end.
        run: directory of the run.
        grace_seconds: how long what is in flight may take.
    Attributes:
        why: what used up the session, as a clause; empty when a person stopped it.
    """

    def __init__(self, hours: float | None, run: Path, grace_seconds: float = GRACE_SECONDS) -> None:
        INTERRUPTS.check()
        INTERRUPTS.run = run
        self._hours = hours
        self._grace = grace_seconds
        self._end = None if hours is None else time.monotonic() + hours * SECONDS_PER_HOUR
        self._asked = threading.Event()
        self._heeded = False
        self.why = ""
        signal.signal(signal.SIGTERM, self._on_request)
        signal.signal(signal.SIGINT, self._on_request)

    def __call__(self) -> bool:
        """Whether no further evaluation is to begin."""
        return self._asked.is_set() or INTERRUPTS.unwinding

    @contextmanager
    def heeded(self) -> Iterator[None]:
        """Within this, the loop asks; signals do not break in at the first request."""
        previous = signal.signal(signal.SIGALRM, self._on_alarm)
        if self._end is not None:
            signal.setitimer(signal.ITIMER_REAL, max(self._end - time.monotonic(), 1e-3))
        self._heeded = True
        try:
            INTERRUPTS.check()
            yield
        finally:
            self._heeded = False
            signal.setitimer(signal.ITIMER_REAL, 0.0)
            signal.signal(signal.SIGALRM, previous)

    def _on_request(self, signum: int, frame: FrameType | None) -> None:
        if not self._heeded or self._asked.is_set():
            INTERRUPTS.interrupt()
        self._begin("Ctrl-C again stops at once")

    def _on_alarm(self, signum: int, frame: FrameType | None) -> None:
        if self._asked.is_set():
            INTERRUPTS.interrupt()
        self.why = f"its wall time of {self._hours:g} h is over"
        self._begin(self.why)

    def _begin(self, remark: str) -> None:
        self._asked.set()
        signal.setitimer(signal.ITIMER_REAL, self._grace)
        sentence = f"waiting for what is in flight, at most {self._grace:g} s ({remark})"
        # a thread of its own: the signal may have come while the main thread was writing
        threading.Thread(target=show_notes, args=([sentence],), daemon=True).start()
