"""Joints and sections of links as design parameters: where and how joints turn, how thick links are."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

from evodesign.design.parameter import DesignParameter, ParameterKind
from evodesign.design.space import DesignSpace
from evodesign.errors import InputError, ModelError
from evodesign.mechanics.agent import Agent
from evodesign.problem.agent_tables import RobotTable
from evodesign.problem.design_table import JointTable
from evodesign.problem.file import ProblemFile
from evodesign.problem.unknown_names import refuse_unknown
from evodesign.records import ProblemSource
from evodesign.tree.joint_changes import JointQuantity, pair_of_changes, widest_ranges
from evodesign.tree.model import JointKind, Tree
from evodesign.tree.sections import section_of
from evodesign.tree.symmetry import mirror_of

DEGREE = math.pi / 180.0

LARGEST_TILT, LARGEST_LIMIT = 80.0, 360.0
"""By how many degrees an axis may turn to either side, and how far a joint."""

LARGEST_OFFSET = 0.5
"""By how many metres a joint may move to either side."""

AXES = {JointQuantity.OFFSET: "along", JointQuantity.TILT: "about"}


def joint_parameters(tables: ProblemFile, source: ProblemSource, tree: Tree) -> list[DesignParameter]:
    """The parameters of the `[[design.joint]]` tables.

    Raises:
        InputError: an unknown joint, nothing that changes, bounds that do not rise or leave out the file's
            robot, an axis without its bounds or the reverse, two parameters that change one thing of a joint.
    """
    found: list[DesignParameter] = []
    seen: dict[tuple[str, JointQuantity], str] = {}
    for position, table in enumerate(tables.design.joint):
        key = f"design.joint[{position}]"
        if table.name in {other.name for other in tables.design.joint[:position]}:
            raise InputError(source.path, f"{key}.name", "a unique name", f"'{table.name}' twice")
        for place, joint in enumerate(table.joints):
            refuse_unknown(source, f"{key}.joints[{place}]", "moving joint", joint, tree.actuated, tree.name)
            if joint in table.joints[:place]:
                raise InputError(source.path, f"{key}.joints[{place}]", "another joint", f"'{joint}' twice")
        _refuse_no_pair(table, f"{key}.joints[1]", source, tree)
        _refuse_still(table, key, source, tables.designed)
        own = [*_of_table(table, key, source, tree)]
        if not own:
            wanted = "offset_m, tilt_deg, lower_deg or upper_deg"
            raise InputError(source.path, key, wanted, "none")
        for parameter in own:
            for change in parameter.changes:
                if (change.joint, change.quantity) in seen:
                    wanted = f"one parameter for the {change.quantity} of '{change.joint}'"
                    raise InputError(source.path, key, wanted, f"also {seen[change.joint, change.quantity]}")
                seen[change.joint, change.quantity] = parameter.name
        found += own
    return found


def _of_table(table: JointTable, key: str, source: ProblemSource, tree: Tree) -> Iterator[DesignParameter]:
    given: Mapping[JointQuantity, tuple[str, tuple[float, float] | None, float]] = {
        JointQuantity.OFFSET: ("offset_m", table.offset_m, 1.0),
        JointQuantity.TILT: ("tilt_deg", table.tilt_deg, DEGREE),
        JointQuantity.LOWER: ("lower_deg", table.lower_deg, DEGREE),
        JointQuantity.UPPER: ("upper_deg", table.upper_deg, DEGREE),
    }
    for quantity, (name, bounds, unit) in given.items():
        axis = getattr(table, AXES[quantity]) if quantity in AXES else None
        if bounds is None:
            if axis is not None:
                raise InputError(source.path, f"{key}.{AXES[quantity]}", f"{name} with it", "none")
            continue
        if quantity in AXES and axis is None:
            raise InputError(source.path, f"{key}.{AXES[quantity]}", f"an axis, as {name} is given", "none")
        where = f"{key}.{name}"
        if bounds[0] >= bounds[1]:
            raise InputError(source.path, where, "a rising pair", f"[{bounds[0]:g}, {bounds[1]:g}]")
        largest = {JointQuantity.TILT: LARGEST_TILT, JointQuantity.OFFSET: LARGEST_OFFSET}
        most, word = largest.get(quantity, LARGEST_LIMIT), "m" if name.endswith("_m") else "degrees"
        if max(map(abs, bounds)) > most:
            wanted = f"at most {most:g} {word} to either side"
            raise InputError(source.path, where, wanted, f"[{bounds[0]:g}, {bounds[1]:g}]")
        _refuse_wrong_limit(table, quantity, where, source, tree)
        try:
            changes = pair_of_changes(tree, table.joints, quantity, axis or (0.0, 0.0, 0.0))
        except ModelError as error:
            raise InputError(source.path, where, error.wanted, error.found) from error
        lower, upper = (unit * bound for bound in bounds)
        yield DesignParameter(ParameterKind(quantity.value), table.name, (), lower, upper, changes=changes)


def _refuse_no_pair(table: JointTable, key: str, source: ProblemSource, tree: Tree) -> None:
    """Refuse two joints of a symmetric robot that are not each other's mirror images."""
    try:
        partners = mirror_of(tree).joints
    except ModelError:
        return
    for first, other in zip(table.joints[:1], table.joints[1:], strict=False):
        if partners[first] != other:
            wanted = f"the mirror image of '{first}', '{partners[first]}'"
            raise InputError(source.path, key, wanted, f"'{other}'")


