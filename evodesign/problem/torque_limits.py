"""Limits of the robot's joint torques: the URDF's effort limits, and what the problem file says instead."""

from __future__ import annotations

import math
from collections.abc import Mapping
from fnmatch import fnmatchcase

from evodesign.errors import InputError, nearest_name
from evodesign.problem.file import ProblemFile, TorqueLimits
from evodesign.records import ProblemSource
from evodesign.statics.scene import Agent

__all__ = ["refuse_unlimited", "torque_limits"]

KEY = "robot.torque_limits_n_m"


def torque_limits(tables: ProblemFile, source: ProblemSource, robot: Agent) -> Mapping[str, float]:
    """The largest torque [N m] of each of the robot's moving joints that has a finite one.

    A key of `[robot.torque_limits_n_m]` is a joint's name, or a pattern such as `*_knee` for all joints that
    it fits; a name counts more than a pattern.

    Raises:
        InputError: a key that no joint answers to, or a joint that answers to two patterns; a limit that
            is not positive; or limits that shall hold where there are none.
    """
    given = tables.robot.torque_limits_n_m
    asked = {name: _asked(name, given, source) for name in robot.joints}
    _refuse_unanswered(given, source, robot)
    limits: dict[str, float] = {}
    for name, limit in asked.items():
        effort = robot.tree.joint_by_name[name].effort if limit is None else limit
        if not effort > 0.0:
            wanted = f"a positive effort limit of the joint '{name}', or one in {KEY}"
            raise InputError(source.path, "robot.urdf", wanted, f"{effort:g}")
        if math.isfinite(effort):
            limits[name] = effort
    if tables.robot.torque_limits is TorqueLimits.HARD and not limits:
        wanted = f"'none', or a joint with an effort limit in '{tables.robot.urdf}' or in {KEY}"
        raise InputError(source.path, "robot.torque_limits", wanted, "'hard' and no limits")
    return limits


def refuse_unlimited(robot: Agent, source: ProblemSource, key: str, name: str) -> None:
    """Refuse an objective that needs a torque limit of every joint of the robot.

    Args:
        robot: whose limits are known.
        source: the problem, for messages.
        key: where in it the objective is named.
        name: of the objective.
    Raises:
        InputError: naming a joint without a limit.
    """
    for joint in robot.joints:
        if joint not in robot.torque_limits:
            wanted = f"a torque limit of every joint of the robot for '{name}', in its URDF or in {KEY}"
            raise InputError(source.path, key, wanted, f"none of '{joint}'")


def _asked(joint: str, given: Mapping[str, float], source: ProblemSource) -> float | None:
    """The limit that the problem file gives a joint."""
    if joint in given:
        return given[joint]
    patterns = [pattern for pattern in given if fnmatchcase(joint, pattern)]
    if len(patterns) > 1:
        found = f"'{joint}' in '{patterns[0]}' and '{patterns[1]}'"
        raise InputError(source.path, KEY, "patterns that share no joint", found)
    return given[patterns[0]] if patterns else None


def _refuse_unanswered(given: Mapping[str, float], source: ProblemSource, robot: Agent) -> None:
    for key in given:
        if not any(joint == key or fnmatchcase(joint, key) for joint in robot.joints):
            wanted = f"the name of a joint of '{robot.tree.name}' that moves, or a pattern of such names"
            raise InputError(source.path, KEY, wanted, f"'{key}'{nearest_name(key, robot.joints)}")
