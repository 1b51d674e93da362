"""IPOPT as the judge of the native method: some designs of every search are solved by both.

Which ones follows from the genome alone, so that an evaluation stays a function of problem and design.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import msgspec

from evodesign.identity import digest
from evodesign.records import Evaluation, Genome

ONE_IN = 2000
"""Of so many designs one is judged, which takes about a hundred times as long as an evaluation."""

AGREEMENT = 1e-5
"""Largest difference of an objective, relative to its size or to 1, that goes without a word."""


def is_judged(genome: Genome) -> bool:
    """Whether IPOPT solves a genome, too."""
    return int(digest(genome)[:12], 16) % ONE_IN == 0


def judged_notes(evaluations: Iterable[Evaluation]) -> Iterator[str]:
    """A sentence for each objective on which the judge differs, or that only one of both found."""
    for evaluation in evaluations:
        judged = evaluation.assessment.judged
        if judged is msgspec.UNSET:
            continue
        own = evaluation.assessment.objectives
        for name in sorted(own.keys() | judged.keys()):
            mine, its = own.get(name), judged.get(name)
            if mine is not None and its is not None and abs(mine - its) <= AGREEMENT * max(1.0, abs(its)):
                continue
            told = [f"{value:.7g}" if value is not None else "no value" for value in (mine, its)]
            yield f"evaluation {evaluation.number}: {name} is {told[0]}; IPOPT finds {told[1]}"
