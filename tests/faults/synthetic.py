"""A synthetic problem for real pools: cheap, deterministic, of any length."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import msgspec

from evodesign.records import Assessed, Genome, RunHeader
from tests.runlog.toys import toy_assessed, toy_header


@dataclass(frozen=True)
class Synthetic:
    """Builds a task that sleeps [s] and then assesses a genome."""

    header: RunHeader
    seconds: float

    def __call__(self) -> Callable[[Genome], Assessed]:
        def task(genome: Genome) -> Assessed:
            if self.seconds > 0.0:
                time.sleep(self.seconds)
            return toy_assessed(genome, self.header)

        return task


def synthetic_header(budget: int, seed: int, algorithm: str = "nsga2", population: int = 16) -> RunHeader:
    header = toy_header(population=population, budget=budget, seed=seed, dimension=4)
    search = msgspec.structs.replace(header.search, algorithm=algorithm)
    return msgspec.structs.replace(header, search=search)
