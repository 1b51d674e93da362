"""Where a search stands, as the JSON object that the page and `watch --json` show.

Numbers are the log's, in natural values; times in seconds. Its shape is a promise.
"""

from __future__ import annotations

from typing import Any

from evodesign.analysis.hypervolume import best
from evodesign.analysis.knees import knees
from evodesign.analysis.watched import Standing
from evodesign.records import Evaluation, RunHeader

__all__ = ["MOST_KNEES", "MOST_POINTS", "state_of", "word"]

MOST_KNEES = 8
"""Knees of the front that are shown."""

MOST_POINTS = 2000
"""Designs of the front that are drawn; more are thinned out evenly, and the page says so."""

SILENCE = 60.0
"""Seconds without a new evaluation after which a search is called silent."""


def state_of(standing: Standing, *, ended: bool, now: float) -> dict[str, Any]:
    """The JSON object of a standing.

    Args:
        standing: of the search.
        ended: whether the last session closed its log.
        now: seconds since 1970.
    """
    header = standing.header
    objectives = header.objectives
    found = best(objectives, standing.front)
    drawn = standing.front[:: 1 + len(standing.front) // MOST_POINTS]
    return {
        "problem": header.problem_name,
        "algorithm": header.search.algorithm,
        "population": header.search.population,
        "seed": header.search.seed,
        "state": word(standing, ended=ended, now=now),
        "done": standing.done,
        "budget": header.budget,
        "feasible": standing.feasible,
        "failures": {str(status): count for status, count in standing.causes.items()},
        "per_second": standing.pace,
        "seconds_left": standing.seconds_left,
        "silent_seconds": None if standing.latest is None else max(0.0, now - standing.latest),
        "objectives": [
            {"name": each.name, "unit": each.unit, "sense": each.sense, "best": found.get(each.name)}
            for each in objectives
        ],
        "generations": [
            {
                "number": each.number,
                "evaluations": each.evaluations,
                "hypervolume": each.hypervolume,
                "feasible_share": each.feasible_share,
            }
            for each in standing.generations
        ],
        "front": [_point(header, each) for each in drawn],
        "front_size": len(standing.front),
        "others": [_point(header, each) for each in standing.others],
        "knees": [_point(header, each) for each in knees(objectives, standing.front)[:MOST_KNEES]],
    }


def word(standing: Standing, *, ended: bool, now: float) -> str:
    """The state in a word: finished, stopped, running, or silent for a minute or more."""
    if standing.done >= standing.header.budget:
        return "finished"
    if ended:
        return "stopped"
    latest = standing.latest
    return "silent" if latest is not None and now - latest > SILENCE else "running"


def _point(header: RunHeader, evaluation: Evaluation) -> list[float]:
    """Number and objectives of a design."""
    values = evaluation.assessment.objectives
    return [evaluation.number, *(values[objective.name] for objective in header.objectives)]
