"""Worker processes of one machine, working side by side.

Some arguments are prefetched: a worker that is done takes the next one at once, without waiting until the
caller has dealt with what is done (it may be writing to disk, or computing).
"""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Iterable
from concurrent.futures import Future
from typing import Generic

from evodesign.pool.base import A, Finished, R
from evodesign.pool.worker_process import WorkerProcess

LOOK_EVERY = 0.2
"""Interval [s] at which limits are looked at: a new worker's begins when its task is built."""


class WorkerGroup(Generic[A, R]):
    """Worker processes that are free, those at work, and prefetched arguments.

    Args:
        processes: of one factory, all free.
        prefetch: arguments that may wait beside those at work.
    """

    def __init__(self, processes: Iterable[WorkerProcess[A, R]], prefetch: int = 0) -> None:
        self._free = list(processes)
        self._capacity = len(self._free) + prefetch
        self._busy: dict[Future[Finished[R]], tuple[int, WorkerProcess[A, R]]] = {}
        self._waiting: deque[tuple[int, A]] = deque()
        self._done: deque[Future[Finished[R]]] = deque()
        self._news = threading.Lock()  # taken until there is news
        self._passed_on: set[Future[Finished[R]]] = set()
        self._lock = threading.RLock()
        self._ended = False

    def free(self) -> int:
        """Places for arguments, prefetched ones included."""
        with self._lock:
            return self._capacity - len(self._busy) - len(self._waiting)

    def begin(self, index: int, argument: A) -> None:
        """Give an argument to a free process, or let it wait for one."""
        with self._lock:
            self._waiting.append((index, argument))
            if self._free:
                self._start(self._free.pop())

    def more(self) -> bool:
        """Whether another process is done."""
        with self._lock:
            return any(future in self._busy for future in self._done)

    def next_end(self) -> Finished[R]:
        """The first end to come, or the first that is too late.

        It waits for news, not for the futures: those are waited for with their locks taken, and an interrupt
        at that moment would leave a lock behind that nobody gives back.
        """
        while True:
            future = self._over()
            if future is not None:
                return self._end(future)
            with self._lock:
                earliest = min(process.due for _, process in self._busy.values())
            self._news.acquire(timeout=min(LOOK_EVERY, max(0.0, earliest - time.perf_counter())))

    def end_work(self) -> None:
        """End what is still at work."""
        with self._lock:
            self._ended = True
            self._waiting.clear()
            processes = [process for _, process in self._busy.values()]
        for process in processes:
            process.close()

    def _over(self) -> Future[Finished[R]] | None:
        """A future that is done, or else one that is too late; None while there is neither."""
        with self._lock:
            while self._done:
                future = self._done.popleft()
                if future in self._busy:
                    return future
            now = time.perf_counter()
            return next((future for future, (_, process) in self._busy.items() if process.due <= now), None)

    def _start(self, process: WorkerProcess[A, R]) -> None:
        """Give a process what has waited longest. The lock is held."""
        index, argument = self._waiting.popleft()
        future = process.begin(index, argument)
        self._busy[future] = index, process
        future.add_done_callback(self._pass_on)

    def _pass_on(self, future: Future[Finished[R]]) -> None:
        """Give the process of a done future its next argument and report it, in the executor's thread.

        A worker that has lost its process, or whose end was taken already, is left to the caller's thread.
        """
        well = future.exception() is None
        with self._lock:
            if well and self._waiting and not self._ended and future in self._busy:
                self._passed_on.add(future)
                self._start(self._busy[future][1])
            self._done.append(future)
            if self._news.locked():
                self._news.release()

    def _end(self, future: Future[Finished[R]]) -> Finished[R]:
        with self._lock:
            index, process = self._busy.pop(future)
            passed_on = future in self._passed_on
            self._passed_on.discard(future)
        end = future.result() if passed_on else process.end(index, future)
        if not passed_on:
            with self._lock:
                if self._waiting:
                    self._start(process)
                else:
                    self._free.append(process)
        return end
