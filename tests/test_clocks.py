"""No test fails because a machine is busy: none compares seconds that have passed with a number."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

TESTS = Path(__file__).parent
CLOCKS = {"monotonic", "perf_counter", "time"}


def limited_seconds(code: str) -> Iterator[int]:
    """Lines with an assertion that a difference of clock readings is on some side of a number."""
    for node in ast.walk(ast.parse(code)):
        if isinstance(node, ast.Assert):
            for compared in ast.walk(node.test):
                if isinstance(compared, ast.Compare):
                    sides = [compared.left, *compared.comparators]
                    numbers = any(isinstance(side, ast.Constant) for side in sides)
                    if numbers and any(_reads_a_clock(side) for side in sides):
                        yield node.lineno


def _reads_a_clock(expression: ast.expr) -> bool:
    return any(
        isinstance(each, ast.Call) and isinstance(each.func, ast.Attribute) and each.func.attr in CLOCKS
        for each in ast.walk(expression)
    )


def test_no_test_limits_the_time_that_something_takes() -> None:
    texts = {str(path.relative_to(TESTS)): path.read_text() for path in TESTS.rglob("*.py")}
    timed = [path for path, text in texts.items() if any(f".{clock}(" in text for clock in CLOCKS)]
    assert timed
    found = {path: [*limited_seconds(texts[path])] for path in timed}
    assert {path: lines for path, lines in found.items() if lines} == {}


@pytest.mark.parametrize(
    ("line", "found"),
    [
        ("assert time.monotonic() - began < 2.0", True),
        ("assert 0.5 <= perf.perf_counter() - start < 2.0", True),
        ("assert time.monotonic() < end", False),
        ("assert seconds < 2.0", False),
    ],
)
def test_what_counts_as_a_limit(line: str, found: bool) -> None:
    assert bool([*limited_seconds(line)]) is found
