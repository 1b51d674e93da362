"""The pools that can be named on the command line."""

from __future__ import annotations

import multiprocessing
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Final

from evodesign.errors import InputError, nearest_name
from evodesign.pool.base import Pool
from evodesign.pool.worker import SerialPool


def never() -> bool:
    """A stop that is never asked for."""
    return False


@dataclass(frozen=True, slots=True)
class PoolSettings:
    """What a pool is made from, as far as it has a use for it.

    Args:
        jobs: arguments that run at the same time; Dask has as many as its workers have threads.
        scheduler: address of a Dask scheduler.
        note: is told in a sentence when another pool takes the place of this one, or a machine is lost.
        stop: whether waiting for a machine that was lost is to end.
    """

    jobs: int
    scheduler: str | None
    note: Callable[[str], None]
    stop: Callable[[], bool]


def _joblib(settings: PoolSettings) -> Pool:
    if lacking := _no_semaphores():
        settings.note(
            f"no worker processes ({lacking}): evaluations run one after the other, as with --pool serial"
        )
        return SerialPool()
    from evodesign.pool.joblib_pool import JoblibPool  # joblib warns of the same when it is loaded

    return JoblibPool(settings.jobs)


def _no_semaphores() -> str:
    """Why processes can share no semaphores, without which joblib starts none; empty where they can."""
    try:
        multiprocessing.get_context("fork").Semaphore()
    except OSError as error:
        return f"semaphores in /dev/shm: {error.strerror}"
    except ImportError as error:
        return f"{error}"
    return ""


def _dask(settings: PoolSettings) -> Pool:
    if settings.scheduler is None:
        wanted = "the address of a running Dask scheduler, such as tcp://127.0.0.1:8786"
        raise InputError("--scheduler", "", wanted, "none")
    try:
        from evodesign.pool.dask_pool import DaskPool
    except ModuleNotFoundError as error:
        wanted = "'joblib', or Dask installed (pip install 'evodesign[dask]')"
        raise InputError("--pool", "", wanted, f"'dask' ({error})") from error
    return DaskPool(settings.scheduler, settings.note, settings.stop)


POOLS: Final[Mapping[str, Callable[[PoolSettings], Pool]]] = {
    "serial": lambda settings: SerialPool(),
    "joblib": _joblib,
    "dask": _dask,
}
"""Constructors by name."""


def make_pool(
    name: str,
    jobs: int,
    scheduler: str | None = None,
    *,
    note: Callable[[str], None] = warnings.warn,
    stop: Callable[[], bool] = never,
) -> Pool:
    """The pool of a name; in the place of joblib's the serial one where no worker process can be started.

    Args:
        name: in the registry.
        jobs: as in `PoolSettings`.
        scheduler: as in `PoolSettings`.
        note: as in `PoolSettings`.
        stop: as in `PoolSettings`.
    Raises:
        InputError: no such pool, fewer than one job, or a scheduler that is missing, not asked for or silent.
    """
    if name not in POOLS:
        wanted = f"one of {', '.join(sorted(POOLS))}"
        raise InputError("--pool", "", wanted, f"'{name}'{nearest_name(name, POOLS)}")
    if jobs < 1:
        raise InputError("--jobs", "", "a whole number from 1", str(jobs))
    if scheduler is not None and name != "dask":
        raise InputError("--scheduler", "", "no address without --pool dask", f"'{scheduler}'")
    return POOLS[name](PoolSettings(jobs, scheduler, note, stop))
