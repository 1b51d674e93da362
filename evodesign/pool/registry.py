"""The pools that can be named on the command line."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Final

from evodesign.errors import InputError, nearest_name
from evodesign.pool.base import Pool
from evodesign.pool.joblib_pool import JoblibPool
from evodesign.pool.worker import SerialPool

__all__ = ["POOLS", "make_pool"]


def _dask(jobs: int, scheduler: str | None) -> Pool:
    if scheduler is None:
        wanted = "the address of a running Dask scheduler, such as tcp://127.0.0.1:8786"
        raise InputError("--scheduler", "", wanted, "none")
    try:
        from evodesign.pool.dask_pool import DaskPool
    except ModuleNotFoundError as error:
        wanted = "'joblib', or Dask installed (pip install 'evodesign[dask]')"
        raise InputError("--pool", "", wanted, f"'dask' ({error})") from error
    return DaskPool(scheduler)


POOLS: Final[Mapping[str, Callable[[int, str | None], Pool]]] = {
    "serial": lambda jobs, scheduler: SerialPool(),
    "joblib": lambda jobs, scheduler: JoblibPool(jobs),
    "dask": _dask,
}
"""Constructors by name; each takes the number of jobs and the address of a scheduler, if it has a use for
them: the serial pool has one job, Dask as many as its workers have threads."""


def make_pool(name: str, jobs: int, scheduler: str | None = None) -> Pool:
    """The pool of a name.

    Args:
        name: in the registry.
        jobs: evaluations that run at the same time.
        scheduler: address of a Dask scheduler.
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
    return POOLS[name](jobs, scheduler)
