"""Load cases of a problem file in which the robot stands alone: its posture, what it holds, what pushes it.

A payload is its weight on the hands that hold it, in equal parts; a push is a level force. Joints that an
actuator drives count, whether they move in the lift or not.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from evodesign.body.placement import Vector
from evodesign.errors import InputError
from evodesign.mechanics.agent import Agent
from evodesign.mechanics.balance import GRAVITY
from evodesign.mechanics.stance_case import RaisedHand, StanceCase
from evodesign.problem.design_table import Feet, Hands, HoldTable, LoadCaseTable, Pushed, PushTable
from evodesign.problem.file import ProblemFile
from evodesign.problem.torque_limits import driven_joints
from evodesign.problem.unknown_names import refuse_unknown
from evodesign.records import ProblemSource


def standing_cases(
    tables: ProblemFile, source: ProblemSource, robots: Sequence[Agent]
) -> tuple[StanceCase, ...]:
    """The postures in which a robot stands alone.

    Args:
        tables: the problem file.
        source: the problem, for messages.
        robots: those that designs change, who are all alike.
    Raises:
        InputError: a name twice, a joint that neither moves nor is driven or is beyond its limits, other than
            one group of joints to balance on both feet and two on one, a height without joints that raise
            the hand, or joints without a height, a fall beside a push or without walls.
    """
    if not robots:
        if tables.load_case:
            raise InputError(source.path, "load_case", "a [robot] that stands so", "people alone")
        return ()
    robot, driven = robots[0], driven_joints(tables)
    joints = [name for name in robot.tree.actuated if name in driven or name in robot.joints]
    found: list[StanceCase] = []
    for position, table in enumerate(tables.load_case):
        key = f"load_case[{position}]"
        if table.name in {case.name for case in found}:
            raise InputError(source.path, f"{key}.name", "a unique name", f"'{table.name}' twice")
        walls = bool(tables.design.wall)
        found.append(_case(table, key, source, robot, joints, tables.limits.friction, walls))
    return tuple(found)


def _case(
    table: LoadCaseTable,
    key: str,
    source: ProblemSource,
    robot: Agent,
    joints: Sequence[str],
    friction: float,
    walls: bool,
) -> StanceCase:
    for joint, angle in table.joints_deg.items():
        where = f"{key}.joints_deg.{joint}"
        refuse_unknown(source, where, "moving joint", joint, joints, robot.tree.name)
        lower, upper = _limits(robot, joint)
        if not lower <= math.radians(angle) <= upper:
            wanted = f"{math.degrees(lower):g} to {math.degrees(upper):g} degrees"
            raise InputError(source.path, where, wanted, f"{angle:g}")
    for joint in (joint for group in table.balance for joint in group):
        refuse_unknown(source, f"{key}.balance", "moving joint", joint, joints, robot.tree.name)
    groups = 1 if table.feet is Feet.BOTH else 2
    if len(table.balance) != groups:
        plural = "s" if groups > 1 else ""
        wanted = f"{groups} group{plural} of joints to balance with feet = '{table.feet}'"
        raise InputError(source.path, f"{key}.balance", wanted, f"{len(table.balance)}")
    dropped = _dropped(table, key, source, walls)
    return StanceCase(
        name=table.name,
        joints={joint: math.radians(angle) for joint, angle in table.joints_deg.items()},
        soles=tuple(foot.frame for foot in robot.feet if table.feet in (Feet.BOTH, foot.side)),
        balance=table.balance,
        factor=table.factor,
        loads=(*_held(table.hold, robot), *_pushed(table.push, robot)),
        friction=friction,
        raised=_raised(table, f"{key}.hold", source, robot, joints),
        dropped=dropped,
    )


def _dropped(table: LoadCaseTable, key: str, source: ProblemSource, walls: bool) -> float:
    """The height of a fall [m]; zero of none."""
    if table.dropped_from_m is None:
        return 0.0
    where = f"{key}.dropped_from_m"
    if not walls:
        raise InputError(source.path, where, "a [[design.wall]], whose links must withstand the fall", "none")
    if table.push is not None:
        raise InputError(source.path, where, "a fall or a push", "both")
    return table.dropped_from_m


def _limits(robot: Agent, joint: str) -> tuple[float, float]:
    found = robot.tree.joint_by_name[joint]
    return float(found.lower), float(found.upper)


def _held(hold: HoldTable | None, robot: Agent) -> Iterator[tuple[str, Vector]]:
    """The weight of a payload on each hand that holds it."""
    if hold is None:
        return
    frames = _hands(hold.hand, robot)
    for frame in frames:
        yield frame, (0.0, 0.0, -GRAVITY * hold.mass_kg / len(frames))


def _hands(hand: Hands, robot: Agent) -> list[str]:
    return [each.frame for each in robot.hands if hand in (Hands.BOTH, each.side)]


def _pushed(push: PushTable | None, robot: Agent) -> Iterator[tuple[str, Vector]]:
    """The force of a push on each frame that it meets."""
    if push is None:
        return
    if push.at is Pushed.TRUNK:
        frames = [robot.pushed_frame]
    else:
        frames = _hands(Hands.BOTH if push.at is Pushed.HANDS else Hands(push.at), robot)
    angle, force = math.radians(push.direction_deg), push.force_n / len(frames)
    for frame in frames:
        yield frame, (force * math.cos(angle), force * math.sin(angle), 0.0)


def _raised(
    table: LoadCaseTable, key: str, source: ProblemSource, robot: Agent, joints: Sequence[str]
) -> RaisedHand | None:
    hold = table.hold
    if hold is None or (hold.height_m is None and not hold.raised_by):
        return None
    if hold.height_m is None:
        raise InputError(source.path, f"{key}.height_m", "a height to which joints raise the hand", "none")
    if not hold.raised_by:
        raise InputError(source.path, f"{key}.raised_by", "joints that raise the hand to height_m", "none")
    for joint in hold.raised_by:
        refuse_unknown(source, f"{key}.raised_by", "moving joint", joint, joints, robot.tree.name)
        if any(joint in group for group in table.balance):
            wanted = "joints that do not balance the robot"
            raise InputError(source.path, f"{key}.raised_by", wanted, f"'{joint}', which is in balance")
    limits = tuple(_limits(robot, joint) for joint in hold.raised_by)
    return RaisedHand(_hands(hold.hand, robot)[0], hold.height_m, hold.raised_by, limits)
