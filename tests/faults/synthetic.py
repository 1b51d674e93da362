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


@dataclass(frozen=True)
class Size:
    """Of a synthetic run: evaluations, seconds of each, jobs; and how it is searched and evaluated."""

    budget: int
    seconds: float
    jobs: int
    pool: str = "joblib"
    algorithm: str = "nsga2"
    asynchronous: bool = False

    def header(self, seed: int) -> RunHeader:
        return synthetic_header(self.budget, seed, self.algorithm, asynchronous=self.asynchronous)


def synthetic_header(
    budget: int, seed: int, algorithm: str = "nsga2", population: int = 16, asynchronous: bool = False
) -> RunHeader:
    header = toy_header(population=population, budget=budget, seed=seed, dimension=4)
    search = msgspec.structs.replace(header.search, algorithm=algorithm, asynchronous=asynchronous)
    return msgspec.structs.replace(header, search=search)
