"""Quantities of what a task asks of people, beyond the torques of the posture.

    human_load_torque   |torques less those of the same person in the same posture with empty hands| [N m]
    back_compression    of the disc between the fifth lumbar vertebra and the sacrum [N]
    endurance_s         how long the posture can be held [s], the least of all cases

The formulas are those of `mechanics.load_torques` and `mechanics.lumbar_load`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from evodesign.human.back import FLEXION, MUSCLE_LEVER
from evodesign.human.endurance import endurance
from evodesign.mechanics.agent import Agent, Contact
from evodesign.mechanics.load_torques import LoadTorques, load_torques
from evodesign.mechanics.lumbar_load import LumbarLoad, lumbar_load
from evodesign.posture.results import AgentPosture, Array
from evodesign.quantities.design_result import DesignResult, PostureSlopes, values_over_instants
from evodesign.quantities.over_agents import largest, least, norm, over_agents, people

BACK = "back_compression"
"""The quantity that needs people with a joint at L5/S1."""


def added_by_load(person: Agent, posture: AgentPosture) -> LoadTorques:
    """What the load adds to a person's torques (`mechanics.load_torques`)."""
    joints = np.array([posture.joints[name] for name in person.joints])
    hands = np.concatenate([posture.wrenches[hand.name] for hand in person.hands])
    return load_torques(person, posture.base_angles, joints, hands)


def load_torque(person: Agent, posture: AgentPosture) -> float:
    """The norm of the torques that the load asks of a person beyond those with empty hands [N m]."""
    return added_by_load(person, posture).norm


def load_torque_by_posture(person: Agent, posture: AgentPosture) -> PostureSlopes:
    """Its derivatives by the person's posture and hands' wrenches."""
    slopes = added_by_load(person, posture).slopes()
    joints = dict(zip(person.joints, slopes.joints.tolist(), strict=True))
    return PostureSlopes(slopes.angles, joints, _by_contact(person.hands, slopes.hands))


HUMAN_LOAD_TORQUE = over_agents(people, norm, "N m", load_torque, by_posture=load_torque_by_posture)


def _back(person: Agent, posture: AgentPosture) -> LumbarLoad:
    joints = np.array([posture.joints[name] for name in person.joints])
    feet = np.concatenate([posture.wrenches[foot.name] for foot in person.feet])
    return lumbar_load(person, posture.base_angles, joints, feet, posture.torques[FLEXION])


def compression(person: Agent, posture: AgentPosture) -> float:
    """Compression of a person's disc L5/S1 [N] (`mechanics.lumbar_load`)."""
    return _back(person, posture).compression


def compression_by_torque(person: Agent, posture: AgentPosture) -> dict[str, float]:
    """The muscles' part: sign(tau) / lever."""
    return {FLEXION: float(np.sign(posture.torques[FLEXION])) / MUSCLE_LEVER}


def compression_by_posture(person: Agent, posture: AgentPosture) -> PostureSlopes:
    """The axial force's part."""
    slopes, last = _back(person, posture).slopes, 3 + len(person.joints)
    joints = dict(zip(person.joints, slopes[3:last].tolist(), strict=True))
    return PostureSlopes(slopes[:3], joints, _by_contact(person.feet, slopes[last:]))


BACK_COMPRESSION = over_agents(
    people,
    largest,
    "N",
    compression,
    by_torque=compression_by_torque,
    by_posture=compression_by_posture,
)


def _by_contact(contacts: Sequence[Contact], slopes: Array) -> dict[str, Array]:
    """Derivatives by the wrench of each contact, by name."""
    return {each.name: part for each, part in zip(contacts, np.split(slopes, len(contacts)), strict=True)}


def holding_seconds(person: Agent, posture: AgentPosture) -> float:
    """How long a person can hold the posture [s]; for ever if no torque has a strength in its direction."""
    found = endurance(posture.torques, person.strengths)
    return math.inf if found is None else found.seconds


def endurance_by_torque(person: Agent, posture: AgentPosture) -> dict[str, float]:
    """It moves with the joint that tires first."""
    found = endurance(posture.torques, person.strengths)
    return {} if found is None else {found.joint.joint: found.by_torque}


HOLDING_TIME = over_agents(people, least, "s", holding_seconds, by_torque=endurance_by_torque)
"""Of a single case; the quantity is the least of all."""


def endurance_seconds(result: DesignResult) -> float | None:
    """How long all people can hold all loads [s]: the least of all cases; None where nothing tires."""
    found = values_over_instants(HOLDING_TIME.value, result)
    least = math.inf if found is None else min(each for values in found for each in values)
    return least if least < math.inf else None
