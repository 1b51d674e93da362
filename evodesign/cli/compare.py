"""`compare`: several runs side by side."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from evodesign.cli.options import Damaged, Json, end_damaged
from evodesign.errors import InputError


def compare(
    runs: Annotated[list[Path], typer.Argument(metavar="RUN RUN...", help="Directories of runs.")],
    json: Json = False,
    plot: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Also write a figure of the comparison (HTML).")
    ] = None,
    damaged: Damaged = False,
) -> None:
    """Several runs side by side: hypervolumes, rank tests over seeds, the best designs of all."""
    from evodesign.analysis import comparison
    from evodesign.analysis.comparison_json import comparison_json
    from evodesign.cli.output import console, print_json, print_lines, printable, show_notes, write_text
    from evodesign.cli.tables.comparison import comparison_tables, lines_after, lines_before
    from evodesign.runlog.run import read_run

    if len(runs) < 2:
        raise InputError("RUN", "", "two runs or more", f"{len(runs)}")
    for place, directory in enumerate(runs):
        if directory.resolve() in [other.resolve() for other in runs[:place]]:
            raise InputError("RUN", "", "each run once", f"'{directory}' twice")
    opened = [read_run(directory) for directory in runs]
    for run in opened:
        show_notes(f"{run.directory}: {note}" for note in run.notes)
    comparisons = comparison.compare(opened)
    if plot is not None:
        from evodesign.report.comparison_figure import comparison_html  # plotly takes its time to load

        write_text(plot, comparison_html(comparisons), "--plot")
    if json:
        print_json({"comparisons": [comparison_json(each) for each in comparisons]})
    for each in () if json else comparisons:
        print_lines(*map(printable, lines_before(each, alone=len(comparisons) == 1)))
        for table in comparison_tables(each):
            console().print(table)
        print_lines(*map(printable, lines_after(each)))
    end_damaged(*opened, accepted=damaged)
