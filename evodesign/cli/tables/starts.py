"""What a problem is solved from, and how well other designs are solved from it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from evodesign.cli.output import rounded
from evodesign.cli.tables.table import FittedTable, names, numbers, titled
from evodesign.posture.precompute.precomputed import Precomputed
from evodesign.posture.seeking.start_portfolio import StartPortfolio
from evodesign.problem.build import DesignProblem
from evodesign.records import Case


def _portfolios(problem: DesignProblem, known: Precomputed) -> Iterator[tuple[str, StartPortfolio, str]]:
    """Each portfolio with what it is for and the unit in which it misses."""
    if not problem.start_portfolio:
        return
    yield "highest load", known.highest, "m"
    yield "lowest load", known.lowest, "m"
    own = {_named(f"posture at {case.task}", case): found for case, found in known.postures.items()}
    lifts = {_named(f"lift from {case.task}", case): found for case, found in known.lifts.items()}
    for name, found in {**own, **lifts}.items():
        yield name, found, "100 N^2 m^2"


def _named(subject: str, case: Case) -> str:
    return ", ".join(part for part in (subject, case.label) if part)


def starts_table(problem: DesignProblem, known: Precomputed) -> FittedTable:
    """Coverage of each portfolio of starts."""
    columns = [*names("problem"), *numbers("starts", "designs tried", "within 1 %", "worst miss")]
    table = titled("start portfolios, and designs that they were not made from", columns)
    for name, found, unit in _portfolios(problem, known):
        coverage = found.coverage
        share = f"{coverage.share:.1%}" if coverage.designs else "-"
        miss = f"{rounded(coverage.worst)} {unit}" if coverage.good < coverage.designs else "none"
        table.add_row(name, len(found.starts), coverage.designs, share, miss)
    return table


def starts_json(problem: DesignProblem, known: Precomputed) -> dict[str, Any]:
    """The same as a JSON object; its shape is a promise."""
    return {
        "problem": problem.name,
        "portfolios": [
            {
                "for": name,
                "starts": len(found.starts),
                "designs_tried": found.coverage.designs,
                "designs_good": found.coverage.good,
                "worst_miss": found.coverage.worst,
                "unit": unit,
            }
            for name, found, unit in _portfolios(problem, known)
        ],
    }
