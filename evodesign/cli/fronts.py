"""`front`: the designs that no other design beats in every objective, all of them or a choice."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from evodesign.analysis.aspiration import aspiration_of
from evodesign.analysis.choice import Choice, Chosen, Order, choose
from evodesign.analysis.conditions import conditions
from evodesign.analysis.failures import causes, failures
from evodesign.analysis.quantities import quantities
from evodesign.cli.output import console, print_json, show_notes, visible
from evodesign.cli.tables.front import front_csv, front_json, front_table
from evodesign.errors import InputError
from evodesign.records import Evaluation
from evodesign.runlog.run import Run, read_run

__all__ = ["Picking", "Printing", "show", "show_run"]

ROWS = 100
"""Most rows of a table that nobody limited."""

FEW = 10
"""How many of the most different designs are shown when nobody says."""


@dataclass(frozen=True, slots=True)
class Picking:
    """The options that choose designs, as they were written."""

    knee: bool = False
    different: bool = False
    near: str | None = None
    where: Sequence[str] = ()
    limit: int | None = None


@dataclass(frozen=True, slots=True)
class Printing:
    """The options that say in which form."""

    json: bool = False
    csv: bool = False
    plot: Path | None = None


def show(directory: Path, picking: Picking, printing: Printing) -> None:
    """Print designs of a run's front, with a note on anything its log lacks; write its figure if asked."""
    if printing.json and printing.csv:
        raise InputError("--csv", "", "one form of output", "--json too")
    _check(picking)
    run = read_run(directory)
    choice = _choice(run, picking)
    show_notes(run.notes)
    if printing.plot is not None:
        from evodesign.report.front_figure import front_html  # plotly takes its time to load

        _write(printing.plot, front_html(run.header, run.evaluations))
    _print(run, choice, printing)


def show_run(run: Run, json: bool) -> None:
    """Print the front of a run that was read."""
    _print(run, Choice(), Printing(json=json))


def _check(picking: Picking) -> None:
    """Refuse options that contradict each other."""
    asked = [
        option
        for option, given in (
            ("--knee", picking.knee),
            ("--different", picking.different),
            ("--near", picking.near is not None),
        )
        if given
    ]
    if len(asked) > 1:
        raise InputError(asked[0], "", "one way to choose", f"{' and '.join(asked[1:])} too")


def _choice(run: Run, picking: Picking) -> Choice:
    known = quantities(run.header, run.evaluations[0] if run.evaluations else None)
    where = [condition for text in picking.where for condition in conditions(text, known, "--where")]
    order, limit = Order.FIRST_OBJECTIVE, picking.limit
    if picking.knee:
        order = Order.KNEE
    elif picking.near is not None:
        order = Order.NEAR
    elif picking.different:
        order, limit = Order.DIFFERENT, FEW if limit is None else limit
    objectives = run.header.objectives
    aspiration = {} if picking.near is None else aspiration_of(objectives, picking.near, "--near")
    return Choice(where=tuple(where), order=order, aspiration=aspiration, limit=limit)


def _print(run: Run, choice: Choice, printing: Printing) -> None:
    chosen = choose(run.header.objectives, run.evaluations, choice)
    if printing.json:
        print_json(front_json(run, choice, chosen))
    elif printing.csv:
        sys.stdout.write(front_csv(run, chosen.designs))
    else:
        _print_table(run, choice, chosen)


def _print_table(run: Run, choice: Choice, chosen: Chosen) -> None:
    out = console()
    shown = chosen.designs if choice.limit is not None else chosen.designs[:ROWS]
    if shown:
        out.print(front_table(run, choice, shown))
    feasible = sum(evaluation.feasible for evaluation in run.evaluations)
    counts = failures(run.evaluations)
    failed = f", failed: {causes(counts)}" if counts else ""
    lines = [
        *_remarks(run, choice, chosen, len(shown)),
        f"{len(run.evaluations)} evaluations, {feasible} feasible, {len(chosen.front)} on the front"
        f"{_such(choice)}{failed}; the run lies in {run.directory}",
    ]
    for line in lines:
        out.print(visible(line), highlight=False, markup=False, soft_wrap=True)


def _remarks(run: Run, choice: Choice, chosen: Chosen, shown: int) -> list[str]:
    """What is not in the table, and why."""
    if chosen.front:
        if shown == chosen.found:
            return []
        more = "" if choice.limit is not None else "; more with --limit, all with --csv or --json"
        kind = "knees" if choice.order is Order.KNEE else "designs"
        return [f"{shown} of {chosen.found} {kind} are shown{more}"]
    if any(evaluation.feasible for evaluation in run.evaluations):
        return [f"no feasible design{_such(choice)}"] if choice.where else []
    nearest = _least_violated(run.evaluations)
    if nearest is None:
        return ["no design was evaluated to an end"] if run.evaluations else ["nothing was evaluated yet"]
    return [
        f"no design is feasible; design {nearest.number} comes nearest: it lacks "
        f"{nearest.assessment.violation:.4g} m ({nearest.assessment.reason})"
    ]


def _such(choice: Choice) -> str:
    return f" with {' and '.join(map(str, choice.where))}" if choice.where else ""


def _least_violated(evaluations: Sequence[Evaluation]) -> Evaluation | None:
    known = [each for each in evaluations if each.assessment.violation is not None]
    return min(known, key=lambda each: each.assessment.violation or 0.0, default=None)


def _write(path: Path, text: str) -> None:
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise InputError(
            "--plot", "", "a file that can be written", f"'{path}' ({error.strerror})"
        ) from error
