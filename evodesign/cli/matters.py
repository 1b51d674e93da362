"""`matters`: which parameters matter to which objective, by a run's log."""

from __future__ import annotations

from typing import Annotated

import typer

from evodesign.cli.options import Damaged, Json, RunPath, end_damaged


def matters(
    run: RunPath,
    design: Annotated[
        int | None,
        typer.Option(min=0, metavar="N", help="Also slices through this design, along every parameter."),
    ] = None,
    json: Json = False,
    damaged: Damaged = False,
) -> None:
    """What matters: each parameter's share of every objective's variance, and slices through a design."""
    from evodesign.analysis.importance import importance, slices
    from evodesign.analysis.importance_json import matters_json
    from evodesign.cli.output import console, print_json, print_lines, printable, show_notes
    from evodesign.cli.tables.matters import importance_tables, slice_tables
    from evodesign.runlog.run import read_run

    opened = read_run(run)
    through = None if design is None else opened.evaluation(design)
    show_notes(opened.notes)
    if json:
        print_json(matters_json(opened, design))
    else:
        found = importance(opened.header, opened.evaluations)
        tables = [*importance_tables(found)]
        if through is not None:
            made = slices(found, opened.header.parameters, through)
            tables += slice_tables(opened.header, through, made)
        for table in tables:
            console().print(table)
        print_lines(*map(printable, found.sentences))
    end_damaged(opened, accepted=damaged)
