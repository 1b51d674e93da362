"""`export`: a design as a folder that other tools open."""

from __future__ import annotations

from pathlib import Path

from evodesign.cli.making import making
from evodesign.cli.output import console, show_notes
from evodesign.report.export.design import ExportedDesign
from evodesign.report.export.folder import export_design, refuse_full
from evodesign.report.opened_design import open_design
from evodesign.runlog.run import read_run

__all__ = ["export_run_design"]


def export_run_design(directory: Path, number: int, to: Path, jobs: int) -> None:
    """Write the folder of a design and say what is in it."""
    refuse_full(to)  # before anything takes time
    run = read_run(directory)
    show_notes(run.notes)
    with making() as progress:
        opened = open_design(run, number, jobs, progress)
    evaluation = opened.evaluation
    design = ExportedDesign(
        directory.resolve().name, run.header, evaluation, opened.scene_set(), opened.heights
    )
    done = export_design(design, to, on_front=opened.on_front)
    show_notes(f"no {name}: {reason}" for name, reason in done.left_out.items())
    for path in done.files:
        console().print(str(path), highlight=False, markup=False, soft_wrap=True)
