"""Showing fewer points than there are, evenly, and saying so."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeVar

__all__ = ["subsample"]

T = TypeVar("T")


def subsample(items: Sequence[T], most: int) -> list[T]:
    """At most so many of the items, in order, evenly over the whole: item i of n is floor(i len / n)."""
    if len(items) <= most:
        return list(items)
    return [items[i * len(items) // most] for i in range(most)]
