"""A robot that holds the load alone: what a problem file without `[human]` may not ask for."""

from __future__ import annotations

from collections.abc import Iterator

from evodesign.errors import InputError
from evodesign.mechanics.disturbance import PushedAt
from evodesign.problem.file import ProblemFile
from evodesign.records import ProblemSource
from evodesign.searches.base import JOINT_STARTS


def refuse_what_needs_people(tables: ProblemFile, source: ProblemSource) -> None:
    """Refuse what only people answer, in a problem without them.

    Raises:
        InputError: naming the key.
    """
    for key in _needing_people(tables) if tables.human is None else ():
        raise InputError(source.path, key, "a [human] with it", "a robot that holds the load alone")


def _needing_people(tables: ProblemFile) -> Iterator[str]:
    if tables.task.lift:
        yield "task.lift"
    if tables.task.robot_share is not None:
        yield "task.robot_share"
    if tables.task.effort_weights is not None:
        yield "task.effort_weights"
    if tables.design.allocation:
        yield "design.allocation"
    if tables.search.algorithm == JOINT_STARTS:
        yield "search.algorithm"
    for place, disturbance in enumerate(tables.disturbance):
        if disturbance.at is PushedAt.HUMAN:
            yield f"disturbance[{place}].at"
