"""`problems`: what comes with evodesign, to be searched as it is or copied and changed."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from textwrap import wrap
from typing import Annotated

import typer

from evodesign.cli.options import Json


def problems(
    name: Annotated[str | None, typer.Argument(metavar="[NAME]", help="One of them, for --to.")] = None,
    to: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="Copy its file, robot and starting designs into a new folder."),
    ] = None,
    json: Json = False,
) -> None:
    """List the problems that come with evodesign, or copy one to begin your own with."""
    from evodesign.cli.output import print_json, print_lines
    from evodesign.errors import InputError
    from evodesign.problem.copied import copy_source
    from evodesign.problem.shipped import shipped_problems
    from evodesign.problem.source import read_source

    if (name is None) != (to is None):
        raise InputError("problems", "", "a NAME with --to DIR, or neither", "one of them")
    if name is not None and to is not None:
        print_lines(*map(str, copy_source(read_source(name), to)))
        return
    found = shipped_problems()
    if json:
        print_json([asdict(each) | {"path": str(each.path)} for each in found])
        return
    for each in found:
        print_lines(each.name, *wrap(each.description, 76, initial_indent="    ", subsequent_indent="    "))
