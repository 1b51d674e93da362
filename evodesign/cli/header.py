"""The header of a run, and the evaluation that a header describes."""

from __future__ import annotations

import hashlib
import os
import platform
import subprocess
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path

import msgspec

from evodesign.cli.output import show_notes
from evodesign.posture.cache import user_cache
from evodesign.posture.human_value import HumanValue
from evodesign.problem.build import Problem, build_problem
from evodesign.problem.evaluate import AssessmentFactory, prepared
from evodesign.records import FORMAT_VERSION, RunHeader, SearchSettings

__all__ = ["header_of", "problem_factory", "renewed", "values_of"]

PACKAGES = ("evodesign", "casadi", "pin", "numpy", "pymoo", "cma", "moocore", "joblib", "mcap")


def header_of(problem: Problem, settings: SearchSettings, budget: int) -> RunHeader:
    """The header of a new run."""
    return RunHeader(
        format_version=FORMAT_VERSION,
        problem=problem.source,
        problem_name=problem.name,
        parameters=problem.space.records,
        objectives=problem.objectives,
        search=settings,
        budget=budget,
        versions=_versions(),
        git=_git_state(),
        started=_now(),
    )


def renewed(header: RunHeader) -> RunHeader:
    """The header of a later session of the same run."""
    return msgspec.structs.replace(header, versions=_versions(), git=_git_state(), started=_now())


def problem_factory(header: RunHeader) -> AssessmentFactory:
    """The evaluation of a header's problem, as a worker builds it."""
    digest = hashlib.sha256(msgspec.json.encode(header.problem, order="deterministic")).hexdigest()
    return AssessmentFactory(digest, header.problem, values_of(build_problem(header.problem)))


def values_of(problem: Problem) -> tuple[HumanValue, ...]:
    """The person's part of a problem, from the user's cache or worked out while the user is told."""
    try:
        cache = user_cache("people", os.environ)
    except OSError as error:
        show_notes([f"nothing can be kept for the next time: {error}"])
        cache = None
    return prepared(problem, cache, lambda sentence: show_notes([sentence]))


def _versions() -> dict[str, str]:
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
