"""A reproduction of the paper as tables."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from evodesign.analysis.failures import causes
from evodesign.cli.output import rounded
from evodesign.cli.tables.table import FittedTable, names, numbers, titled
from evodesign.reproduction.claims2022 import PAPER_OPTIMISED, Claim, TorqueNormsByHeight
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
    table = titled("Claims", names("claim", "by", "paper", "here", "verdict"))
    for claim in claims:
        table.add_row(claim.subject, claim.by, claim.paper, claim.found, _verdict(claim))
    return table


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
