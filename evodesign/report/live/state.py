"""Where a search stands, as the JSON object that the page and `watch --json` show.

Numbers are the log's, in natural values; times in seconds. Its shape is a promise.
"""

from __future__ import annotations

from typing import Any

from evodesign.analysis.decision_making import knees
from evodesign.analysis.hypervolume import best
from evodesign.analysis.live_state import LiveState
from evodesign.records import Evaluation, RunHeader

__all__ = ["MOST_KNEES", "MOST_POINTS", "state_of", "word"]

MOST_KNEES = 8
"""Knees of the front that are shown."""

MOST_POINTS = 2000
"""Designs of the front that are drawn; more are thinned out evenly, and the page says so."""

SILENCE = 60.0
"""Seconds without a new evaluation after which a search is called silent."""


def state_of(live_state: LiveState, *, ended: bool, now: float) -> dict[str, Any]:
    """The JSON object of a live run's state.

    Args:
        live_state: of the search.
        ended: whether the last session closed its log.
        now: seconds since 1970.
    """
    header = live_state.header
    objectives = header.objectives
    found = best(objectives, live_state.front)
    drawn = live_state.front[:: 1 + len(live_state.front) // MOST_POINTS]
    return {
        "problem": header.problem_name,
        "algorithm": header.search.algorithm,
        "population": header.search.population,
        "seed": header.search.seed,
        "state": word(live_state, ended=ended, now=now),
        "done": live_state.done,
        "budget": header.budget,
        "feasible": live_state.feasible,
        "failures": {str(status): count for status, count in live_state.causes.items()},
        "per_second": live_state.pace,
        "seconds_left": live_state.seconds_left,
        "silent_seconds": None if live_state.latest is None else max(0.0, now - live_state.latest),
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
            for each in live_state.generations
        ],
        "front": [_point(header, each) for each in drawn],
        "front_size": len(live_state.front),
        "others": [_point(header, each) for each in live_state.others],
        "knees": [_point(header, each) for each in knees(objectives, live_state.front)[:MOST_KNEES]],
    }


def word(live_state: LiveState, *, ended: bool, now: float) -> str:
    """The state in a word: finished, stopped, running, or silent for a minute or more."""
    if live_state.done >= live_state.header.budget:
        return "finished"
    if ended:
        return "stopped"
    latest = live_state.latest
    return "silent" if latest is not None and now - latest > SILENCE else "running"


def _point(header: RunHeader, evaluation: Evaluation) -> list[float]:
    """Number and objectives of a design."""
    values = evaluation.assessment.objectives
    return [evaluation.number, *(values[objective.name] for objective in header.objectives)]
