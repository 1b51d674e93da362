"""The robot and the person of a problem file, with every frame and joint they name resolved."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

from evodesign.body.placement import Placement
from evodesign.errors import InputError, nearest_name
from evodesign.human.anthropometry import Person
from evodesign.human.body import DEFAULT_JOINTS, HANDS, SOLES, TRUNK, human_tree, sole_size
from evodesign.human.strength import joint_strengths, with_given
from evodesign.mechanics.contact import SoleSize
from evodesign.mechanics.scene import HUMAN, ROBOT, SIDES, Agent
from evodesign.problem.file import FrameTable, HandsTable, HumanTable, ProblemFile, SolesTable, TorqueLimits
from evodesign.problem.people import everyone
from evodesign.problem.torque_limits import torque_limits
from evodesign.records import ProblemSource
from evodesign.tree.model import Joint, JointKind, Link, Tree
from evodesign.tree.urdf_read import MassRule, read_urdf

__all__ = ["human_agents", "refuse_unknown", "robot_agent"]


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
        label = table.name or _told(table, person)
        if label in labels:
            raise InputError(source.path, f"{key}.name", "a name of its own", f"'{label}' twice")
        labels.append(label)
    return tuple(replace(person, label=label) for person, label in zip(people, labels, strict=True))


def _told(table: HumanTable, person: Agent) -> str:
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
