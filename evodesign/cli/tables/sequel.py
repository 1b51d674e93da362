"""A reproduction of the sequel of 2023 as tables."""

from __future__ import annotations

from pathlib import Path

from evodesign.analysis.sequel_claims import FAILED, LOGGED
from evodesign.cli.output import rounded
from evodesign.cli.tables.reproduction import verdict_lines
from evodesign.cli.tables.table import FittedTable, names, numbers, titled
from evodesign.report.sequel import SequelReproduction

__all__ = ["robots_table", "sequel_lines"]


def robots_table(done: SequelReproduction) -> FittedTable:
    """The sequel's robots and ours: fitness there and here, torques, mass, reach."""
    columns = [
        *names("robot"),
        *numbers("logged fitness", "fitness", "cost [N m]", "robot [N m]", "human [N m]", "mass [kg]"),
        *numbers("reach [m]", "cases held"),
    ]
    table = titled("Robots of the sequel and of our search: fitness, mean torque norms", columns)
    for name, robot in done.robots.items():
        values = (
            robot.fitness,
            robot.cost,
            robot.robot_torque,
            robot.human_torque,
            robot.mass,
            robot.highest,
        )
        logged = "failed" if name in FAILED else rounded(LOGGED[name]) if name in LOGGED else "-"
        table.add_row(
            name,
            logged,
            *("-" if value is None else rounded(value) for value in values),
            f"{robot.held} of {robot.cases}",
        )
    return table


def sequel_lines(done: SequelReproduction, directory: Path, seconds: float) -> list[str]:
    """A sentence for every verdict, then what was computed and where it lies."""
    return [
        *verdict_lines(done.claims),
        f"search is design {done.chosen} of {done.run.directory}"
        if done.chosen is not None
        else f"no design of {done.run.directory} is feasible",
        f"robots lie in {directory}; {seconds / 60.0:.1f} min",
    ]
