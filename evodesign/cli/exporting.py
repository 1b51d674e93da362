"""`export`: a design as a folder that other tools open."""

from __future__ import annotations

from pathlib import Path

from evodesign.cli.opening import open_design, scene_set_of
from evodesign.cli.output import console, show_notes
from evodesign.report.export.design import ExportedDesign
from evodesign.report.export.folder import export_design, refuse_full

__all__ = ["export_run_design"]


def export_run_design(directory: Path, number: int, to: Path, jobs: int) -> None:
    """Write the folder of a design and say what is in it."""
    refuse_full(to)  # before anything takes time
    opened = open_design(directory, number, jobs)
    run, evaluation = opened.run, opened.evaluation
    design = ExportedDesign(
        directory.resolve().name, run.header, evaluation, scene_set_of(opened), opened.heights
    )
    done = export_design(design, to, on_front=opened.on_front)
    show_notes(f"no {name}: {reason}" for name, reason in done.left_out.items())
    for path in done.files:
        console().print(str(path), highlight=False, markup=False, soft_wrap=True)
