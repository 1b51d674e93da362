"""What a person's table says of how the person stands: the spine, and measured postures.

A measured posture needs a spine that bends as a whole: it says nothing of single lumbar joints.
"""

from __future__ import annotations

from dataclasses import replace

from evodesign.body.placement import Placement
from evodesign.errors import InputError
from evodesign.human.anthropometry_tables import tables
from evodesign.human.coupled_joints import coupled_joints, rhythms
from evodesign.human.measured_posture import (
    NEEDED_JOINTS,
    NEEDED_LINKS,
    USUAL_POSTURE,
    HumanPosture,
    drawn_person,
    measured_posture,
)
from evodesign.mechanics.agent import Agent
from evodesign.problem.agent_tables import HumanTable, JointRanges
from evodesign.records import ProblemSource
from evodesign.tree.frames import link_frames

ROOT, HEAD = "Pelvis", "Head"
"""A person's links: the root, and the one that holds the eyes."""


def with_posture(key: str, table: HumanTable, person: Agent, source: ProblemSource) -> Agent:
    """The person with what the table says of spine and posture.

    Args:
        key: of the table, for messages.
        table: the person's.
        person: without either.
        source: the problem, for messages.
    Raises:
        InputError: a person from a URDF without the links and joints that this needs, a spine whose joints
            are to move together but not all do, or samples of a person whom no measured posture draws.
    """
    if is_measured(table):
        return _coupled(key, JointRanges.RHYTHM, _measured(key, table, person, source), source)
    for name in ("spread", "posture_sample"):
        if getattr(table, name) is not None:
            wanted = 'posture = "measured", which has a distribution of people, or no such key'
            raise InputError(source.path, f"{key}.{name}", wanted, f"{getattr(table, name)} of one posture")
    ranges = table.joint_ranges or JointRanges.SEPARATE
    return person if ranges is JointRanges.SEPARATE else _coupled(key, ranges, person, source)


def is_measured(table: HumanTable) -> bool:
    """Whether measured postures draw the person of a table."""
    usual = USUAL_POSTURE if table.urdf is None else HumanPosture.LEAST_TORQUE
    return (table.posture or usual) is HumanPosture.MEASURED


def _measured(key: str, table: HumanTable, person: Agent, source: ProblemSource) -> Agent:
    """The person, drawn to measured postures."""
    if table.spread is not None and table.posture_sample is not None:
        wanted = "either how many people to draw, or spread left out: this one is drawn already"
        raise InputError(
            source.path, f"{key}.spread", wanted, f"both, and posture_sample = {table.posture_sample}"
        )
    if table.joint_ranges not in (None, JointRanges.RHYTHM):
        wanted = "'rhythm', which a measured posture has, or posture = \"least_torque\""
        raise InputError(source.path, f"{key}.joint_ranges", wanted, f"'{table.joint_ranges}'")
    tree = person.tree
    lacking = [f"root link '{ROOT}'"] * (tree.root != ROOT)
    lacking += [f"link '{name}'" for name in NEEDED_LINKS if name not in tree.link_by_name]
    lacking += [f"joint '{name}'" for name in NEEDED_JOINTS if name not in tree.joint_by_name]
    if lacking:
        wanted = f"'least_torque', or a person with the generated one's body, such as its {lacking[0]}"
        raise InputError(source.path, f"{key}.posture", wanted, f"'measured' of '{tree.name}'")
    drawn = drawn_person(table.posture_sample or 0)
    return replace(
        person, measured=replace(measured_posture(table.stature_m or _stature(person)), drawn=drawn)
    )


def _stature(person: Agent) -> float:
    """Of a person from a URDF [m]: from the soles to the head's joint, over that share of stature."""
    frames = link_frames(person.tree, Placement(), {})
    soles, lengths = person.foot_frames, tables().lengths
    height: float = frames[HEAD].translation[2] - min(frames[sole].translation[2] for sole in soles)
    return height / (1.0 - lengths.head)


def _coupled(key: str, ranges: JointRanges, person: Agent, source: ProblemSource) -> Agent:
    """The person with the published ranges that its joints share, or movements that they make together."""
    shared, found = coupled_joints(), f"'{ranges}' of '{person.tree.name}'"
    for name in (name for each in shared for name in each.joints):
        if name not in person.tree.joint_by_name:
            wanted = f"'separate', or a person with the generated one's spine, such as its joint '{name}'"
            raise InputError(source.path, f"{key}.joint_ranges", wanted, found)
    if ranges is JointRanges.COUPLED:
        return replace(person, coupled_joints=shared)
    moving = tuple(each for each in rhythms() if not set(each.joints).isdisjoint(person.joints))
    for name in (name for each in moving for name in each.joints):
        if name not in person.joints:
            wanted = f"the spine's joints of one movement all among {key}.joints, such as '{name}'"
            raise InputError(source.path, f"{key}.joint_ranges", wanted, found)
    led = {name for each in moving for name in each.joints}
    return replace(
        person, rhythms=moving, coupled_joints=tuple(e for e in shared if led.isdisjoint(e.joints))
    )
