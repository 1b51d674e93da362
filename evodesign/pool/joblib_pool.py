"""A pool of processes on this machine: joblib over loky.

Workers live on between runs (idle ones end after five minutes) and build their task once; arguments are
handed out one by one. When a worker dies, loky ends all of them and joblib its whole call. The arguments
that joblib had taken and not given back are then suspects: each runs again with nothing beside it, and
one that loses its worker again is lost. The others go on together.
"""

from __future__ import annotations

import re
import tempfile
import time
import warnings
import weakref
from collections.abc import Callable, Generator, Iterator, Sequence
from typing import Any, Generic, TypeVar

from joblib import Parallel, delayed, parallel_config
from joblib.externals.loky import get_reusable_executor
from joblib.externals.loky.process_executor import TerminatedWorkerError

from evodesign.pool.base import Factory, Finished, Pool
from evodesign.pool.worker import explain, finish_here, start_worker

__all__ = ["JoblibPool"]

A = TypeVar("A")
R = TypeVar("R")
Call = tuple[Callable[..., Any], tuple[Any, ...], dict[str, Any]]

FEWEST_PROCESSES = 2
"""joblib runs a single job in the calling process, where a crash would take the search down."""

HANDED_OUT_PER_JOB = 2
"""One argument that runs and one that waits at the worker's door."""

NO_WORKER = "local-lost"
"""Worker name of an argument of which no worker could report."""


class JoblibPool(Pool):
    """Runs in processes, each with one thread for numerical libraries.

    Arguments and results must pickle. loky keeps one set of workers per parent process: of several such
    pools only one may be in a run at a time, and a run with another factory starts new workers.

    Args:
        jobs: arguments that run at the same time, at least 1. One job has two processes taking turns.
    """

    def __init__(self, jobs: int) -> None:
        self._jobs = jobs
        self._started = False
        self._current: weakref.ref[Generator[Any, None, None]] | None = None

    def run(self, factory: Factory[A, R], arguments: Sequence[A]) -> Iterator[Finished[R]]:
        """Every argument's end, in the order in which they come; ends a run that was left unfinished."""
        self._end_run()
        ends = self._ends(factory, arguments)
        self._current = weakref.ref(ends)
        return ends

    def close(self) -> None:
        """End the workers, also those at work."""
        self._end_run()
        if self._started:
            self._started = False
            get_reusable_executor(reuse=True).shutdown(wait=True, kill_workers=True)

    def _end_run(self) -> None:
        unfinished = self._current() if self._current is not None else None
        if unfinished is not None:
            unfinished.close()

    def _ends(self, factory: Factory[A, R], arguments: Sequence[A]) -> Generator[Finished[R], None, None]:
        waiting: Sequence[int] = range(len(arguments))
        while waiting:
            handout = _Handout(arguments, waiting)
            yield from self._together(factory, handout)
            suspects = handout.unanswered
            for index in suspects:
                yield self._alone(factory, arguments, index)
            ended = handout.answered.union(suspects)
            waiting = [index for index in waiting if index not in ended]

    def _together(self, factory: Factory[A, R], handout: _Handout[A]) -> Iterator[Finished[R]]:
        """Ends of the arguments handed out, up to the first that keeps its result back."""
        try:
            yield from self._results(factory, handout, self._jobs)
        except Exception:  # its reason is told by the arguments that are tried alone
            if not handout.unanswered:
                raise

    def _alone(self, factory: Factory[A, R], arguments: Sequence[A], index: int) -> Finished[R]:
        """An argument's end, whatever happens, with nothing else running."""
        start = time.perf_counter()
        try:
            (finished,) = self._results(factory, _Handout(arguments, [index]), jobs=1)
        except Exception as error:  # noqa: BLE001 - whatever keeps the result back is this argument's failure
            lost = isinstance(error, TerminatedWorkerError)
            failure = _death(error) if lost else f"no result came back: {explain(error)}"
            seconds = time.perf_counter() - start
            return Finished(index, None, failure, lost, seconds, NO_WORKER)
        return finished

    def _results(self, factory: Factory[A, R], handout: _Handout[A], jobs: int) -> Iterator[Finished[R]]:
        self._started = True
        with parallel_config("loky", inner_max_num_threads=1, initializer=start_worker, initargs=(factory,)):
            parallel = Parallel(
                n_jobs=max(jobs, FEWEST_PROCESSES),
                return_as="generator_unordered",
                batch_size=1,
                pre_dispatch=1 if jobs == 1 else HANDED_OUT_PER_JOB * jobs,
                max_nbytes=None,
                temp_folder=tempfile.gettempdir(),  # otherwise every call leaves a folder in /dev/shm
            )
        results = parallel(handout.calls())
        try:
            for finished in results:
                handout.answered.add(finished.index)
                yield finished
        finally:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # joblib's remark on a generator that is left early
                results.close()


class _Handout(Generic[A]):
    """What one call of joblib was given, what it took of that, and what came back."""

    def __init__(self, arguments: Sequence[A], waiting: Sequence[int]) -> None:
        self._arguments = arguments
        self._waiting = waiting
        self._taken = 0
        self.answered: set[int] = set()

    def calls(self) -> Iterator[Call]:
        """The calls that joblib takes one by one, from several threads under its lock."""
        for index in self._waiting:
            self._taken += 1
            yield delayed(finish_here)(index, self._arguments[index])

    @property
    def unanswered(self) -> list[int]:
        """Indices that joblib took and has not given back."""
        return [index for index in self._waiting[: self._taken] if index not in self.answered]


def _death(error: TerminatedWorkerError) -> str:
    """A sentence on a worker's death, with the exit code that loky mentions, such as `SIGKILL(-9)`."""
    codes = [int(code) for code in re.findall(r"[A-Z]\((-?\d+)\)", str(error))]
    manners = sorted({f"signal {-code}" if code < 0 else f"exit code {code}" for code in codes})
    manner = ", ".join(manners) or "unknown cause"
    return f"the worker process died ({manner}), also when retried alone"
