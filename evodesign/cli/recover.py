"""`recover`: what can be read of a damaged run, as a new one."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from evodesign.cli.options import Json, RunPath


def recover(
    run: RunPath,
    to: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Directory to write.", show_default="RUN-recovered")
    ] = None,
    json: Json = False,
) -> None:
    """Write all that can be read of a damaged run to a new directory, and say what is lost."""
    from evodesign.analysis.audit import losses
    from evodesign.cli.output import print_json, print_lines
    from evodesign.cli.tables.run import run_json, run_lines
    from evodesign.runlog import rewrite
    from evodesign.runlog.run import read_run

    damaged = read_run(run)
    place = run.with_name(f"{run.resolve().name}-recovered") if to is None else to
    recovered = rewrite.recover(run, place)
    lost = list(dict.fromkeys((*damaged.notes, *losses(damaged))))
    if json:
        print_json(run_json(recovered) | {"lost": lost})
    else:
        print_lines(*lost, *run_lines(recovered), f"go on with: evodesign resume {place}")
