"""The searches by name; a new one is a file and a line here, and enters the conformance tests by itself."""

from __future__ import annotations

from collections.abc import Callable, Collection

from evodesign.errors import InputError, nearest_name
from evodesign.records import SearchSettings
from evodesign.search.base import JOINT_STARTS, Search
from evodesign.search.branched import Branched
from evodesign.search.cma_es import CmaEs
from evodesign.search.nsga2 import Nsga2
from evodesign.search.quasi_random import QuasiRandom
from evodesign.search.steady import SteadySearch
from evodesign.search.steady_cma_es import SteadyCmaEs
from evodesign.search.steady_nsga2 import SteadyNsga2
from evodesign.search.steady_random import SteadyRandom

__all__ = ["SEARCHES", "STEADY_SEARCHES", "make_search", "make_steady_search"]

SEARCHES: dict[str, Callable[[SearchSettings], Search]] = {
    "cma-es": CmaEs,
    JOINT_STARTS: QuasiRandom,
    "nsga2": Nsga2,
    "random": QuasiRandom,
}

STEADY_SEARCHES: dict[str, Callable[[SearchSettings], SteadySearch]] = {
    "cma-es": SteadyCmaEs,
    "nsga2": SteadyNsga2,
    "random": SteadyRandom,
}
"""The same without generations."""


def make_search(settings: SearchSettings) -> Search:
    """The search that the settings describe, ready to ask.

    Raises:
        InputError: an unknown algorithm, or settings that no search can use.
    """
    _check(settings, SEARCHES)
    if settings.past:
        return Branched(settings, make_search)
    return SEARCHES[settings.algorithm](settings)


def make_steady_search(settings: SearchSettings) -> SteadySearch:
    """The asynchronous search that the settings describe, ready to ask.

    Raises:
        InputError: as in `make_search`.
    """
    _check(settings, STEADY_SEARCHES)
    return STEADY_SEARCHES[settings.algorithm](settings)


def _check(settings: SearchSettings, searches: Collection[str]) -> None:
    if settings.algorithm not in searches:
        hint = nearest_name(settings.algorithm, searches)
        wanted = f"one of {', '.join(searches)}"
        raise InputError("search", "algorithm", wanted, f"'{settings.algorithm}'{hint}")
    for key, least in (("dimension", 1), ("objectives", 1), ("population", 1), ("seed", 0)):
        value = getattr(settings, key)
        if value < least:
            raise InputError("search", key, f"at least {least}", str(value))
    for index, genome in enumerate(settings.start):
        if len(genome) != settings.dimension:
            wanted = f"{settings.dimension} coordinates"
            raise InputError("search", f"start[{index}]", wanted, str(len(genome)))
        for coordinate in genome:
            if not 0.0 <= coordinate <= 1.0:
                raise InputError("search", f"start[{index}]", "coordinates in [0, 1]", str(coordinate))
