"""How a problem file divides the work between robot and person, with every contradiction refused."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from evodesign.design.allocation import ALLOCATIONS, EFFORT_RATIO, ROBOT_SHARE
from evodesign.errors import InputError, nearest_name
from evodesign.mechanics.load_share import share_interval
from evodesign.mechanics.scene import Scene
from evodesign.posture.allocation import EffortWeights
from evodesign.problem.file import AllocationTable, ProblemFile
from evodesign.records import ProblemSource

__all__ = ["check_allocations", "effort_weights", "robot_share"]

SAME = 1e-6
"""Difference of two shares that counts as none."""


def check_allocations(tables: ProblemFile, source: ProblemSource) -> None:
    """Refuse allocation parameters that do not exist, exceed their range, or are fixed as well.

    Raises:
        InputError: naming the allocation parameter.
    """
    fixed = {ROBOT_SHARE: tables.task.robot_share, EFFORT_RATIO: tables.task.effort_weights}
    keys = {ROBOT_SHARE: "task.robot_share", EFFORT_RATIO: "task.effort_weights"}
    for position, table in enumerate(tables.design.policy):
        key = f"design.policy[{position}]"
        if table.name not in ALLOCATIONS:
            wanted = f"one of {', '.join(ALLOCATIONS)}"
            found = f"'{table.name}'{nearest_name(table.name, ALLOCATIONS)}"
            raise InputError(source.path, f"{key}.name", wanted, found)
        policy = ALLOCATIONS[table.name]
        for bound, value in (("lower", table.lower), ("upper", table.upper)):
            if not policy.means(value):
                raise InputError(source.path, f"{key}.{bound}", policy.wanted, f"{value:g}")
        if fixed[table.name] is not None:
            found = f"both this and [[design.policy]] {table.name}"
            raise InputError(source.path, keys[table.name], "either a fixed value or a policy", found)


def effort_weights(tables: ProblemFile) -> EffortWeights:
    """The fixed weights of the efforts."""
    given = tables.task.effort_weights
    return EffortWeights() if given is None else EffortWeights(given.robot, given.human)


def robot_share(tables: ProblemFile, source: ProblemSource, scene: Scene) -> float | None:
    """The share that the scene's programs must be given; None where statics, the solver or a design decides.

    Args:
        tables: the problem file; its allocation parameters are sound.
        source: the problem, for messages.
        scene: agents and load.
    Raises:
        InputError: a share that the load's balance does not allow.
    """
    asked = _asked(tables)
    if not asked:
        return None
    low, high = share_interval(scene)
    free = high - low > SAME
    for disturbance in scene.disturbances.cases if free else ():
        ends = share_interval(replace(scene, payload=scene.payload.disturbed(disturbance)))
        low, high = max(low, ends[0]), min(high, ends[1])
    for key, share in asked.items():
        if not low - SAME <= share <= high + SAME:
            raise InputError(source.path, key, _allowed(scene, low, high), f"{share:g}")
    return tables.task.robot_share if free else None


def _asked(tables: ProblemFile) -> Mapping[str, float]:
    """Every share that is asked for, by its key."""
    if tables.task.robot_share is not None:
        return {"task.robot_share": tables.task.robot_share}
    allocations = [(i, table) for i, table in enumerate(tables.design.policy) if table.name == ROBOT_SHARE]
    return {key: value for i, table in allocations for key, value in _ends(i, table)}


def _ends(position: int, table: AllocationTable) -> tuple[tuple[str, float], ...]:
    key = f"design.policy[{position}]"
    return (f"{key}.lower", table.lower), (f"{key}.upper", table.upper)


def _allowed(scene: Scene, low: float, high: float) -> str:
    """The shares that balance the load, in words."""
    label = scene.payload.label
    grasps = f"{scene.payload.grasp} grasps of '{label}'" if label else f"{scene.payload.grasp} grasps"
    if high < low:
        return f"{grasps} that balance the load at all"
    if high - low <= SAME:
        return f"the robot's share that {grasps} leave here, {low:g}"
    return f"a share from {max(low, 0.0):g} to {min(high, 1.0):g}, which {grasps} can hold here"
