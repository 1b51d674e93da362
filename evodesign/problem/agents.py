"""Robot and people of a problem file: frames and joints resolved, populations unfolded, strengths, limits.

A population's table stands for one person per sex and percentile. Limits of the robot's joint torques are the
URDF's effort limits, or what the problem file says instead.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from fnmatch import fnmatchcase

import msgspec

from evodesign.body.placement import Placement
from evodesign.errors import InputError, nearest_name
from evodesign.human.anthropometry import Person
from evodesign.human.body import DEFAULT_JOINTS, HANDS, SOLES, TRUNK, human_tree, sole_size
from evodesign.human.population import population
from evodesign.human.strength import joint_strengths, with_given
from evodesign.mechanics.contact import SoleSize
from evodesign.mechanics.scene import HUMAN, ROBOT, SIDES, Agent
from evodesign.problem.file import FrameTable, HandsTable, HumanTable, ProblemFile, SolesTable, TorqueLimits
from evodesign.records import ProblemSource, Sense
from evodesign.tree.model import Joint, JointKind, Link, Tree
from evodesign.tree.urdf_read import MassRule, read_urdf

__all__ = [
    "PEAK_TORQUE",
    "everyone",
    "human_agents",
    "refuse_unknown",
    "refuse_unlimited",
    "refuse_unlimited_peak",
    "refuse_unrated",
    "robot_agent",
    "torque_limits",
]


def robot_agent(tables: ProblemFile, source: ProblemSource) -> Agent:
    """The robot of the `[robot]` table."""
    table = tables.robot
    bare = read_urdf(source.files[table.urdf], table.urdf, MassRule.SHAPES)
    tree = _with_frames(bare, table.frames, ROBOT, source)
    agent = _agent(ROBOT, ROBOT, tree, table.hands, table.soles, table.trunk, table.joints, source)
    hard = table.torque_limits is TorqueLimits.HARD
    return replace(agent, torque_limits=torque_limits(tables, source, agent), limits_torques=hard)


def human_agents(tables: ProblemFile, source: ProblemSource) -> tuple[Agent, ...]:
    """The people of the `human` tables; where there are several, each has a label of its own."""
    entries = everyone(tables, source)
    people = [_human(key, table, source) for key, table in entries]
    if len(people) == 1:
        return tuple(people)
    labels: list[str] = []
    for (key, table), person in zip(entries, people, strict=True):
        label = table.name or _description(table, person)
        if label in labels:
            raise InputError(source.path, f"{key}.name", "a name of its own", f"'{label}' twice")
        labels.append(label)
    return tuple(replace(person, label=label) for person, label in zip(people, labels, strict=True))


def _description(table: HumanTable, person: Agent) -> str:
    """What a person without a name is called."""
    if table.urdf is not None:
        return person.tree.name
    return f"{table.sex} {table.stature_m:g} m {table.mass_kg:g} kg"


def _human(key: str, table: HumanTable, source: ProblemSource) -> Agent:
    """A person: generated, or read from a URDF; strengths in the table go before published ones."""
    person = _of_table(key, table, source)
    for joint in table.strengths_n_m:
        refuse_unknown(
            source, f"{key}.strengths_n_m", "moving joint", joint, person.tree.actuated, person.tree.name
        )
    return replace(person, strengths=with_given(person.strengths, table.strengths_n_m))


def _of_table(key: str, table: HumanTable, source: ProblemSource) -> Agent:
    if table.urdf is None:
        return _generated(key, table, source)
    for figure in ("stature_m", "mass_kg", "sex"):
        if getattr(table, figure) is not None:
            raise InputError(source.path, f"{key}.{figure}", "either urdf or stature, mass and sex", "both")
    if table.hands is None or table.soles is None:
        lacking = "hands" if table.hands is None else "soles"
        raise InputError(source.path, f"{key}.{lacking}", "the frames of this URDF", "nothing")
    bare = read_urdf(source.files[table.urdf], table.urdf, MassRule.FILE)
    tree = _with_frames(bare, table.frames, key, source)
    return _agent(HUMAN, key, tree, table.hands, table.soles, table.trunk, table.joints, source)


def _generated(key: str, table: HumanTable, source: ProblemSource) -> Agent:
    figures = {"stature_m": table.stature_m, "mass_kg": table.mass_kg, "sex": table.sex}
    if table.stature_m is None or table.mass_kg is None or table.sex is None:
        missing = next(figure for figure, value in figures.items() if value is None)
        raise InputError(source.path, f"{key}.{missing}", "this key, or urdf", "nothing")
    try:
        someone = Person(table.stature_m, table.mass_kg, table.sex)
    except InputError as error:
        raise InputError(source.path, f"{key}.{error.key}", error.wanted, error.found) from error
    tree = _with_frames(human_tree(someone), table.frames, key, source)
    hands = HandsTable(left=HANDS["left"], right=HANDS["right"])
    soles = SolesTable(left=SOLES["left"], right=SOLES["right"], size_m=sole_size(someone))
    joints = table.joints or DEFAULT_JOINTS
    agent = _agent(HUMAN, key, tree, hands, soles, table.trunk or TRUNK, joints, source)
    return replace(agent, strengths=joint_strengths(someone))


def _with_frames(tree: Tree, frames: tuple[FrameTable, ...], table: str, source: ProblemSource) -> Tree:
    """The tree with the frames that the problem file adds, each fixed to a link."""
    for position, frame in enumerate(frames):
        key = f"{table}.frames[{position}]"
        refuse_unknown(source, f"{key}.link", "link", frame.link, tree.link_by_name, tree.name)
        if frame.name in tree.link_by_name:
            raise InputError(source.path, f"{key}.name", "a new name", f"'{frame.name}' of '{tree.name}'")
        place = Placement.from_xyz_rpy(frame.xyz_m, frame.rpy_rad)
        joint = Joint(f"{frame.name}_fixed_joint", JointKind.FIXED, frame.link, frame.name, place)
        tree = Tree(tree.name, (*tree.links, Link(frame.name)), (*tree.joints, joint))
    return tree


def _agent(
    name: str,
    table: str,
    tree: Tree,
    hands: HandsTable,
    soles: SolesTable,
    trunk: tuple[str, ...],
    joints: tuple[str, ...],
    source: ProblemSource,
) -> Agent:
    frames = {
        **{f"hands.{side}": getattr(hands, side) for side in SIDES},
        **{f"soles.{side}": getattr(soles, side) for side in SIDES},
        **{f"trunk[{i}]": frame for i, frame in enumerate(trunk)},
    }
    for key, frame in frames.items():
        refuse_unknown(source, f"{table}.{key}", "link", frame, tree.link_by_name, tree.name)
    for position, joint in enumerate(joints):
        refuse_unknown(source, f"{table}.joints[{position}]", "moving joint", joint, tree.actuated, tree.name)
    if not (joints or tree.actuated):
        raise InputError(source.path, f"{table}.urdf", "a joint that can move", "none")
    return Agent(
        name=name,
        tree=tree,
        joints=joints or tree.actuated,
        hands={side: getattr(hands, side) for side in SIDES},
        soles={side: getattr(soles, side) for side in SIDES},
        sole_size=SoleSize(*soles.size_m),
        trunk=trunk,
    )


def refuse_unknown(
    source: ProblemSource, key: str, noun: str, name: str, known: Collection[str], where: str
) -> None:
    """Refuse a name that is not among the known ones.

    Args:
        source: the problem, for messages.
        key: where in it the name stands.
        noun: what is named, such as `link`.
        name: as written.
        known: all that would do.
        where: the model that holds them.
    Raises:
        InputError: naming the nearest known one.
    """
    if name not in known:
        hint = nearest_name(name, known)
        raise InputError(source.path, key, f"the name of a {noun} of '{where}'", f"'{name}'{hint}")


OF_ONE = ("stature_m", "mass_kg", "sex", "urdf")
"""Keys that describe one person and so do not go with a population."""


def everyone(tables: ProblemFile, source: ProblemSource) -> list[tuple[str, HumanTable]]:
    """A table for each person, with its key for messages, in the file's order.

    Raises:
        InputError: a population that cannot be, or one that is also a single person.
    """
    return [one for key, table in tables.people.items() for one in _members(key, table, source)]


def _members(key: str, table: HumanTable, source: ProblemSource) -> list[tuple[str, HumanTable]]:
    if table.population is None:
        return [(key, table)]
    for other in OF_ONE:
        if getattr(table, other) is not None:
            raise InputError(source.path, f"{key}.{other}", "either this key or population", "both")
    try:
        people = population(table.population.sex, table.population.percentiles)
    except InputError as error:
        raise InputError(source.path, f"{key}.{error.key}", error.wanted, error.found) from error
    group = f"{table.name} " if table.name else ""
    return [
        (
            key,
            msgspec.structs.replace(
                table,
                population=None,
                name=group + name,
                stature_m=person.stature,
                mass_kg=person.mass,
                sex=person.sex,
            ),
        )
        for name, person in people.items()
    ]


def refuse_unrated(key: str, name: str, source: ProblemSource, people: Sequence[Agent]) -> None:
    """Refuse a quantity that needs strengths where a person has none.

    Args:
        key: where the problem file names it.
        name: of the quantity.
        source: the problem, for messages.
        people: all that the problem has.
    Raises:
        InputError: none of a person's moving joints has a strength.
    """
    for person in people:
        if not any(joint in person.strengths for joint in person.joints):
            wanted = "people of known strength (stature_m, mass_kg and sex, or strengths_n_m)"
            found = f"'{name}' with a person '{person.tree.name}' of unknown strength"
            raise InputError(source.path, key, wanted, found)


LIMITS_KEY = "robot.torque_limits_n_m"

PEAK_TORQUE = "peak_torque"
"""How the names of quantities end that need a limit of every joint."""


def torque_limits(tables: ProblemFile, source: ProblemSource, robot: Agent) -> Mapping[str, float]:
    """The largest torque [N m] of each of the robot's moving joints that has a positive, finite one.

    A key of `[robot.torque_limits_n_m]` is a joint's name, or a pattern such as `*_knee` for all joints that
    it fits; a name counts more than a pattern.

    Raises:
        InputError: a key that no joint answers to, or a joint that answers to two patterns; limits that shall
            hold and are not positive, or are not there.
    """
    given, hard = tables.robot.torque_limits_n_m, tables.robot.torque_limits is TorqueLimits.HARD
    asked = {name: _asked_limit(name, given, source) for name in robot.joints}
    _refuse_unanswered(given, source, robot)
    limits: dict[str, float] = {}
    for name, limit in asked.items():
        effort = robot.tree.joint_by_name[name].effort if limit is None else limit
        if hard and not effort > 0.0:
            wanted = f"a positive effort limit of the joint '{name}', or one in {LIMITS_KEY}"
            raise InputError(source.path, "robot.urdf", wanted, f"{effort:g}")
        if 0.0 < effort < math.inf:
            limits[name] = effort
    if hard and not limits:
        wanted = f"'none', or a joint with an effort limit in '{tables.robot.urdf}' or in {LIMITS_KEY}"
        raise InputError(source.path, "robot.torque_limits", wanted, "'hard' and no limits")
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
                refuse_unlimited_peak(f"objectives.{sense}[{position}]", name, source, robot)


def refuse_unlimited_peak(key: str, name: str, source: ProblemSource, robot: Agent) -> None:
    """Refuse a quantity that takes torques relative to their limits where a joint of the robot has none.

    Args:
        key: where the problem file names it.
        name: of the quantity.
        source: the problem, for messages.
        robot: whose joints count.
    Raises:
        InputError: naming quantity and joint.
    """
    for joint in robot.joints:
        if joint not in robot.torque_limits:
            wanted = (
                f"a torque limit of every joint of the robot for '{name}', in its URDF or in {LIMITS_KEY}"
            )
            raise InputError(source.path, key, wanted, f"none of '{joint}'")


def _asked_limit(joint: str, given: Mapping[str, float], source: ProblemSource) -> float | None:
    """The limit that the problem file gives a joint."""
    if joint in given:
        return given[joint]
    patterns = [pattern for pattern in given if fnmatchcase(joint, pattern)]
    if len(patterns) > 1:
        found = f"'{joint}' in '{patterns[0]}' and '{patterns[1]}'"
        raise InputError(source.path, LIMITS_KEY, "patterns that share no joint", found)
    return given[patterns[0]] if patterns else None


def _refuse_unanswered(given: Mapping[str, float], source: ProblemSource, robot: Agent) -> None:
    for key in given:
        if not any(joint == key or fnmatchcase(joint, key) for joint in robot.joints):
            wanted = f"the name of a joint of '{robot.tree.name}' that moves, or a pattern of such names"
            raise InputError(source.path, LIMITS_KEY, wanted, f"'{key}'{nearest_name(key, robot.joints)}")
