"""Largest torques of the robot's joints: the URDF's effort limits, or what the problem file says instead."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from fnmatch import fnmatchcase

from evodesign.errors import InputError, nearest_name
from evodesign.mechanics.agent import Agent
from evodesign.problem.agent_tables import RobotTable, TorqueLimits
from evodesign.problem.file import ProblemFile
from evodesign.records import ProblemSource, Sense

LIMITS = "torque_limits_n_m"

PEAK_TORQUE = "peak_torque"
"""How the names of quantities end that need a limit of every joint."""


def torque_limits(
    key: str, table: RobotTable, driven: Collection[str], source: ProblemSource, robot: Agent
) -> Mapping[str, float]:
    """The largest torque [N m] of each of the robot's moving joints that has a positive, finite one.

    Joints whose actuators a design chooses have none here: what these hold is the design's.

    A key of `[robot.torque_limits_n_m]` is a joint's name, or a pattern such as `*_knee` for all joints that
    it fits; a name counts more than a pattern.

    Args:
        key: of the robot's table, for messages.
        table: the robot's.
        driven: its joints whose actuators a design chooses.
        source: the problem, for messages.
        robot: as it is so far.
    Raises:
        InputError: a key that no joint answers to, or a joint that answers to two patterns; limits that shall
            hold and are not positive, or are not there.
    """
    given, hard = table.torque_limits_n_m, table.torque_limits is TorqueLimits.HARD
    limits_key = f"{key}.{LIMITS}"
    for joint in given.keys() & set(driven):
        found = f"one of '{joint}', which a [[design.actuator]] drives"
        raise InputError(source.path, limits_key, "limits of joints without an actuator", found)
    asked = {
        name: _asked_limit(name, given, source, limits_key) for name in robot.joints if name not in driven
    }
    _refuse_unanswered(given, source, robot, limits_key)
    limits: dict[str, float] = {}
    for name, limit in asked.items():
        effort = robot.tree.joint_by_name[name].effort if limit is None else limit
        if hard and not effort > 0.0:
            wanted = f"a positive effort limit of the joint '{name}', or one in {limits_key}"
            raise InputError(source.path, f"{key}.urdf", wanted, f"{effort:g}")
        if 0.0 < effort < math.inf:
            limits[name] = effort
    if hard and not limits and not driven:
        wanted = f"'none', or a joint with an effort limit in '{table.urdf}' or in {limits_key}"
        raise InputError(source.path, f"{key}.torque_limits", wanted, "'hard' and no limits")
    return limits


def refuse_unlimited(tables: ProblemFile, source: ProblemSource, robot: Agent) -> None:
    """Refuse objectives that take torques relative to their limits where a joint of the robot has none.

    Raises:
        InputError: naming objective and joint.
    """
    asked = tables.objectives
    for sense, names in ((Sense.MINIMISE, asked.minimise), (Sense.MAXIMISE, asked.maximise)):
        for position, name in enumerate(names):
            if name.endswith(PEAK_TORQUE):
                refuse_unlimited_peak(f"objectives.{sense}[{position}]", name, tables, source, robot)


def driven_joints(tables: ProblemFile) -> frozenset[str]:
    """The joints whose actuators a design chooses."""
    return frozenset(joint for table in tables.design.actuator for joint in table.joints)


def refuse_unlimited_peak(
    key: str, name: str, tables: ProblemFile, source: ProblemSource, robot: Agent
) -> None:
    """Refuse a quantity that takes torques relative to their limits where a joint of the robot has none.

    Args:
        key: where the problem file names it.
        name: of the quantity.
        tables: the problem file, whose actuators are limits, too.
        source: the problem, for messages.
        robot: whose joints count.
    Raises:
        InputError: naming quantity and joint.
    """
    driven = driven_joints(tables)
    for joint in robot.joints:
        if joint not in robot.torque_limits and joint not in driven:
            wanted = (
                f"a torque limit of every joint of the robot for '{name}', in its URDF or in robot.{LIMITS}"
            )
            raise InputError(source.path, key, wanted, f"none of '{joint}'")


def _asked_limit(joint: str, given: Mapping[str, float], source: ProblemSource, key: str) -> float | None:
    """The limit that the problem file gives a joint."""
    if joint in given:
        return given[joint]
    patterns = [pattern for pattern in given if fnmatchcase(joint, pattern)]
    if len(patterns) > 1:
        found = f"'{joint}' in '{patterns[0]}' and '{patterns[1]}'"
        raise InputError(source.path, key, "patterns that share no joint", found)
    return given[patterns[0]] if patterns else None


def _refuse_unanswered(given: Mapping[str, float], source: ProblemSource, robot: Agent, key: str) -> None:
    for name in given:
        if not any(joint == name or fnmatchcase(joint, name) for joint in robot.joints):
            wanted = f"the name of a joint of '{robot.tree.name}' that moves, or a pattern of such names"
            raise InputError(source.path, key, wanted, f"'{name}'{nearest_name(name, robot.joints)}")
