"""A Dask scheduler and workers as processes of their own, on loopback."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Self

from distributed import Client

ROOT = Path(__file__).parents[2]

LOOPBACK = ("--host", "127.0.0.1", "--dashboard-address", "127.0.0.1:0", "--no-dashboard")
"""Dask's own server of pages listens on every address unless it is told where, even without the pages."""


class Cluster:
    """Processes that a test starts, kills and starts again; all end with it."""

    def __init__(self) -> None:
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.port = free.getsockname()[1]
        self.address = f"tcp://127.0.0.1:{self.port}"
        self.scheduler: subprocess.Popen[bytes] | None = None
        self.workers: list[subprocess.Popen[bytes]] = []

    def start_scheduler(self) -> None:
        self.scheduler = self._process("dask_scheduler", *LOOPBACK, "--port", str(self.port))

    def add_worker(self, *options: str) -> None:
        command = [self.address, *LOOPBACK, "--nthreads", "1", "--memory-limit", "0", *options]
        self.workers.append(self._process("dask_worker", *command))

    def wait_for(self, workers: int) -> None:
        with Client(self.address, timeout=30.0, set_as_default=False) as client:
            client.wait_for_workers(workers, timeout=60.0)

    def kill_scheduler(self) -> None:
        assert self.scheduler is not None
        _kill(self.scheduler)

    def kill_worker(self) -> None:
        _kill(self.workers.pop(0))

    def _process(self, module: str, *options: str) -> subprocess.Popen[bytes]:
        command = [sys.executable, "-m", f"distributed.cli.{module}", *options]
        environment = {**os.environ, "PYTHONPATH": str(ROOT), "PYTHONWARNINGS": "ignore"}
        return subprocess.Popen(
            command,
            cwd=ROOT,
            env=environment,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, where: TracebackType | None
    ) -> None:
        for process in [*self.workers, *([self.scheduler] if self.scheduler else [])]:
            _kill(process)


def _kill(process: subprocess.Popen[bytes]) -> None:
    """End a process and all of its session, such as a nanny's worker, as a power cut does."""
    with suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()
