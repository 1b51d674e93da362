"""What the reproduction of 2025 gives, and its files: a table, the figures of 2022, the robots as URDF."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec

from evodesign.report.csv_text import csv_text
from evodesign.reproduction.claims2022 import Claim
from evodesign.reproduction.claims2025 import ErgonomicRobot
from evodesign.reproduction.files2022 import ReproducedRobot, write_file, write_reproduction
from evodesign.runlog.run import RunLog

TABLE = "robots.csv"
COLUMNS = ("robot", "person", "height_m", "robot_torque_n_m", "human_torque_n_m", "back_compression_n")


@dataclass(frozen=True, slots=True)
class ErgonomicReproduction:
    """Everything that is shown.

    Args:
        robots: the iCub, the published robots, then those of our searches, by name.
        pictured: the same with their postures beside the paper's person.
        designs: their parameters, by name.
        runs: our searches, by the name of their robot.
        chosen: number of that robot in its run; None where that has no feasible one.
        claims: each with its verdict.
    """

    robots: Mapping[str, ErgonomicRobot]
    pictured: tuple[ReproducedRobot, ...]
    designs: Mapping[str, Mapping[str, float]]
    runs: Mapping[str, RunLog]
    chosen: Mapping[str, int | None]
    claims: tuple[Claim, ...]


def write_ergonomic(directory: Path, done: ErgonomicReproduction) -> tuple[Path, ...]:
    """Write table, figures and robots into an existing directory.

    Raises:
        InputError: a file cannot be written.
    """
    rows = [
        (name, person, height, norms.robot, norms.human, norms.back)
        for name, robot in done.robots.items()
        for person, by_height in robot.by_person.items()
        for height, norms in by_height.items()
    ]
    table = write_file(directory / TABLE, csv_text([COLUMNS, *rows]))
    return table, *write_reproduction(directory, done.pictured, ())


def ergonomic_json(
    done: ErgonomicReproduction, directory: Path, files: Iterable[Path], seconds: float
) -> dict[str, Any]:
    """A reproduction of 2025 as a JSON object; its shape is a promise. [N m], [N], [kg], [m]."""
    return {
        "directory": str(directory),
        "robots": {
            name: {
                "mass": robot.mass,
                "highest": robot.highest,
                "cost": robot.cost,
                "by_person": {
                    person: [
                        {"height_m": height, **msgspec.to_builtins(norms)} for height, norms in held.items()
                    ]
                    for person, held in robot.by_person.items()
                },
                "parameters": dict(done.designs[name]),
            }
            for name, robot in done.robots.items()
        },
        "claims": msgspec.to_builtins(list(done.claims)),
        "searches": {
            name: {
                "run": str(run.directory),
                "evaluation": done.chosen[name],
                "evaluations": len(run.evaluations),
                "infeasible": sum(not each.feasible for each in run.evaluations),
            }
            for name, run in done.runs.items()
        },
        "files": [str(path) for path in files],
        "seconds": seconds,
    }
