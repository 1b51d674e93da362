"""`verify`: the files of a run checked."""

from __future__ import annotations

from evodesign.cli.options import Json, RunPath
from evodesign.errors import ResumeMismatch, RunError


def verify(run: RunPath, json: Json = False) -> None:
    """Check a run: every checksum and record, their order, what follows from them, and the replay."""
    from evodesign.analysis.audit import audit
    from evodesign.cli.output import print_json, print_lines, show_notes
    from evodesign.cli.tables.run import run_json, run_lines
    from evodesign.evolve import replay
    from evodesign.runlog.run import read_run

    opened = read_run(run)
    faults = list(dict.fromkeys((*opened.faults, *audit(opened))))
    try:
        replay(opened)
    except ResumeMismatch as mismatch:
        faults.append(str(mismatch))
    if json:
        print_json(run_json(opened) | {"sound": not faults, "faults": faults})
    else:
        print_lines(*(faults or run_lines(opened)))
        show_notes(note for note in opened.notes if note not in faults)
    if faults:
        raise RunError(f"{run}: {len(faults)} fault{'s' * (len(faults) > 1)} found")
