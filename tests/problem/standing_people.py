"""Three postures of a person with a load, and statics written out by hand: masses, places and lever arms."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from evodesign.body.placement import Placement
from evodesign.human.anthropometry import Person, sole_size
from evodesign.human.anthropometry_tables import Sex
from evodesign.human.body import DEFAULT_JOINTS, HANDS, SOLES, TRUNK, human_tree
from evodesign.human.strength import joint_strengths
from evodesign.mechanics.agent import HUMAN, SIDES, Agent, Role, two_hands_two_feet
from evodesign.mechanics.contact import SoleSize
from evodesign.mechanics.payload import Payload
from evodesign.mechanics.scene import Scene
from evodesign.posture.results import AgentPosture
from evodesign.tree.frames import link_frames
from evodesign.tree.model import JointKind

G = 9.81

MAN = Person(1.80, 75.0, Sex.MALE)


def person(of: Person = MAN) -> Agent:
    size = SoleSize(*sole_size(of))
    return Agent(
        HUMAN,
        Role.PERSON,
        human_tree(of),
        DEFAULT_JOINTS,
        two_hands_two_feet(HANDS, SOLES, size),
        TRUNK,
        strengths=joint_strengths(of),
    )


PERSON = person()
SCENE = Scene(
    agents=(PERSON,),
    payload=Payload(size=(0.4, 0.4, 0.3), mass=15.0),
)
"""Of which quantities of the person read the person alone."""

ARMS = {
    "jLeftShoulder_rotx": -1.2,
    "jRightShoulder_rotx": 1.2,
    "jLeftElbow_rotz": -1.3,
    "jRightElbow_rotz": 1.3,
}
BENT = {**ARMS, "jL5S1_roty": 0.5, "jL4L3_roty": 0.3, "jL1T12_roty": 0.3}
LEGS = {
    f"j{side}{joint}_roty": angle
    for side in ("Left", "Right")
    for joint, angle in (("Hip", -1.2), ("Knee", 1.3), ("Ankle", -0.4))
}

POSTURES: Mapping[str, tuple[tuple[float, float, float], dict[str, float]]] = {
    "upright": ((0.0, 0.0, 0.0), ARMS),
    "stooped": ((0.0, 0.4, 0.0), {**BENT, "jLeftHip_roty": -0.4, "jRightHip_roty": -0.4}),
    "crouched and turned": ((0.05, 0.3, -0.1), {**BENT, **LEGS, "jL5S1_rotx": 0.1, "jL1T12_rotz": 0.2}),
}
"""Roll, pitch, yaw of the pelvis and joints that are not at zero [rad], by name."""

DOWN = {"left": (4.0, 2.0, -70.0, 1.0, -2.0, 0.5), "right": (6.0, -1.0, -85.0, -0.5, -1.0, 0.2)}
"""What the load does to each hand [N, N m]."""


def standing(name: str, hands: Mapping[str, tuple[float, ...]] = DOWN) -> AgentPosture:
    """A person with a load, and the foot wrenches and torques that cost least."""
    angles, bent = POSTURES[name]
    joints = {joint: bent.get(joint, 0.0) for joint in DEFAULT_JOINTS}
    held = {f"{side}_hand": np.array(hands[side]) for side in SIDES}
    bare = AgentPosture(np.array([-0.4, 0.0, 0.9]), np.array(angles), joints, {}, held)
    torques, feet = least_torques(bare, weight=True)
    held |= {f"{side}_foot": feet[6 * place : 6 * place + 6] for place, side in enumerate(SIDES)}
    return AgentPosture(
        bare.base_position,
        bare.base_angles,
        joints,
        dict(zip(DEFAULT_JOINTS, torques, strict=True)),
        held,
    )


def places(posture: AgentPosture) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Rotation and origin of every link."""
    root = Placement.from_xyz_rpy(tuple(posture.base_position), tuple(posture.base_angles))
    frames = link_frames(PERSON.tree, root, posture.joints)
    return {name: (np.array(each.rotation), np.array(each.translation)) for name, each in frames.items()}


def beyond(joint: str) -> set[str]:
    """Links that a joint carries."""
    tree = PERSON.tree
    child = tree.joint_by_name[joint].child
    return {link.name for link in tree.links if child in tree.to_root(link.name)}


def masses() -> dict[str, tuple[float, np.ndarray]]:
    """Mass [kg] and its centre in the link [m], of every link that has any."""
    bodies = {link.name: link.inertia for link in PERSON.tree.links}
    return {
        name: (float(of.mass), np.array(of.center, float)) for name, of in bodies.items() if of.mass > 0.0
    }


def asked(posture: AgentPosture, forces: list[tuple[str, np.ndarray, np.ndarray, np.ndarray]]) -> np.ndarray:
    """Force and moment about the pelvis that are missing, then each joint's torque, for forces on links.

    Args:
        posture: of the person.
        forces: link, point [m], force [N] and moment [N m].
    """
    at = places(posture)
    root = posture.base_position
    force = sum((f for _, _, f, _ in forces), np.zeros(3))
    moment = sum((np.cross(p - root, f) + m for _, p, f, m in forces), np.zeros(3))
    torques = []
    for name in DEFAULT_JOINTS:
        joint, carried = PERSON.tree.joint_by_name[name], beyond(name)
        turn, origin = at[joint.child]
        own = [np.cross(p - origin, f) + m for link, p, f, m in forces if link in carried]
        torques.append(-float((turn @ np.array(joint.axis)) @ sum(own, np.zeros(3))))
        assert joint.kind is JointKind.REVOLUTE
    return np.concatenate([force, moment, torques])


def least_torques(posture: AgentPosture, *, weight: bool) -> tuple[np.ndarray, np.ndarray]:
    """Torques of least norm over all foot wrenches that hold the person, and these wrenches.

    Args:
        posture: with what the hands carry.
        weight: whether the body has weight.
    """
    at = places(posture)
    given = [
        (hand.frame, at[hand.frame][1], *np.split(posture.wrenches[hand.name], 2)) for hand in PERSON.hands
    ]
    if weight:
        for link, (mass, center) in masses().items():
            turn, origin = at[link]
            given.append((link, origin + turn @ center, np.array([0.0, 0.0, -mass * G]), np.zeros(3)))
    constant = asked(posture, given)
    columns = []
    for side in SIDES:
        turn, origin = at[PERSON.frame(f"{side}_foot")]
        units = [(turn @ axis, np.zeros(3)) for axis in np.eye(3)]
        units += [(moment, force) for force, moment in units]
        columns += [asked(posture, [(PERSON.frame(f"{side}_foot"), origin, *unit)]) for unit in units]
    by_feet = np.array(columns).T
    some = np.linalg.lstsq(by_feet[:6], -constant[:6], rcond=None)[0]
    free = np.linalg.svd(by_feet[:6])[2][6:].T
    rest = constant[6:] + by_feet[6:] @ some
    feet = some + free @ np.linalg.lstsq(by_feet[6:] @ free, -rest, rcond=None)[0]
    assert math.isclose(float(np.abs(constant[:6] + by_feet[:6] @ feet).max()), 0.0, abs_tol=1e-8)
    return constant[6:] + by_feet[6:] @ feet, feet
