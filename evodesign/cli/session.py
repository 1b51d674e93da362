"""What the commands that search share: their display, and the end of a session."""

from __future__ import annotations

from evodesign.cli.front import print_front
from evodesign.cli.output import show_notes
from evodesign.cli.progress import precompute_progress, search_progress
from evodesign.runlog.run import RunLog
from evodesign.session import Display

__all__ = ["DISPLAY", "show_result"]

DISPLAY = Display(lambda note: show_notes([note]), precompute_progress, search_progress)
"""Shows a session on standard error."""


def show_result(run: RunLog, *, json: bool) -> None:
    """The front, and why the search ended if it was not for its budget of evaluations."""
    if len(run.evaluations) < run.header.budget:
        show_notes(
            [
                f"ended after {len(run.evaluations)} of {run.header.budget} evaluations: the hypervolume "
                f"stood still for {run.header.stagnation_generations} generations; to go on all the same: "
                f"evodesign resume {run.directory} --stagnation-generations 0"
            ]
        )
    print_front(run, json=json)
