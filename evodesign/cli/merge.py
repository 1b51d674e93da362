"""`merge`: the segments of a run as one file."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from evodesign.cli.options import Json, RunPath


def merge(
    run: RunPath,
    to: Annotated[
        Path | None, typer.Option(metavar="FILE", help="File to write.", show_default="in place")
    ] = None,
    json: Json = False,
) -> None:
    """Put all segments of a run into one indexed MCAP file."""
    from evodesign.cli.output import print_json, print_lines
    from evodesign.cli.tables.run import run_json, run_lines
    from evodesign.runlog import rewrite
    from evodesign.runlog.directory import run_segments

    count = len(run_segments(run))
    merged = rewrite.merge(run, to)
    if json:
        print_json(run_json(merged) | {"merged": count})
    else:
        place = merged.directory / "000.mcap" if to is None else to
        print_lines(f"segments merged into {place}: {count}", *run_lines(merged))
