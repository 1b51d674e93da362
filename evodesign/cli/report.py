"""`report`: the page of a run."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from evodesign.cli.options import CORES, Damaged, Jobs, RunPath, end_damaged
from evodesign.errors import InputError

DEFAULT = "report.html"


def report(
    run: RunPath,
    output: Annotated[
        Path | None, typer.Option(metavar="FILE", help="The page.", show_default="RUN/report.html")
    ] = None,
    designs: Annotated[
        str, typer.Option(metavar="NUMBERS", help="Designs to mark and to show postures of, such as 12,53.")
    ] = "",
    sensitivities: Annotated[
        bool,
        typer.Option(
            "--sensitivities", help="Also how the marked designs' objectives move; solves these designs anew."
        ),
    ] = False,
    jobs: Jobs = CORES,
    damaged: Damaged = False,
) -> None:
    """Write the page of a run: front, parameters, progress, failures, postures; one file, no network."""
    from evodesign.cli.output import print_lines, show_notes, write_text
    from evodesign.cli.progress import precompute_progress
    from evodesign.report.opened_design import with_postures
    from evodesign.report.page import page_content, page_html
    from evodesign.runlog.run import read_run

    asked = _numbers(designs)
    opened = read_run(run)
    with precompute_progress() as progress:
        content = page_content(with_postures(opened, asked, jobs, progress), asked)
        if sensitivities:
            from evodesign.report.page.gather import with_gradients  # CasADi takes its time to load

            content = with_gradients(content, opened, jobs, progress)
    show_notes(content.notes)
    path = run / DEFAULT if output is None else output
    page = page_html(content)
    write_text(path, page, "--output", follow=output is not None)
    print_lines(f"{path} ({len(page.encode()) / 1e6:.1f} MB)")
    end_damaged(opened, accepted=damaged)


def _numbers(text: str) -> tuple[int, ...]:
    """The numbers of a list such as `12,53`; none for an empty text."""
    parts = [part.strip() for part in text.split(",") if part.strip()]
    for part in parts:
        if not (part.isascii() and part.isdigit()):
            raise InputError("--designs", "", "numbers of evaluations such as 12,53", f"'{part}'")
    return tuple(dict.fromkeys(int(part) for part in parts))
