"""The robot and the person of a problem file, with every frame and joint they name resolved."""

from __future__ import annotations

from collections.abc import Collection

from evodesign.errors import InputError, nearest_name
from evodesign.problem.file import HandsTable, HumanTable, ProblemFile, SolesTable
from evodesign.records import ProblemSource
from evodesign.statics.contact import SoleSize
from evodesign.statics.scene import HUMAN, ROBOT, SIDES, Agent
from evodesign.tree.anthropometry import Person
from evodesign.tree.human import DEFAULT_JOINTS, HANDS, SOLES, TRUNK, human_tree, sole_size
from evodesign.tree.model import Tree
from evodesign.tree.urdf_read import MassRule, read_urdf

__all__ = ["human_agent", "refuse_unknown", "robot_agent"]


def robot_agent(tables: ProblemFile, source: ProblemSource) -> Agent:
    """The robot of the `[robot]` table."""
    table = tables.robot
    tree = read_urdf(source.files[table.urdf], table.urdf, MassRule.SHAPES)
    return _agent(ROBOT, tree, table.hands, table.soles, table.trunk, table.joints, source)


def human_agent(tables: ProblemFile, source: ProblemSource) -> Agent:
    """The person of the `[human]` table: generated, or read from a URDF."""
    table = tables.human
    if table.urdf is None:
        return _generated(table, source)
    for key in ("stature_m", "mass_kg", "sex"):
        if getattr(table, key) is not None:
            raise InputError(source.path, f"human.{key}", "either urdf or stature, mass and sex", "both")
    if table.hands is None or table.soles is None:
        key = "human.hands" if table.hands is None else "human.soles"
        raise InputError(source.path, key, "the frames of this URDF", "nothing")
    tree = read_urdf(source.files[table.urdf], table.urdf, MassRule.FILE)
    return _agent(HUMAN, tree, table.hands, table.soles, table.trunk, table.joints, source)


def _generated(table: HumanTable, source: ProblemSource) -> Agent:
    figures = {"stature_m": table.stature_m, "mass_kg": table.mass_kg, "sex": table.sex}
    if table.stature_m is None or table.mass_kg is None or table.sex is None:
        missing = next(key for key, value in figures.items() if value is None)
        raise InputError(source.path, f"human.{missing}", "this key, or urdf", "nothing")
    try:
        someone = Person(table.stature_m, table.mass_kg, table.sex)
    except InputError as error:
        raise InputError(source.path, f"human.{error.key}", error.wanted, error.found) from error
    tree = human_tree(someone)
    hands = HandsTable(left=HANDS["left"], right=HANDS["right"])
    soles = SolesTable(left=SOLES["left"], right=SOLES["right"], size_m=sole_size(someone))
    joints = table.joints or DEFAULT_JOINTS
    return _agent(HUMAN, tree, hands, soles, table.trunk or TRUNK, joints, source)


def _agent(
    name: str,
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
        refuse_unknown(source, f"{name}.{key}", "link", frame, tree.link_by_name, tree.name)
    for position, joint in enumerate(joints):
        refuse_unknown(source, f"{name}.joints[{position}]", "moving joint", joint, tree.actuated, tree.name)
    if not (joints or tree.actuated):
        raise InputError(source.path, f"{name}.urdf", "a joint that can move", "none")
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
