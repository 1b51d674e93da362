"""The pools that can be named on the command line."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Final

from evodesign.errors import InputError, nearest_name
from evodesign.pool.base import Pool
from evodesign.pool.joblib_pool import JoblibPool
from evodesign.pool.serial import SerialPool

__all__ = ["POOLS", "make_pool"]

POOLS: Final[Mapping[str, Callable[[int], Pool]]] = {
    "serial": lambda jobs: SerialPool(),
    "joblib": JoblibPool,
}
"""Constructors by name; each takes the number of jobs (the serial pool has one, whatever is asked)."""


def make_pool(name: str, jobs: int) -> Pool:
    """The pool of a name with a number of jobs.

    Raises:
        InputError: no such pool, or fewer than one job.
    """
    if name not in POOLS:
        wanted = f"one of {', '.join(sorted(POOLS))}"
        raise InputError("--pool", "", wanted, f"'{name}'{nearest_name(name, POOLS)}")
    if jobs < 1:
        raise InputError("--jobs", "", "a whole number from 1", str(jobs))
    return POOLS[name](jobs)
