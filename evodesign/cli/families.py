"""`families`: the best design of every kind that a run has met."""

from __future__ import annotations

from typing import Annotated

import typer

from evodesign.cli.options import Damaged, Json, RunPath, end_damaged


def families(
    run: RunPath,
    by: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME",
            help="What tells kinds apart: a quantity, or a sum such as 'length.thigh + length.shank'; may be "
            "given more than once.",
            show_default="as the search has it, or two parameters",
        ),
    ] = None,
    objective: Annotated[
        str, typer.Option(metavar="NAME", help="In which the best are looked for.", show_default="the first")
    ] = "",
    cells: Annotated[
        int | None,
        typer.Option(min=1, max=1000, metavar="N", help="Parts of each range.", show_default="20"),
    ] = None,
    json: Json = False,
    damaged: Damaged = False,
) -> None:
    """Families: the best design of every kind, kinds being cells of a grid over quantities of your choice."""
    from evodesign.analysis.families import families as found_in
    from evodesign.analysis.families import families_json
    from evodesign.cli.output import console, print_json, print_lines, printable, show_notes
    from evodesign.cli.tables.families import families_line, families_table
    from evodesign.runlog.run import read_run

    opened = read_run(run)
    show_notes(opened.notes)
    found = found_in(opened.header, opened.evaluations, by or (), objective, cells)
    if json:
        print_json({"run": str(run), **families_json(found)})
    else:
        if found.kinds:
            console().print(families_table(opened.header, found))
        print_lines(printable(families_line(found)))
    end_damaged(opened, accepted=damaged)
