"""`report`: the page of a run."""

from __future__ import annotations

from pathlib import Path

from evodesign.cli.making import making
from evodesign.cli.output import console, show_notes
from evodesign.errors import InputError
from evodesign.report.page import page_content, page_html
from evodesign.runlog.run import read_run

__all__ = ["write_report"]

DEFAULT = "report.html"


def write_report(
    directory: Path, output: Path | None, designs: str, sensitivities: bool = False, jobs: int = 1
) -> None:
    """Write the page of a run and say where it lies, with a note on anything that it lacks."""
    asked = _numbers(designs)
    run = read_run(directory)
    content = page_content(run, asked)
    if sensitivities:
        from evodesign.report.page.gradients import with_gradients  # CasADi takes its time to load

        with making() as progress:
            content = with_gradients(content, run, jobs, progress)
    show_notes(content.notes)
    path = directory / DEFAULT if output is None else output
    page = page_html(content)
    try:
        path.write_text(page, encoding="utf-8")
    except OSError as error:
        wanted = "a file that can be written"
        raise InputError("--output", "", wanted, f"'{path}' ({error.strerror})") from error
    size = len(page.encode()) / 1e6
    console().print(f"{path} ({size:.1f} MB)", highlight=False, markup=False, soft_wrap=True)


def _numbers(text: str) -> tuple[int, ...]:
    """The numbers of a list such as `12,53`; none for an empty text."""
    parts = [part.strip() for part in text.split(",") if part.strip()]
    for part in parts:
        if not (part.isascii() and part.isdigit()):
            raise InputError("--designs", "", "numbers of evaluations such as 12,53", f"'{part}'")
    return tuple(dict.fromkeys(int(part) for part in parts))
