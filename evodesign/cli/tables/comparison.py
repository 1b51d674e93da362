"""A comparison of runs as tables."""

from __future__ import annotations

import statistics
from collections.abc import Iterator

from rich.table import Table

from evodesign.analysis.comparison import Comparison, best_designs
from evodesign.analysis.comparison_json import hypervolume_summary
from evodesign.cli.output import figure, heading, shown

__all__ = ["comparison_tables", "lines_after", "lines_before"]


def comparison_tables(comparison: Comparison) -> tuple[Table, ...]:
    """Searches, runs, tests and best designs; those that would be empty are left out."""
    tables = [_searches(comparison), _runs(comparison)]
    if any(test.p is not None for test in comparison.tests):
        tables.append(_tests(comparison))
    if any(run.front for run in comparison.runs):
        tables.append(_best(comparison))
    return tuple(tables)


def lines_before(comparison: Comparison, *, alone: bool) -> Iterator[str]:
    """Which runs are compared, unless there is one comparison only, and notes on them."""
    if not alone:
        names = ", ".join(objective.name for objective in comparison.objectives)
        yield f"runs with the objectives {names}; others cannot be compared with them"
    yield from comparison.notes


def lines_after(comparison: Comparison) -> Iterator[str]:
    """Which tests were not made, and why; what hypervolumes are measured against."""
    reasons: dict[str, list[str]] = {}
    for test in comparison.tests:
        if test.p is None:
            reasons.setdefault(test.reason, []).append(" / ".join(test.samples))
    for reason, samples in reasons.items():
        yield f"not tested: {', '.join(samples)}: {reason}"
    if comparison.reference is None:
        yield "no run has a feasible design, so there is nothing to measure"
    else:
        corner = ", ".join(f"{name} {value:.4g}" for name, value in comparison.reference.items())
        yield f"hypervolumes after {comparison.evaluations} evaluations, against {corner}"


def _searches(comparison: Comparison) -> Table:
    table = Table(title="Searches", title_justify="left")
    table.add_column("search", overflow="fold")
    for name in ("runs", "hypervolume, median", "least", "greatest", "median share of all"):
        table.add_column(name, justify="right", overflow="fold")
    for name, members in comparison.searches.items():
        summary = hypervolume_summary(members) or {}
        shares = [each.share for each in members if each.share is not None]
        table.add_row(
            shown(name),
            str(len(members)),
            *(figure(summary.get(key)) for key in ("median", "least", "greatest")),
            f"{statistics.median(shares):.1%}" if shares else "-",
        )
    return table


def _runs(comparison: Comparison) -> Table:
    table = Table(title="Runs", title_justify="left")
    table.add_column("run", overflow="fold")
    table.add_column("search", overflow="fold")
    for name in ("seed", "front", "hypervolume"):
        table.add_column(name, justify="right", overflow="fold")
    for objective in comparison.objectives:
        table.add_column(shown(f"best {heading(objective)}"), justify="right", overflow="fold")
    for each in comparison.runs:
        table.add_row(
            shown(each.run.directory.name),
            shown(each.search),
            str(each.run.header.search.seed),
            str(len(each.front)),
            figure(each.hypervolume),
            *(figure(each.best.get(objective.name)) for objective in comparison.objectives),
        )
    return table


def _tests(comparison: Comparison) -> Table:
    table = Table(title="Rank tests of the hypervolumes", title_justify="left")
    for name in ("between", "test"):
        table.add_column(name, overflow="fold")
    for name in ("p", "first better"):
        table.add_column(name, justify="right", overflow="fold")
    table.add_column("finding at 5 %", overflow="fold")
    for test in comparison.tests:
        if test.p is None:
            continue
        table.add_row(
            shown(" / ".join(test.samples)),
            test.name,
            figure(test.p),
            "-" if test.effect is None else f"{test.effect:.0%}",
            shown(test.finding),
        )
    return table


def _best(comparison: Comparison) -> Table:
    table = Table(title="Best designs of all runs", title_justify="left")
    for name in ("", "run"):
        table.add_column(name, overflow="fold")
    table.add_column("design", justify="right", overflow="fold")
    for objective in comparison.objectives:
        table.add_column(shown(heading(objective)), justify="right", overflow="fold")
    for each in best_designs(comparison):
        values = each.evaluation.assessment.objectives
        table.add_row(
            shown(each.reason),
            shown(each.run.run.directory.name),
            str(each.evaluation.number),
            *(figure(values[objective.name]) for objective in comparison.objectives),
        )
    return table
