"""What the commands that search share: their display, and the end of a session."""

from __future__ import annotations

from evodesign.analysis.active_limits import frequent_limits
from evodesign.analysis.growth import growth
from evodesign.analysis.run_state import exhausted
from evodesign.cli.front import print_front
from evodesign.cli.output import console, print_commands, print_lines, printable, show_notes
from evodesign.cli.progress import precompute_progress, search_progress
from evodesign.cli.tables.result import chosen_designs, next_commands, result_lines, result_table
from evodesign.runlog.run import RunLog
from evodesign.session import Display

DISPLAY = Display(lambda note: show_notes([note]), precompute_progress, search_progress)
"""Shows a session on standard error."""


def show_result(run: RunLog, *, json: bool) -> None:
    """A few designs of the front, why the search ended if not for its budget, and what to do next."""
    show_notes(run.faults)
    known = growth(run.generations)
    if len(run.evaluations) < run.header.budget:
        show_notes([f"ended after {len(run.evaluations)} of {run.header.budget} evaluations: {_why(run)}"])
    if known is not None:
        show_notes([known.sentence])
    show_notes(printable(each.sentence) for each in frequent_limits(run))
    if json:
        print_front(run, json=True)
        return
    chosen = chosen_designs(run.header.objectives, run.evaluations)
    if chosen:
        console().print(result_table(run, chosen))
    print_lines(*map(printable, result_lines(run, chosen)), "go on with:")
    print_commands(*next_commands(run, chosen))


def _why(run: RunLog) -> str:
    """Why a search ended before its budget was used up, and how to go on."""
    least, more = run.header.least_growth, f"to go on all the same: evodesign resume {run.directory}"
    if exhausted([(each.evaluations, each.hypervolume) for each in run.generations], least):
        return (
            f"doubling the budget is unlikely to add {least:g} % of hypervolume; {more} "
            "--least-growth-percent 0"
        )
    generations = run.header.stagnation_generations
    return f"the hypervolume stood still for {generations} generations; {more} --stagnation-generations 0"
