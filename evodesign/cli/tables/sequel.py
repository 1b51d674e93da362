"""A reproduction of the sequel of 2023 as tables."""

from __future__ import annotations

from pathlib import Path

from evodesign.cli.output import rounded
from evodesign.cli.tables.reproduction import verdict_lines
from evodesign.cli.tables.table import FittedTable, names, numbers, titled
from evodesign.reproduction.claims2023 import FAILED, LOGGED
from evodesign.reproduction.files2023 import SequelReproduction


def robots_table(done: SequelReproduction) -> FittedTable:
    """The sequel's robots and ours: fitness there and here, torques, mass, reach.

    The columns with a plus are those with grips and collisions.
    """
    columns = [
        *names("robot"),
        *numbers("logged fitness", "fitness", "cost [N m]", "robot [N m]", "human [N m]", "mass [kg]"),
        *numbers("reach [m]", "held", "+cost [N m]", "+robot [N m]", "+held"),
    ]
    title = "Robots of the sequel and of our search, mean torque norms; +: with grips and collisions"
    table = titled(title, columns)
    for name, robot in done.robots.items():
        strict = done.stricter[name]
        logged = "failed" if name in FAILED else rounded(LOGGED[name]) if name in LOGGED else "-"
        table.add_row(
            name,
            logged,
            *(robot.fitness, robot.cost, robot.robot_torque, robot.human_torque, robot.mass, robot.highest),
            *(robot.held, strict.cost, strict.robot_torque, strict.held),
        )
    return table


def built_lines(done: SequelReproduction) -> list[str]:
    """A sentence on the robots that cannot be built as bodies that keep clear of each other."""
    apart = {name: robot.bodies_apart for name, robot in done.stricter.items()}
    inside = [f"{name} {rounded(-1e3 * by)}" for name, by in apart.items() if by is not None and by < 0.0]
    if not inside:
        return []
    return [
        f"cannot be built: bodies nearer than asked while all joints are at zero [mm]: {', '.join(inside)}"
    ]


def sequel_lines(done: SequelReproduction, directory: Path, seconds: float) -> list[str]:
    """A sentence for every verdict, then what was computed and where it lies."""
    return [
        *built_lines(done),
        *verdict_lines(done.claims),
        f"search is design {done.chosen} of {done.run.directory}"
        if done.chosen is not None
        else f"no design of {done.run.directory} is feasible",
        f"robots lie in {directory}; {seconds / 60.0:.1f} min",
    ]
