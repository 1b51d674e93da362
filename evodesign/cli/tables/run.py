"""What the files of a run hold, as JSON and as lines."""

from __future__ import annotations

from typing import Any

from evodesign.runlog.directory import run_segments
from evodesign.runlog.run import RunLog, digest


def run_json(run: RunLog) -> dict[str, Any]:
    """What a run holds as a JSON object; its shape is a promise."""
    return {
        "run": str(run.directory),
        "format_version": run.header.format_version,
        "segments": len(run_segments(run.directory)),
        "evaluations": len(run.evaluations),
        "generations": len(run.generations),
        "postures": len(run.details),
        "digest": digest(run.evaluations),
    }


def run_lines(run: RunLog) -> list[str]:
    """The same in two lines."""
    holds = run_json(run)
    return [
        f"{run.directory}: {holds['evaluations']} evaluations, {holds['generations']} generations, "
        f"postures of {holds['postures']} designs, segments: {holds['segments']}, "
        f"format {holds['format_version']}",
        f"digest {holds['digest']}",
    ]
