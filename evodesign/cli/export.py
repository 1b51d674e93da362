"""`export`: a design as a folder that other tools open."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from evodesign.cli.options import CORES, Damaged, Design, Jobs, RunPath, end_damaged


def export(
    run: RunPath,
    design: Design,
    to: Annotated[Path, typer.Option(metavar="DIR", help="A new or empty folder.")],
    cad: Annotated[
        bool,
        typer.Option("--cad", help="STEP, STL and a drawing, too: pip install 'evodesign[cad]'."),
    ] = False,
    jobs: Jobs = CORES,
    damaged: Damaged = False,
) -> None:
    """One design of a run as files: URDF, MJCF, postures, and a replay for Foxglove and Lichtblick."""
    from evodesign.cli.output import print_lines, show_notes
    from evodesign.cli.progress import precompute_progress
    from evodesign.report.export.folder import export_logged, refuse_full, refuse_without_cad
    from evodesign.runlog.run import read_run

    refuse_full(to)  # before anything takes time
    if cad:
        refuse_without_cad()
    logged = read_run(run)
    show_notes(logged.notes)
    with precompute_progress() as progress:
        done = export_logged(logged, design, to, jobs, progress, cad=cad)
    show_notes(f"no {name}: {reason}" for name, reason in done.left_out.items())
    print_lines(*map(str, done.files))
    end_damaged(logged, accepted=damaged)
