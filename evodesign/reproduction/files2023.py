"""What the reproduction of the sequel of 2023 gives, and its files: the robots as URDF."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec

from evodesign.reproduction.claims2022 import Claim
from evodesign.reproduction.claims2023 import LOGGED, RobotFigures, SearchFigures
from evodesign.reproduction.files2022 import write_robot
from evodesign.runlog.run import RunLog
from evodesign.tree.model import Tree


@dataclass(frozen=True, slots=True)
class SequelReproduction:
    """Everything that is shown.

    Args:
        robots: the sequel's, then those of our search, by name.
        stricter: the same with grips and bodies that keep clear of each other.
        trees: of the robots, by name.
        designs: their parameters, by name.
        chosen: number of our search's robot in its run; None where that has no feasible one.
        run: our search.
        search: what it took and found.
        claims: each with its verdict.
    """

    robots: Mapping[str, RobotFigures]
    stricter: Mapping[str, RobotFigures]
    trees: Mapping[str, Tree]
    designs: Mapping[str, Mapping[str, float]]
    chosen: int | None
    run: RunLog
    search: SearchFigures
    claims: tuple[Claim, ...]


def write_sequel(directory: Path, done: SequelReproduction) -> tuple[Path, ...]:
    """Write every robot into an existing directory.

    Raises:
        InputError: a file cannot be written.
    """
    return tuple(write_robot(directory, name, tree) for name, tree in done.trees.items())


def sequel_json(
    done: SequelReproduction, directory: Path, files: Iterable[Path], seconds: float
) -> dict[str, Any]:
    """A reproduction of the sequel as a JSON object; its shape is a promise. [N m], [kg], [m]."""
    return {
        "directory": str(directory),
        "robots": {
            name: {
                **msgspec.to_builtins(robot),
                "fitness": robot.fitness,
                "logged_fitness": LOGGED.get(name),
                "with_grips_and_collisions": msgspec.to_builtins(done.stricter[name]),
                "parameters": dict(done.designs[name]),
            }
            for name, robot in done.robots.items()
        },
        "claims": msgspec.to_builtins(list(done.claims)),
        "search": {
            "run": str(done.run.directory),
            "evaluation": done.chosen,
            **msgspec.to_builtins(done.search),
        },
        "files": [str(path) for path in files],
        "seconds": seconds,
    }
