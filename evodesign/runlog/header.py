"""The header of a run: its problem and search, and the software and time of each session."""

from __future__ import annotations

import platform
import subprocess
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import Protocol

import msgspec

from evodesign.errors import RunError
from evodesign.records import (
    FORMAT_VERSION,
    Objective,
    Parameter,
    ProblemSource,
    RunHeader,
    SearchSettings,
)
from evodesign.runlog.difference import version_differences

__all__ = ["header_of", "renewed", "versions"]

PACKAGES = ("evodesign", "casadi", "pin", "numpy", "scipy", "pymoo", "cma", "moocore", "joblib", "mcap")


class _Space(Protocol):
    @property
    def records(self) -> tuple[Parameter, ...]: ...


class _Problem(Protocol):
    """A problem, as far as a log knows it: a run is read without robots."""

    @property
    def source(self) -> ProblemSource: ...

    @property
    def name(self) -> str: ...

    @property
    def space(self) -> _Space: ...

    @property
    def objectives(self) -> tuple[Objective, ...]: ...


def header_of(problem: _Problem, settings: SearchSettings, budget: int) -> RunHeader:
    """The header of a new run."""
    return RunHeader(
        format_version=FORMAT_VERSION,
        problem=problem.source,
        problem_name=problem.name,
        parameters=problem.space.records,
        objectives=problem.objectives,
        search=settings,
        budget=budget,
        versions=versions(),
        git=_git_state(),
        started=_now(),
    )


def renewed(header: RunHeader, directory: Path, accept_versions: bool) -> tuple[RunHeader, tuple[str, ...]]:
    """The header of a later session of the same run, and notes on what is strange about it.

    Raises:
        RunError: packages that decide results have other versions, and that was not accepted.
    """
    new = msgspec.structs.replace(header, versions=versions(), git=_git_state(), started=_now())
    differing = version_differences(header.versions, new.versions)
    if differing and not accept_versions:
        raise RunError(
            f"{directory}: was written with {', '.join(differing)}, so that the resumed run might not equal "
            "an uninterrupted one; install those versions, or go on all the same with --accept-versions"
        )
    late = f"the clock stands before {header.started}, when the last session began: times will overlap"
    return new, (late,) if new.started < header.started else ()


def versions() -> dict[str, str]:
    """Versions, by package, of what is installed here."""
    return {"python": platform.python_version(), **{name: version(name) for name in PACKAGES}}


def _git_state() -> str | None:
    """Commit of the checkout that evodesign runs from, with `-dirty` if it was changed; None outside one."""
    here = Path(__file__).parent
    command = ["git", "-C", str(here), "describe", "--always", "--dirty", "--abbrev=12"]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=5.0, check=True)  # noqa: S603
    except (OSError, subprocess.SubprocessError):
        return None
    return done.stdout.strip() or None


def _now() -> str:
    return datetime.now(UTC).isoformat(timespec="seconds")
