"""The reproductions of the three papers as tables."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from evodesign.analysis.failures import causes
from evodesign.cli.output import rounded
from evodesign.cli.tables.table import FittedTable, names, numbers, titled
from evodesign.reproduction.claims2022 import PAPER_OPTIMISED, Claim, TorqueNormsByHeight
from evodesign.reproduction.claims2023 import FAILED, LOGGED
from evodesign.reproduction.codesign2023 import SequelReproduction
from evodesign.reproduction.ergonomic2025 import ErgonomicReproduction
from evodesign.reproduction.files2022 import Reproduction

AGENTS = ("human", "robot")
"""Whose torque norms tables show."""


def torque_table(done: Reproduction) -> FittedTable:
    """Table II of the paper with ours beside it, row under row."""
    return height_table("Table II: torque norm [N m] by height of the load", "model", done.by_setting, AGENTS)


def stricter_table(done: Reproduction) -> FittedTable:
    """What the direction of grasps and bodies that keep clear of each other change."""
    title = "Grips and collisions: torque norm [N m] by height of the load"
    return height_table(title, "robot", done.by_limits, AGENTS)


def height_table(
    title: str,
    of: str,
    by_setting: Mapping[str, Mapping[str, TorqueNormsByHeight]],
    figures: Sequence[str],
    setting: str = "setting",
) -> FittedTable:
    """Figures by height of the load, one row for each model, figure and setting.

    Args:
        title: over the table.
        of: what the models are.
        by_setting: by model and setting.
        figures: of `TorqueNorms`.
        setting: what the settings are.
    """
    heights = list(PAPER_OPTIMISED)
    columns = [*names(of, "agent", setting), *numbers(*(f"{height:g} m" for height in heights))]
    table = titled(title, columns, keys=3)
    for model, rows in by_setting.items():
        for figure in figures:
            for number, (setting, torque_norms) in enumerate(rows.items()):
                values = [getattr(torque_norms.get(h), figure, None) for h in heights]
                first = (model, figure) if number == 0 else ("", "")
                table.add_row(*first, setting, *values, end_section=number == len(rows) - 1)
    return table


def claims_table(claims: Iterable[Claim]) -> FittedTable:
    """Every claim with its verdict."""
    rows = ((each.subject, each.by, each.paper, each.found, _verdict(each)) for each in claims)
    return titled("Claims", names("claim", "by", "paper", "here", "verdict"), rows)


def verdict_lines(claims: Iterable[Claim]) -> list[str]:
    """A sentence for every verdict."""
    return [f"{claim.subject}, {claim.by}: {_verdict(claim)}; {claim.reason}" for claim in claims]


def reproduction_lines(done: Reproduction, directory: Path, seconds: float) -> list[str]:
    """A sentence for every verdict, then what was computed and where it lies."""
    published = done.published
    return [
        *verdict_lines(done.claims),
        f"published setting: starts {causes(published.statuses)}; largest difference of a torque from the "
        f"paper's formula {published.difference:.1e} N m",
        f"the original robot holds loads up to {rounded(done.highest)} m",
        *(
            f"{one.robot.name}: least cost {rounded(one.cost)}; {len(one.run.evaluations)} evaluations, "
            f"{causes(one.statuses)}; the run lies in {one.run.directory}"
            for one in done.found
        ),
        f"figures and robots lie in {directory}; {seconds / 60.0:.1f} min",
    ]


def _verdict(claim: Claim) -> str:
    return "reproduced" if claim.reproduced else "not reproduced"


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
    rows = (
        (name, robot.highest, robot.cost, *(done.designs[name][each] for each in lengths))
        for name, robot in done.robots.items()
    )
    return titled("Robots of 2025 and of our searches: reach, cost and length multipliers", columns, rows)


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
