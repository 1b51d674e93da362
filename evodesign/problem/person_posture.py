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
    measured_posture,
)
from evodesign.mechanics.scene import Agent
from evodesign.problem.file import HumanTable, JointRanges
from evodesign.records import ProblemSource
from evodesign.tree.frames import link_frames

__all__ = ["HEAD", "with_posture"]

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
        InputError: a person from a URDF without the links and joints that this needs, or a spine whose joints
            are to move together but not all do.
    """
    usual = USUAL_POSTURE if table.urdf is None else HumanPosture.LEAST_TORQUE
    if (table.posture or usual) is HumanPosture.MEASURED:
        return _coupled(key, JointRanges.RHYTHM, _measured(key, table, person, source), source)
    ranges = table.joint_ranges or JointRanges.SEPARATE
    return person if ranges is JointRanges.SEPARATE else _coupled(key, ranges, person, source)


def _measured(key: str, table: HumanTable, person: Agent, source: ProblemSource) -> Agent:
    """The person, drawn to measured postures.

    Raises:
        InputError: lumbar joints that are not to bend as one, or a person from a URDF without the links and
            joints that postures were measured of.
    """
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
    return replace(person, measured=measured_posture(table.stature_m or _stature(person)))


def _stature(person: Agent) -> float:
    """Of a person from a URDF [m]: from the soles to the head's joint, over that share of stature."""
    frames = link_frames(person.tree, Placement(), {})
    soles, lengths = person.soles.values(), tables().lengths
    height: float = frames[HEAD].translation[2] - min(frames[sole].translation[2] for sole in soles)
    return height / (1.0 - lengths.head)


def _coupled(key: str, ranges: JointRanges, person: Agent, source: ProblemSource) -> Agent:
    """The person with the published ranges that its joints share, or the movements that they make together.

    Raises:
        InputError: a person from a URDF lacks one of the joints, or some of a rhythm's are held.
    """
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
