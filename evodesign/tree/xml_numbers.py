"""Numbers in a robot file: the shortest text that reads back to the same double, finite ones only."""

from __future__ import annotations

import math
from collections.abc import Iterable

from evodesign.body.placement import Scalar

__all__ = ["numbers_text"]


def numbers_text(numbers: Iterable[Scalar]) -> str:
    """Numbers separated by spaces.

    Raises:
        TypeError: one is an expression.
        ValueError: one is not finite.
    """
    return " ".join(_number(number) for number in numbers)


def _number(number: Scalar) -> str:
    if not isinstance(number, int | float):
        raise TypeError(
            f"a robot file holds numbers, not {type(number).__name__}: give the tree numbers first"
        )
    if not math.isfinite(number):
        raise ValueError(f"a robot file holds finite numbers, not {number}")
    without_negative_zero = float(number) + 0.0
    return repr(without_negative_zero)
