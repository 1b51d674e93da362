"""One short text that stands for everything a run has found.

Two runs have the same digest exactly when their evaluations agree in number, generation, genome and outcome:
times, names of workers, order of arrival and number of sessions do not count.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable

import msgspec

from evodesign.records import Evaluation

__all__ = ["digest"]


def digest(evaluations: Iterable[Evaluation]) -> str:
    """SHA-256, in hexadecimal, of the evaluations in the order given, without times and workers."""
    found = hashlib.sha256()
    for evaluation in evaluations:
        bare = msgspec.structs.replace(evaluation, seconds=0.0, worker="")
        found.update(msgspec.json.encode(bare, order="deterministic") + b"\n")
    return found.hexdigest()
