"""`schema`: what a problem file may hold, for editors and other programs."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer


def schema(
    to: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write it there.", show_default="standard output")
    ] = None,
) -> None:
    """Print the JSON Schema of problem files, by which editors check and complete them."""
    from evodesign.cli.output import print_lines, write_text
    from evodesign.problem.schema import schema_file

    if to is None:
        sys.stdout.write(schema_file())
    else:
        write_text(to, schema_file(), "--to")
        print_lines(f"{to}")
