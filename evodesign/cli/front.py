"""`front`: the designs that no other design beats in every objective, all of them or a choice."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from evodesign.cli.options import Damaged, Json, RunPath, end_damaged
from evodesign.errors import InputError

if TYPE_CHECKING:
    from evodesign.analysis.choice import Choice
    from evodesign.runlog.run import RunLog

ROWS = 100
"""Most rows of a table that nobody limited."""

FEW = 10
"""How many of the most different designs are shown when nobody says."""


def front(
    run: RunPath,
    knee: Annotated[
        bool, typer.Option("--knee", help="Only where every exchange near by loses more than it gains.")
    ] = False,
    near: Annotated[
        str | None,
        typer.Option(metavar="NAME=NUMBER,...", help="Closest first to these values of objectives."),
    ] = None,
    different: Annotated[
        bool, typer.Option("--different", help="The most different designs, 10 unless --limit says.")
    ] = False,
    where: Annotated[
        list[str] | None,
        typer.Option(
            metavar="CONDITION",
            help="Only designs such as 'reach_height >= 1.5 and robot_torque@1.2 < 10'.",
        ),
    ] = None,
    limit: Annotated[
        int | None, typer.Option(min=1, metavar="N", help="At most so many.", show_default="all")
    ] = None,
    csv: Annotated[bool, typer.Option("--csv", help="Print CSV instead of tables.")] = False,
    json: Json = False,
    plot: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Also write a figure of the front (HTML).")
    ] = None,
    damaged: Damaged = False,
) -> None:
    """The Pareto front of a run, or a choice of its designs."""
    from evodesign.analysis.active_limits import frequent_limits
    from evodesign.cli.output import printable, show_notes, write_text
    from evodesign.problem.left_out import left_out
    from evodesign.runlog.run import read_run
    from evodesign.runlog.sampled_file import read_sampled

    if json and csv:
        raise InputError("--csv", "", "one form of output", "--json too")
    ways = {"--knee": knee, "--different": different, "--near": near is not None}
    asked = [option for option, is_given in ways.items() if is_given]
    if len(asked) > 1:
        raise InputError(asked[0], "", "one way to choose", f"{' and '.join(asked[1:])} too")
    opened = read_run(run)
    choice = _choice(opened, asked, near, where or (), limit)
    frequent = (printable(each.sentence) for each in frequent_limits(opened))
    show_notes([*opened.notes, *read_sampled(opened)[1], *frequent, *left_out(opened.header.problem)])
    if plot is not None:
        from evodesign.report.front_figure import front_html  # plotly takes its time to load

        write_text(plot, front_html(opened.header, opened.evaluations), "--plot")
    print_front(opened, choice, json=json, csv=csv)
    end_damaged(opened, accepted=damaged)


def _choice(
    run: RunLog, asked: Sequence[str], near: str | None, where: Sequence[str], limit: int | None
) -> Choice:
    """What the options choose."""
    from evodesign.analysis.choice import Choice, Order
    from evodesign.analysis.conditions import all_conditions, quantities
    from evodesign.analysis.decision_making import aspiration_of

    orders = {"--knee": Order.KNEE, "--different": Order.DIFFERENT, "--near": Order.NEAR}
    order = orders[asked[0]] if asked else Order.FIRST_OBJECTIVE
    known = quantities(run.header, run.evaluations[0] if run.evaluations else None)
    return Choice(
        where=all_conditions(where, known, "--where"),
        order=order,
        aspiration={} if near is None else aspiration_of(run.header.objectives, near, "--near"),
        limit=FEW if order is Order.DIFFERENT and limit is None else limit,
    )


def print_front(run: RunLog, choice: Choice | None = None, *, json: bool = False, csv: bool = False) -> None:
    """Print the front of a run, or a choice of it."""
    from evodesign.analysis.choice import Choice, choose
    from evodesign.analysis.people_spread import spread_among, spread_of_run
    from evodesign.cli.output import console, print_json, print_lines, printable
    from evodesign.cli.tables.front import front_csv, front_json, front_lines, front_table
    from evodesign.cli.tables.spread import spread_table
    from evodesign.runlog.sampled_file import read_sampled

    choice = Choice() if choice is None else choice
    chosen = choose(run.header.objectives, run.evaluations, choice)
    spread = spread_of_run(run, read_sampled(run)[0])
    if json:
        print_json(front_json(run, choice, chosen, spread))
    elif csv:
        sys.stdout.write(front_csv(run, chosen.designs, spread))
    else:
        rows = chosen.designs if choice.limit is not None else chosen.designs[:ROWS]
        if rows:
            console().print(front_table(run, choice, rows))
        shown = None if spread is None else spread_among(spread, [each.number for each in rows])
        if shown is not None:
            console().print(spread_table(shown, run.header.objectives, run.header.constrained))
        print_lines(*map(printable, front_lines(run, choice, chosen, len(rows), spread)))
