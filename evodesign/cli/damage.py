"""The end of a command that shows what is left of a damaged run."""

from __future__ import annotations

from typing import TYPE_CHECKING

import typer

if TYPE_CHECKING:
    from evodesign.runlog.run import RunLog

FROM_DAMAGED = 4
"""Exit code of a command that is done, from a damaged run."""


def end(*runs: RunLog, accepted: bool) -> None:
    """End the command with its exit code if a run is damaged, unless the user accepts that."""
    from evodesign.cli.output import show_notes

    damaged = [run for run in runs if run.damaged]
    if damaged and not accepted:
        show_notes(
            f"{run.directory} is damaged, so this is not all that it found: exit code {FROM_DAMAGED}, "
            "or 0 with --damaged"
            for run in damaged
        )
        raise typer.Exit(FROM_DAMAGED)
