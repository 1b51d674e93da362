"""Evaluations that go wrong on purpose, in a module that workers import in no time."""

from __future__ import annotations

import math
import os
import signal
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from evodesign.pool.base import Limits
from evodesign.records import Assessed, Assessment, Genome, Parameter, Status, design_of

KILLS, HANGS, NOT_A_NUMBER = range(3)


def fault(genome: Genome) -> int:
    """Which tenth of the designs a genome is in."""
    return int(genome[0] * 1e6) % 10


def results(parameters: tuple[Parameter, ...], genome: Genome) -> Assessment:
    """Of two objectives, both smooth; every design is feasible."""
    torque = 30.0 + sum((coordinate - 0.3) ** 2 for coordinate in genome)
    return Assessment(
        design=design_of(parameters, genome),
        objectives={"robot_torque": torque, "reach_height": 1.0 + genome[0] - genome[1] ** 2},
        violation=0.0,
        status=Status.SOLVED,
        reason="solved",
    )


@dataclass(frozen=True)
class Faulty:
    """A task of which three tenths of the designs go wrong; every call adds a line to the file."""

    parameters: tuple[Parameter, ...]
    calls: str
    limits: Limits

    def __call__(self) -> Callable[[Genome], Assessed]:
        return self.assess

    def assess(self, genome: Genome) -> Assessed:
        with Path(self.calls).open("a") as file:
            file.write(f"{genome}\n")
        good = results(self.parameters, genome)
        match fault(genome):
            case 0:
                os.kill(os.getpid(), signal.SIGKILL)
            case 1:
                time.sleep(3600.0)
            case 2:
                good.objectives["robot_torque"] = math.nan
        return Assessed(assessment=good)


@dataclass(frozen=True)
class Slow:
    """A task that takes its time [s], sometimes eight times as long."""

    parameters: tuple[Parameter, ...]
    seconds: float

    def __call__(self) -> Callable[[Genome], Assessed]:
        return self.assess

    def assess(self, genome: Genome) -> Assessed:
        time.sleep(self.seconds * (8 if fault(genome) == 0 else 1))
        return Assessed(assessment=results(self.parameters, genome))
