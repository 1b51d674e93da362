"""A comparison of runs as tables."""

from __future__ import annotations

import statistics
from collections.abc import Iterator

from evodesign.analysis.comparison import Compared, Comparison, best_designs
from evodesign.analysis.comparison_json import hypervolume_summary
from evodesign.cli.output import heading
from evodesign.cli.tables.table import FittedTable, names, numbers, titled


def comparison_tables(comparison: Comparison) -> tuple[FittedTable, ...]:
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


def _searches(comparison: Comparison) -> FittedTable:
    measured = numbers("runs", "hypervolume, median", "least", "greatest", "median share of all")
    table = titled("Searches", [*names("search"), *measured])
    for name, members in comparison.searches.items():
        summary = hypervolume_summary(members) or {}
        shares = [each.share for each in members if each.share is not None]
        table.add_row(
            name,
            len(members),
            *(summary.get(key) for key in ("median", "least", "greatest")),
            f"{statistics.median(shares):.1%}" if shares else "-",
        )
    return table


def _runs(comparison: Comparison) -> FittedTable:
    best = [f"best {heading(objective)}" for objective in comparison.objectives]
    table = titled("Runs", [*names("run", "search"), *numbers("seed", "front", "hypervolume", *best)])
    for each in comparison.runs:
        table.add_row(
            _called(comparison, each),
            each.search,
            each.run.header.search.seed,
            len(each.front),
            each.hypervolume,
            *(each.best.get(objective.name) for objective in comparison.objectives),
        )
    return table


def _called(comparison: Comparison, run: Compared) -> str:
    """A run's directory: its last name, or all of it where runs share that one."""
    directory = run.run.directory
    names = [each.run.directory.name for each in comparison.runs]
    return directory.name if names.count(directory.name) == 1 else f"{directory}"


def _tests(comparison: Comparison) -> FittedTable:
    columns = [*names("between", "test"), *numbers("p", "first better"), *names("finding at 5 %")]
    table = titled("Rank tests of the hypervolumes", columns)
    for test in comparison.tests:
        if test.p is None:
            continue
        table.add_row(
            " / ".join(test.samples),
            test.name,
            test.p,
            "-" if test.effect is None else f"{test.effect:.0%}",
            test.finding,
        )
    return table


def _best(comparison: Comparison) -> FittedTable:
    columns = [*names("", "run"), *numbers("design", *map(heading, comparison.objectives))]
    table = titled("Best designs of all runs", columns, keys=3)
    for each in best_designs(comparison):
        values = each.evaluation.assessment.objectives
        table.add_row(
            each.reason,
            _called(comparison, each.run),
            each.evaluation.number,
            *(values[objective.name] for objective in comparison.objectives),
        )
    return table
