"""Robot and people of a problem file: frames and joints resolved, populations unfolded, strengths.

A population's table stands for one person per sex and percentile.

Beyond 300 lines: one function for each table of an agent.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import replace

import msgspec

from evodesign.body.placement import Placement, transpose
from evodesign.errors import InputError
from evodesign.human.anthropometry import Person, sole_size
from evodesign.human.anthropometry_tables import ShoulderWidth
from evodesign.human.body import DEFAULT_JOINTS, HANDS, SOLES, TRUNK, human_tree
from evodesign.human.population import population
from evodesign.human.strength import joint_strengths, with_given
from evodesign.mechanics.agent import (
    BASE,
    HUMAN,
    ROBOT,
    SIDES,
    Agent,
    Contact,
    Gaze,
    Role,
    Touched,
    two_hands_two_feet,
)
from evodesign.mechanics.contact import SoleSize
from evodesign.problem.agent_tables import (
    BaseTable,
    Facing,
    FrameTable,
    HandsTable,
    HumanTable,
    RobotTable,
    SolesTable,
    TorqueLimits,
)
from evodesign.problem.file import ProblemFile
from evodesign.problem.flexion import bent_ranges
from evodesign.problem.meshes import with_surfaces
from evodesign.problem.person_posture import HEAD, with_posture
from evodesign.problem.stance_limits import stance_of
from evodesign.problem.torque_limits import driven_joints, torque_limits
from evodesign.problem.unknown_names import refuse_unknown
from evodesign.records import ProblemSource
from evodesign.tree.model import Joint, JointKind, Link, Tree
from evodesign.tree.urdf_read import InertiaRule, read_urdf


def robot_agents(tables: ProblemFile, source: ProblemSource) -> tuple[Agent, ...]:
    """The robots of the `robot` tables, those that a design changes first."""
    robots: list[Agent] = []
    for key, table in tables.robots.items():
        designed = table is tables.designed
        robot = _robot(key, table, driven_joints(tables) if designed else (), source)
        for side in table.sides:
            name = f"{ROBOT}_{len(robots) + 1}" if robots else ROBOT
            robots.append(replace(robot, name=name, quarters=side.quarters, as_drawn=not designed))
    return tuple(robots)


def _robot(key: str, table: RobotTable, driven: Collection[str], source: ProblemSource) -> Agent:
    bare = read_urdf(source.files[table.urdf], table.urdf, table.inertia)
    seen = with_surfaces(bare, source.files, source.path) if table.meshes else bare
    tree = _with_frames(_turned(seen, table.facing), table.frames, key, source)
    if table.base is None:
        standing = _feet(key, tree, table.soles or SolesTable(), source)
    else:
        standing = _on_wheels(key, table, tree, table.base, source)
    contacts = (*standing, *_hands(key, tree, table.hands, source))
    agent = _agent(Role.ROBOT, key, tree, contacts, table.trunk, table.joints, source)
    hard = table.torque_limits is TorqueLimits.HARD
    limits = torque_limits(key, table, driven, source, agent)
    bent = _bent(key, agent, table, source)
    return replace(agent, torque_limits=limits, limits_torques=hard, bent_ranges=bent)


def _on_wheels(
    key: str, table: RobotTable, tree: Tree, base: BaseTable, source: ProblemSource
) -> tuple[Contact, ...]:
    """The contact of a robot without feet."""
    for other in ("soles", "knee_flexion_deg"):
        if getattr(table, other) is not None:
            raise InputError(source.path, f"{key}.{other}", "either this key or base", "both")
    refuse_unknown(source, f"{key}.base.frame", "link", base.frame, tree.link_by_name, tree.name)
    return (Contact(BASE, Touched.GROUND, base.frame, patch=SoleSize(*base.size_m)),)


def _feet(key: str, tree: Tree, soles: SolesTable, source: ProblemSource) -> tuple[Contact, ...]:
    for side in SIDES:
        frame = getattr(soles, side)
        refuse_unknown(source, f"{key}.soles.{side}", "link", frame, tree.link_by_name, tree.name)
    size = SoleSize(*soles.size_m)
    return tuple(Contact(f"{side}_foot", Touched.GROUND, getattr(soles, side), side, size) for side in SIDES)


def _hands(key: str, tree: Tree, hands: HandsTable, source: ProblemSource) -> tuple[Contact, ...]:
    frames = {side: getattr(hands, side) for side in SIDES if getattr(hands, side) is not None}
    if not frames:
        raise InputError(source.path, f"{key}.hands", "left, right, or both", "neither")
    for side, frame in frames.items():
        refuse_unknown(source, f"{key}.hands.{side}", "link", frame, tree.link_by_name, tree.name)
    return tuple(Contact(f"{side}_hand", Touched.LOAD, frame, side) for side, frame in frames.items())


def _bent(
    key: str, agent: Agent, table: RobotTable, source: ProblemSource
) -> Mapping[str, tuple[float, float]]:
    """Ranges of knees and elbows that stay bent."""
    asked = {
        "knee_flexion_deg": (table.knee_flexion_deg, agent.feet),
        "elbow_flexion_deg": (table.elbow_flexion_deg, agent.hands),
    }
    found: dict[str, tuple[float, float]] = {}
    for name, (least, ends) in asked.items():
        if least is not None:
            found |= bent_ranges(agent, ends, math.radians(least), f"{key}.{name}", source)
    return found


def _turned(tree: Tree, facing: Facing) -> Tree:
    """The tree below a new root that looks along +x; as it is where it does so already."""
    if facing is Facing.FORWARD:
        return tree
    root = f"{tree.root}_facing_x"
    while root in tree.link_by_name:
        root += "_"
    place = Placement(transpose(facing.axes))
    joint = Joint(f"{root}_fixed_joint", JointKind.FIXED, root, tree.root, place)
    return replace(tree, links=(Link(root), *tree.links), joints=(joint, *tree.joints))


def human_agents(tables: ProblemFile, source: ProblemSource) -> tuple[Agent, ...]:
    """The people of the `human` tables; where there are several, each has a label of its own.

    Those at one side have one name.
    """
    entries = everyone(tables, source)
    people = [_human(key, table, source) for key, table in entries]
    sides = [*dict.fromkeys(table.side for _, table in entries)]
    names = {side: f"{HUMAN}_{place + 1}" if place else HUMAN for place, side in enumerate(sides)}
    people = [
        replace(person, name=names[table.side], quarters=table.side.quarters)
        for person, (_, table) in zip(people, entries, strict=True)
    ]
    people = [
        person if table.urdf else replace(person, stance=stance_of(tables, source, person))
        for person, (_, table) in zip(people, entries, strict=True)
    ]
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
    rated = replace(person, strengths=with_given(person.strengths, table.strengths_n_m))
    if table.gaze_cone_deg is not None:
        rated = replace(rated, gaze=_gaze(key, math.radians(table.gaze_cone_deg), rated, source))
    return with_posture(key, table, rated, source)


def _gaze(key: str, cone: float, person: Agent, source: ProblemSource) -> Gaze:
    """From the middle of the head."""
    head = person.tree.link_by_name.get(HEAD)
    if head is None:
        wanted = f"a person with a link '{HEAD}' that looks along its x, as the generated one has"
        found = f"{math.degrees(cone):g} for '{person.tree.name}'"
        raise InputError(source.path, f"{key}.gaze_cone_deg", wanted, found)
    return Gaze(HEAD, head.inertia.center, cone)


def _of_table(key: str, table: HumanTable, source: ProblemSource) -> Agent:
    if table.urdf is None:
        return _generated(key, table, source)
    for figure in ("stature_m", "mass_kg", "sex", "shoulder_width"):
        if getattr(table, figure) is not None:
            raise InputError(source.path, f"{key}.{figure}", "either urdf or stature, mass and sex", "both")
    if table.hands is None or table.soles is None:
        lacking = "hands" if table.hands is None else "soles"
        raise InputError(source.path, f"{key}.{lacking}", "the frames of this URDF", "nothing")
    bare = read_urdf(source.files[table.urdf], table.urdf, InertiaRule.FILE)
    tree = _with_frames(bare, table.frames, key, source)
    contacts = (*_feet(key, tree, table.soles, source), *_hands(key, tree, table.hands, source))
    return _agent(Role.PERSON, key, tree, contacts, table.trunk, table.joints, source)


def _generated(key: str, table: HumanTable, source: ProblemSource) -> Agent:
    for part in ("hands", "soles"):
        if getattr(table, part) is not None:
            wanted = "this key with urdf; a generated person has hands and soles of its own"
            raise InputError(source.path, f"{key}.{part}", wanted, "frames")
    figures = {"stature_m": table.stature_m, "mass_kg": table.mass_kg, "sex": table.sex}
    if table.stature_m is None or table.mass_kg is None or table.sex is None:
        missing = next(figure for figure, value in figures.items() if value is None)
        raise InputError(source.path, f"{key}.{missing}", "this key, or urdf", "nothing")
    try:
        width = table.shoulder_width or ShoulderWidth.DRILLIS_CONTINI
        someone = Person(table.stature_m, table.mass_kg, table.sex, width)
    except InputError as error:
        raise InputError(source.path, f"{key}.{error.key}", error.wanted, error.found) from error
    tree = _with_frames(human_tree(someone), table.frames, key, source)
    contacts = two_hands_two_feet(HANDS, SOLES, SoleSize(*sole_size(someone)))
    joints = table.joints or DEFAULT_JOINTS
    agent = _agent(Role.PERSON, key, tree, contacts, table.trunk or TRUNK, joints, source)
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
        tree = replace(tree, links=(*tree.links, Link(frame.name)), joints=(*tree.joints, joint))
    return tree


def _agent(
    role: Role,
    table: str,
    tree: Tree,
    contacts: tuple[Contact, ...],
    trunk: tuple[str, ...],
    joints: tuple[str, ...],
    source: ProblemSource,
) -> Agent:
    for position, frame in enumerate(trunk):
        refuse_unknown(source, f"{table}.trunk[{position}]", "link", frame, tree.link_by_name, tree.name)
    for position, joint in enumerate(joints):
        refuse_unknown(source, f"{table}.joints[{position}]", "moving joint", joint, tree.actuated, tree.name)
    if not (joints or tree.actuated):
        raise InputError(source.path, f"{table}.urdf", "a joint that can move", "none")
    return Agent(
        name=ROBOT if role is Role.ROBOT else HUMAN,
        role=role,
        tree=tree,
        joints=joints or tree.actuated,
        contacts=contacts,
        trunk=trunk,
    )


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