def _refuse_still(table: JointTable, key: str, source: ProblemSource, robot: RobotTable | None) -> None:
    """Refuse limits of joints that stand at zero in all postures."""
    moving = () if robot is None else robot.joints
    if table.lower_deg is None and table.upper_deg is None:
        return
    for place, joint in enumerate(table.joints):
        if moving and joint not in moving:
            wanted = "a joint that moves in postures, as its limits are asked for"
            raise InputError(source.path, f"{key}.joints[{place}]", wanted, f"'{joint}'")


def _refuse_wrong_limit(
    table: JointTable, quantity: JointQuantity, where: str, source: ProblemSource, tree: Tree
) -> None:
    """Refuse limits of joints without any, and lower limits that may be above upper ones."""
    if quantity not in (JointQuantity.LOWER, JointQuantity.UPPER):
        return
    for name in table.joints:
        kind = tree.joint_by_name[name].kind
        if kind is not JointKind.REVOLUTE:
            raise InputError(source.path, where, "a joint that turns between limits", f"'{name}', {kind}")
    joint = tree.joint_by_name[table.joints[0]]
    most = joint.lower if table.lower_deg is None else DEGREE * table.lower_deg[1]
    least = joint.upper if table.upper_deg is None else DEGREE * table.upper_deg[0]
    if most >= least:
        wanted = "limits between which the joint turns in every design"
        found = f"a lower one to {most / DEGREE:g} and an upper one from {least / DEGREE:g} degrees"
        raise InputError(source.path, where, wanted, found)


def section_parameters(tables: ProblemFile, source: ProblemSource, tree: Tree) -> list[DesignParameter]:
    """The parameters of the `[[design.section]]` tables.

    Raises:
        InputError: a link that has no section, or not along the axis that is named.
    """
    found = []
    for position, table in enumerate(tables.design.section):
        key = f"design.section[{position}]"
        for place, link in enumerate(table.links):
            refuse_unknown(source, f"{key}.links[{place}]", "link", link, tree.link_by_name, tree.name)
        try:
            sections = tuple(section_of(tree, link, table.across) for link in table.links)
        except ModelError as error:
            where = f"{key}.across" if table.across is not None else f"{key}.links"
            raise InputError(source.path, where, error.wanted, f"{error.found} ({error.key})") from error
        found.append(
            DesignParameter(
                ParameterKind.SECTION, table.name, table.links, table.lower, table.upper, sections=sections
            )
        )
    return found


def joint_ranges_of(
    space: DesignSpace, robot: Agent, source: ProblemSource
) -> Mapping[str, tuple[float, float]]:
    """The widest limits [rad] of joints whose limits a design chooses, by name.

    Raises:
        InputError: a joint that stays bent in postures, whose least angle is fixed.
    """
    limits = (ParameterKind.LOWER, ParameterKind.UPPER)
    chosen: Sequence[DesignParameter] = [each for each in space.parameters if each.kind in limits]
    for parameter in chosen:
        for change in parameter.changes:
            if change.joint in robot.bent_ranges:
                wanted = "a joint that no least flexion keeps bent"
                raise InputError(source.path, f"design.joint ({parameter.name})", wanted, f"'{change.joint}'")
    bounds = ((change, each.lower, each.upper) for each in chosen for change in each.changes)
    return widest_ranges(robot.tree, bounds)
