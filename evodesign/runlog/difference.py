"""What differs between two headers: the reason why a log cannot be continued, in words.

Problem and search must be the same for a log to be one run. Versions of packages may differ; those that
decide which designs are asked for, or the results of a design, are distinguished from the others.
"""

from __future__ import annotations

from collections.abc import Mapping

import msgspec

from evodesign.records import ProblemSource, RunHeader

__all__ = ["DECISIVE", "differences", "source_differences", "version_differences"]

DECISIVE = ("evodesign", "casadi", "pin", "numpy", "scipy", "pymoo", "cma", "moocore")
"""Packages on whose versions the results of a search depend."""


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
        for name in ("problem_name", "parameters", "objectives")
        if not found and getattr(first, name) != getattr(second, name)
    ]
    return found


def source_differences(first: ProblemSource, second: ProblemSource) -> list[str]:
    """What differs in a problem's files, a phrase each."""
    found = []
    if first.text != second.text:
        line = _first_difference(first.text, second.text)
        found.append(f"the problem file differs in line {line}")
    return found + [f"the file of '{name}' differs" for name in _unequal(first.files, second.files)]


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


def _unequal(first: Mapping[str, str], second: Mapping[str, str]) -> list[str]:
    return [name for name in sorted({*first, *second}) if first.get(name) != second.get(name)]


def _short(value: object) -> str:
    if value is msgspec.UNSET:
        return "none"
    text = value if isinstance(value, str) else msgspec.json.encode(value).decode()
    return f"'{text[:40]}...'" if len(text) > 40 else f"'{text}'"
