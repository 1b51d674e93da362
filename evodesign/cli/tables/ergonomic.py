"""The reproduction of 2025 as tables."""

from __future__ import annotations

from pathlib import Path

from evodesign.cli.tables.reproduction import AGENTS, height_table, verdict_lines
from evodesign.cli.tables.table import FittedTable, names, numbers, titled
from evodesign.reproduction.files2025 import ErgonomicReproduction


def height_figures(done: ErgonomicReproduction) -> FittedTable:
    """Torques of robot and person and the compression of L5/S1, by robot, person and height."""
    title = "Robots of 2025: torque norms [N m] and back, the compression of L5/S1 [N], by height of the load"
    by_person = {name: robot.by_person for name, robot in done.robots.items()}
    return height_table(title, "robot", by_person, (*AGENTS, "back"), "person")


def robots_of_2025(done: ErgonomicReproduction) -> FittedTable:
    """Reach, cost of 2025 and lengths of each robot."""
    lengths = [name for name in next(iter(done.designs.values())) if name.startswith("length.")]
    columns = [
        *names("robot"),
        *numbers("reach [m]", "cost [(N m)^2]"),
        *numbers(*(name.split(".")[1] for name in lengths)),
    ]
    table = titled("Robots of 2025 and of our searches: reach, cost and length multipliers", columns)
    for name, robot in done.robots.items():
        table.add_row(name, robot.highest, robot.cost, *(done.designs[name][each] for each in lengths))
    return table


def ergonomic_lines(done: ErgonomicReproduction, directory: Path, seconds: float) -> list[str]:
    """A sentence for every verdict, then what was computed and where it lies."""
    return [
        *verdict_lines(done.claims),
        *(
            f"{name} is design {number} of {len(done.runs[name].evaluations)} of {done.runs[name].directory}"
            if number is not None
            else f"no design of {done.runs[name].directory} is feasible"
            for name, number in done.chosen.items()
        ),
        f"table, figures and robots lie in {directory}; {seconds / 60.0:.1f} min",
    ]
