"""`verify`, `recover` and `merge`: the files of a run."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from evodesign.analysis.audit import audit
from evodesign.analysis.loss import losses
from evodesign.cli.output import console, print_json, show_notes
from evodesign.errors import ResumeMismatch, RunError
from evodesign.evolve import replay
from evodesign.runlog.digest import digest
from evodesign.runlog.directory import run_segments
from evodesign.runlog.rewrite import merge, recover
from evodesign.runlog.run import Run, read_run

__all__ = ["merge_run", "recover_run", "verify_run"]


def verify_run(directory: Path, json: bool) -> None:
    """Check files, records and replay of a run; print what is wrong.

    Raises:
        RunError: something is.
    """
    run = read_run(directory)
    faults = [*(run.notes if run.damaged else ()), *audit(run), *_replay_faults(run)]
    if json:
        print_json(_summary(run) | {"sound": not faults, "faults": faults})
    else:
        _print([*faults, *(_sentences(run) if not faults else ())])
        show_notes(() if run.damaged else run.notes)
    if faults:
        raise RunError(f"{directory}: {len(faults)} fault{'s' * (len(faults) > 1)} found")


def recover_run(directory: Path, to: Path | None, json: bool) -> None:
    """Write all that can be read of a run to a new directory, and say what is lost."""
    damaged = read_run(directory)
    place = directory.with_name(f"{directory.resolve().name}-recovered") if to is None else to
    run = recover(directory, place)
    lost = [*damaged.notes, *losses(damaged)]
    if json:
        print_json(_summary(run) | {"lost": lost})
        return
    _print([*lost, *_sentences(run), f"go on with: evodesign resume {place}"])


def merge_run(directory: Path, to: Path | None, json: bool) -> None:
    """Put all segments of a run into one file."""
    count = len(run_segments(directory))
    run = merge(directory, to)
    if json:
        print_json(_summary(run) | {"merged": count})
        return
    place = run.directory / "000.mcap" if to is None else to
    _print([f"segments merged into {place}: {count}", *_sentences(run)])


def _replay_faults(run: Run) -> list[str]:
    try:
        replay(run)
    except ResumeMismatch as mismatch:
        return [str(mismatch)]
    return []


def _summary(run: Run) -> dict[str, Any]:
    return {
        "run": str(run.directory),
        "format_version": run.header.format_version,
        "segments": len(run_segments(run.directory)),
        "evaluations": len(run.evaluations),
        "generations": len(run.generations),
        "postures": len(run.details),
        "digest": digest(run.evaluations),
    }


def _sentences(run: Run) -> list[str]:
    summary = _summary(run)
    return [
        f"{run.directory}: {summary['evaluations']} evaluations, {summary['generations']} generations, "
        f"postures of {summary['postures']} designs, segments: {summary['segments']}, "
        f"format {summary['format_version']}",
        f"digest {summary['digest']}",
    ]


def _print(sentences: list[str]) -> None:
    for sentence in sentences:
        console().print(sentence, highlight=False, markup=False, soft_wrap=True)
