"""The searches by name; a new one is a file and a line here, and enters the conformance tests by itself.

A line says in which module the class stands: a library is loaded when its search is asked for (pycma alone
takes a second). A search outside of the package needs no line: its name is its place, such as `module:Class`
(see `outside`).
"""

from __future__ import annotations

import pkgutil
from collections.abc import Collection, Mapping
from typing import Any, Final

from evodesign.errors import InputError, nearest_name
from evodesign.outside import imported, is_outside
from evodesign.records import SearchSettings, choice_at, middle_of
from evodesign.searches.base import JOINT_STARTS, AsynchronousSearch, Search
from evodesign.searches.restarted import Restarted

SEARCHES: Final[Mapping[str, str]] = {
    "cma-es": "evodesign.searches.cma_es:CmaEs",
    JOINT_STARTS: "evodesign.searches.quasi_random:QuasiRandom",
    "map-elites": "evodesign.searches.map_elites:MapElites",
    "nsga2": "evodesign.searches.nsga2:Nsga2",
    "random": "evodesign.searches.quasi_random:QuasiRandom",
    "surrogate": "evodesign.searches.surrogate.search:Surrogate",
}

ASYNCHRONOUS_SEARCHES: Final[Mapping[str, str]] = {
    "cma-es": "evodesign.searches.cma_es:AsynchronousCmaEs",
    "map-elites": "evodesign.searches.map_elites:AsynchronousMapElites",
    "nsga2": "evodesign.searches.nsga2:AsynchronousNsga2",
    "random": "evodesign.searches.quasi_random:AsynchronousRandom",
    "surrogate": "evodesign.searches.surrogate.search:AsynchronousSurrogate",
}
"""The same without generations."""


def make_search(settings: SearchSettings) -> Search:
    """The search that the settings describe, ready to ask.

    Raises:
        InputError: an unknown algorithm, or settings that no search can use.
    """
    _check(settings, SEARCHES)
    if settings.past:
        return Restarted(settings, make_search)
    made: Search = _class(settings.algorithm, SEARCHES)(settings)
    return made


def make_asynchronous_search(settings: SearchSettings) -> AsynchronousSearch:
    """The asynchronous search that the settings describe, ready to ask.

    Raises:
        InputError: as in `make_search`.
    """
    _check(settings, ASYNCHRONOUS_SEARCHES)
    made: AsynchronousSearch = _class(settings.algorithm, ASYNCHRONOUS_SEARCHES)(settings)
    return made


def _class(algorithm: str, searches: Mapping[str, str]) -> Any:
    """The class of an algorithm: that of a line, or at a place such as `package.module:Class`."""
    if algorithm in searches:
        return pkgutil.resolve_name(searches[algorithm])
    return imported(algorithm, "search", "algorithm")


def _check(settings: SearchSettings, searches: Collection[str]) -> None:
    if settings.algorithm not in searches and not is_outside(settings.algorithm):
        hint = nearest_name(settings.algorithm, searches)
        wanted = f"one of {', '.join(searches)}"
        raise InputError("search", "algorithm", wanted, f"'{settings.algorithm}'{hint}")
    for key, least in (("dimension", 1), ("objectives", 1), ("population", 1), ("seed", 0)):
        value = getattr(settings, key)
        if value < least:
            raise InputError("search", key, f"at least {least}", str(value))
    _check_counts(settings)
    for index, genome in enumerate(settings.start):
        if len(genome) != settings.dimension:
            wanted = f"{settings.dimension} coordinates"
            raise InputError("search", f"start[{index}]", wanted, str(len(genome)))
        for coordinate, count in zip(genome, settings.counts, strict=True):
            if not 0.0 <= coordinate <= 1.0:
                raise InputError("search", f"start[{index}]", "coordinates in [0, 1]", str(coordinate))
            if count and coordinate != middle_of(choice_at(coordinate, count), count):
                wanted = f"the middle of one of {count} parts of [0, 1] in a discrete coordinate"
                raise InputError("search", f"start[{index}]", wanted, str(coordinate))


def _check_counts(settings: SearchSettings) -> None:
    counts = settings.counts
    if len(counts) != settings.dimension:
        found = f"{len(counts)} numbers"
        raise InputError("search", "choices", f"a number for each of {settings.dimension} coordinates", found)
    for index, count in enumerate(counts):
        if count < 0 or count == 1:
            raise InputError("search", f"choices[{index}]", "0, or at least 2", str(count))
