"""A reproduction as tables for people and as JSON for programs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import msgspec
from rich.markup import escape
from rich.table import Table

from evodesign.analysis.paper_claims import PAPER_OPTIMISED, PAPER_ORIGINAL, Claim, TorqueNormsByHeight
from evodesign.cli.output import figure
from evodesign.cli.reproduction import Reproduction
from evodesign.records import Status

__all__ = ["claims_table", "reasons", "reproduction_json", "torque_table"]

PAPER = "paper"


def torque_table(done: Reproduction) -> Table:
    """Table II of the paper with ours beside it, row under row."""
    heights = list(PAPER_OPTIMISED)
    table = Table(title="Table II: torque norm [N m] by height of the load", title_justify="left")
    for column in ("model", "agent", "setting"):
        table.add_column(column)
    for height in heights:
        table.add_column(f"{height:g} m", justify="right")
    for model, rows in _models(done).items():
        for agent in ("human", "robot"):
            for number, (setting, torque_norms) in enumerate(rows.items()):
                values = [
                    figure(getattr(torque_norms[h], agent)) if h in torque_norms else "-" for h in heights
                ]
                first = (model, agent) if number == 0 else ("", "")
                table.add_row(*first, setting, *values, end_section=number == len(rows) - 1)
    return table


def _models(done: Reproduction) -> dict[str, dict[str, TorqueNormsByHeight]]:
    """Torque norms by model and setting."""
    published, limits = done.published, "with limits"
    return {
        "original": {
            PAPER: PAPER_ORIGINAL,
            "published": published.original.torque_norms,
            limits: done.original.torque_norms,
        },
        "optimised": {
            PAPER: PAPER_OPTIMISED,
            "published": published.optimised.torque_norms,
            **{f"{limits}, {one.robot.name}": one.robot.torque_norms for one in done.found},
        },
    }


def claims_table(claims: Iterable[Claim]) -> Table:
    """Every claim with its verdict."""
    table = Table(title="Claims", title_justify="left")
    for column in ("claim", "by", "paper", "here", "verdict"):
        table.add_column(column, overflow="fold")
    for claim in claims:
        shown = (claim.subject, claim.by, claim.paper, claim.found, _verdict(claim))
        table.add_row(*(escape(text) for text in shown))
    return table


def reasons(claims: Iterable[Claim]) -> list[str]:
    """A sentence for every verdict."""
    return [f"{claim.subject}, {claim.by}: {_verdict(claim)}; {claim.reason}" for claim in claims]


def _verdict(claim: Claim) -> str:
    return "reproduced" if claim.reproduced else "not reproduced"


def reproduction_json(
    done: Reproduction, directory: Path, files: Iterable[Path], seconds: float
) -> dict[str, Any]:
    """A reproduction as a JSON object; its shape is a promise. Torque norms [N m], heights [m]."""
    published = done.published
    return {
        "directory": str(directory),
        "torque_norms": {
            model: {setting: _torque_norms(torque_norms) for setting, torque_norms in rows.items()}
            for model, rows in _models(done).items()
        },
        "claims": msgspec.to_builtins(list(done.claims)),
        "published": {
            "torque_difference": published.difference,
            "broken_limits": published.broken,
            "statuses": _statuses(published.statuses),
        },
        "original_highest_m": done.highest,
        "found": {
            one.robot.name: {
                "run": str(one.run.directory),
                "cost": one.cost,
                "parameters": one.design,
                "evaluations": len(one.run.evaluations),
                "statuses": _statuses(one.statuses),
            }
            for one in done.found
        },
        "files": [str(path) for path in files],
        "seconds": seconds,
    }


def _torque_norms(torque_norms: TorqueNormsByHeight) -> list[dict[str, float]]:
    return [
        {"height_m": height, "robot": strain.robot, "human": strain.human}
        for height, strain in torque_norms.items()
    ]


def _statuses(statuses: Counter[Status]) -> dict[str, int]:
    return {str(status): count for status, count in statuses.items()}
