"""`compare`: several runs side by side."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from evodesign.analysis.comparison import Comparison, compare
from evodesign.analysis.comparison_json import comparison_json
from evodesign.cli.output import console, print_json, show_notes, visible
from evodesign.cli.tables.comparison import comparison_tables, untested
from evodesign.errors import InputError
from evodesign.runlog.run import read_run

__all__ = ["compare_runs"]


def compare_runs(directories: Sequence[Path], json: bool, plot: Path | None) -> None:
    """Print how runs compare, and write their figure if asked."""
    if len(directories) < 2:
        raise InputError("RUN", "", "two runs or more", f"{len(directories)}")
    for place, directory in enumerate(directories):
        if directory.resolve() in [other.resolve() for other in directories[:place]]:
            raise InputError("RUN", "", "each run once", f"'{directory}' twice")
    runs = [read_run(directory) for directory in directories]
    for run in runs:
        show_notes(f"{run.directory}: {note}" for note in run.notes)
    comparisons = compare(runs)
    if plot is not None:
        from evodesign.report.comparison_figure import comparison_html  # plotly takes its time to load

        try:
            plot.write_text(comparison_html(comparisons), encoding="utf-8")
        except OSError as error:
            found = f"'{plot}' ({error.strerror})"
            raise InputError("--plot", "", "a file that can be written", found) from error
    if json:
        print_json({"comparisons": [comparison_json(each) for each in comparisons]})
        return
    for comparison in comparisons:
        _print(comparison, alone=len(comparisons) == 1)


def _print(comparison: Comparison, *, alone: bool) -> None:
    out = console()

    def say(line: str) -> None:
        out.print(visible(line), highlight=False, markup=False, soft_wrap=True)

    if not alone:
        names = ", ".join(objective.name for objective in comparison.objectives)
        say(f"runs with the objectives {names}; others cannot be compared with them")
    for note in comparison.notes:
        say(note)
    for table in comparison_tables(comparison):
        out.print(table)
    for reason in untested(comparison):
        say(reason)
    if comparison.reference is None:
        say("no run has a feasible design, so there is nothing to measure")
        return
    corner = ", ".join(f"{name} {value:.4g}" for name, value in comparison.reference.items())
    say(f"hypervolumes after {comparison.evaluations} evaluations, against {corner}")
