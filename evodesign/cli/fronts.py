"""`front`: the designs that no other design beats in every objective."""

from __future__ import annotations

from pathlib import Path

from evodesign.analysis.failures import causes, failures
from evodesign.analysis.front import front
from evodesign.cli.output import console, print_json, show_notes
from evodesign.cli.tables import front_json, front_table
from evodesign.errors import InputError
from evodesign.runlog.run import Run, read_run

__all__ = ["show", "show_run"]


def show(directory: Path, json: bool, plot: Path | None) -> None:
    """Print the front of a run, with a note on anything its log lacks; write its figure if asked."""
    run = read_run(directory)
    show_notes(run.notes)
    if plot is not None:
        from evodesign.report.front_figure import front_html  # plotly takes its time to load

        _write(plot, front_html(run.header, run.evaluations))
    show_run(run, json)


def show_run(run: Run, json: bool) -> None:
    """Print the front of a run that was read."""
    designs = front(run.header.objectives, run.evaluations)
    if json:
        print_json(front_json(run, designs))
        return
    out = console()
    out.print(front_table(run, designs))
    feasible = sum(evaluation.feasible for evaluation in run.evaluations)
    summary = f"{len(run.evaluations)} evaluations, {feasible} feasible, {len(designs)} on the front"
    if counts := failures(run.evaluations):
        summary += f", failed: {causes(counts)}"
    out.print(f"{summary}; the run lies in {run.directory}", highlight=False, markup=False, soft_wrap=True)


def _write(path: Path, text: str) -> None:
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise InputError(
            "--plot", "", "a file that can be written", f"'{path}' ({error.strerror})"
        ) from error
