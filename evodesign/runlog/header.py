"""The header of a run: its problem and search, the software and time of each session, and what differs.

Problem and search must be the same for a log to be one run: what differs between two headers is the reason,
in words, why a log cannot be continued. Versions of packages may differ; those that decide which designs are
asked for, or the results of a design, are distinguished from the others.
"""

from __future__ import annotations

import platform
import subprocess
from collections.abc import Mapping
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import Protocol

import msgspec

from evodesign.errors import RunError
from evodesign.records import (
    FORMAT_VERSION,
    Constraint,
    Objective,
    Parameter,
    ProblemSource,
    RunHeader,
    SearchSettings,
)

PACKAGES = ("evodesign", "casadi", "pin", "numpy", "scipy", "pymoo", "cma", "moocore", "joblib", "mcap")

DECISIVE = ("evodesign", "casadi", "pin", "numpy", "scipy", "pymoo", "cma", "moocore")
"""Packages on whose versions the results of a search depend."""


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

    @property
    def constraints(self) -> tuple[Constraint, ...]: ...


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
        constraints=problem.constraints or msgspec.UNSET,
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


def differences(first: RunHeader, second: RunHeader) -> list[str]:
    """What differs in problem and search, a phrase each; where the problem file lay does not matter."""
    found = source_differences(first.problem, second.problem)
    if first.problem.symmetry != second.problem.symmetry:
        found.append(f"the symmetry was {first.problem.symmetry} and is {second.problem.symmetry}")
    found += [
        f"the search's {name} was {_short(getattr(first.search, name))}"
        f" and is {_short(getattr(second.search, name))}"
        for name in first.search.__struct_fields__
        if getattr(first.search, name) != getattr(second.search, name)
    ]
    found += [
        f"its {name.replace('_', ' ')} differ"
        for name in ("problem_name", "parameters", "objectives", "constraints")
        if not found and getattr(first, name) != getattr(second, name)
    ]
    return found


def source_differences(first: ProblemSource, second: ProblemSource) -> list[str]:
    """What differs in a problem's files, a phrase each."""
    found = []
    if first.text != second.text:
        line = _first_difference(first.text, second.text)
        found.append(f"the problem file differs in line {line}")
    names = sorted({*first.files, *second.files})
    unequal = (name for name in names if first.files.get(name) != second.files.get(name))
    return found + [f"the file of '{name}' differs" for name in unequal]


def version_differences(first: Mapping[str, str], second: Mapping[str, str]) -> list[str]:
    """Decisive packages whose versions differ, such as `numpy 2.0 (now 2.1)`; unknown ones do not count."""
    return [
        f"{name} {first[name]} (now {second[name]})"
        for name in DECISIVE
        if name in first and name in second and first[name] != second[name]
    ]


def _first_difference(first: str, second: str) -> int:
    """Number of the first line, from one, in which two unequal texts differ."""
    lines, others = first.splitlines(), second.splitlines()
    pairs = zip(lines, others, strict=False)
    return next(
        (number for number, (one, other) in enumerate(pairs, 1) if one != other),
        1 + min(len(lines), len(others)),
    )


def _short(value: object) -> str:
    if value is msgspec.UNSET:
        return "none"
    text = value if isinstance(value, str) else msgspec.json.encode(value).decode()
    return f"'{text[:40]}...'" if len(text) > 40 else f"'{text}'"
