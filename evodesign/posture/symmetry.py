"""Which part of an agent a program describes: all of it, or the left half of a mirror-symmetric one.

In a symmetric posture the right side is the left one's mirror image, the base does not leave the plane
y = 0, and rolls and yaws of the middle line are zero. The half has half the variables, its effort counts
every paired torque twice, and it has fewer local minima; `expand` gives the whole posture back.

Joints that a rhythm moves together (`human.coupled_joints`) have one variable, a coordinate: with s_i their
shares, q_i = s_i Q. All other joints are coordinates themselves.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from evodesign.body.placement import Placement
from evodesign.errors import ModelError
from evodesign.human.coupled_joints import Rhythm
from evodesign.mechanics.agent import Agent, Contact, Touched, touching
from evodesign.mechanics.disturbance import Disturbance
from evodesign.mechanics.scene import Scene
from evodesign.posture.results import AgentPosture, Array
from evodesign.tree.frames import link_frames
from evodesign.tree.mirror_pairs import Mirror
from evodesign.tree.model import Tree
from evodesign.tree.symmetry import left_half, mirror_of

POLAR = np.array([1.0, -1.0, 1.0])
WRENCH = np.concatenate([POLAR, -POLAR])

PARALLEL = 1e-9
"""Entries of two rotations that differ by less are equal."""


@dataclass(frozen=True, slots=True)
class Form:
    """The part of an agent that a program describes.

    Args:
        agent: all of it.
        joints: the agent's joints that move.
        contacts: whose wrenches are variables; the others mirror them.
        mirror: of the agent's tree; None when everything is described.
    """

    agent: Agent
    joints: tuple[str, ...]
    contacts: tuple[Contact, ...]
    mirror: Mirror | None

    @property
    def feet(self) -> tuple[Contact, ...]:
        """Its contacts with the ground."""
        return touching(self.contacts, Touched.GROUND)

    @property
    def hands(self) -> tuple[Contact, ...]:
        """Its contacts with the load."""
        return touching(self.contacts, Touched.LOAD)

    @property
    def counts(self) -> tuple[float, ...]:
        """How many joints of the agent each variable joint stands for: 1, or 2 for a pair."""
        if self.mirror is None:
            return (1.0,) * len(self.joints)
        return tuple(1.0 if self.mirror.joints[name] == name else 2.0 for name in self.joints)

    @property
    def rhythms(self) -> tuple[Rhythm, ...]:
        """Movements that joints of the form make together."""
        return tuple(each for each in self.agent.rhythms if set(each.joints) <= set(self.joints))

    @property
    def coordinates(self) -> dict[str, Mapping[str, float]]:
        """What joints follow from, by name, with the joints' shares; a rhythm has its first joint's place."""
        led = {name: each for each in self.rhythms for name in each.joints}
        names = dict.fromkeys(led[name].name if name in led else name for name in self.joints)
        shares = {each.name: dict(zip(each.joints, each.shares, strict=True)) for each in self.rhythms}
        return {name: shares.get(name, {name: 1.0}) for name in names}

    @property
    def _image(self) -> Array:
        """Joint positions from coordinates, shape (joints, coordinates)."""
        columns = self.coordinates.values()
        return np.array([[column.get(name, 0.0) for column in columns] for name in self.joints])

    def positions(self, coordinates: Any) -> Any:
        """Positions of the form's joints from coordinates; of a column of numbers or expressions.

        Speeds and accelerations follow from those of coordinates in the same way.
        """
        if not self.rhythms:
            return coordinates
        image = self._image
        return image @ coordinates if isinstance(coordinates, np.ndarray) else ca.DM(image) @ coordinates

    def words_of(self, joint: str) -> str:
        """A variable joint in words, with its twin where it stands for a pair."""
        twin = joint if self.mirror is None else self.mirror.joints[joint]
        return joint if twin == joint else f"{joint} and {twin}"

    @property
    def trunk(self) -> tuple[str, ...]:
        """The agent's trunk frames that the form holds."""
        if self.mirror is None:
            return self.agent.trunk
        kept = self.part(self.agent.tree)[0].link_by_name
        return tuple(name for name in self.agent.trunk if name in kept)

    def part(self, tree: Tree) -> tuple[Tree, frozenset[str]]:
        """The part of the agent's (resized) tree that the form holds, and its joints that count twice."""
        if self.mirror is None:
            return tree, frozenset()
        return left_half(tree, self.mirror)

    def expand(self, values: Mapping[str, Array]) -> AgentPosture:
        """The whole posture from a solution's values (names without the agent's)."""
        wrenches = {each.name: padded(values[each.name]) for each in self.contacts}
        return AgentPosture(
            base_position=values["base_position"],
            base_angles=values["base_angles"],
            joints=self.whole_joints(self.positions(values["joints"])),
            torques=self.whole_joints(values["torques"]),
            wrenches=both_sides(self.agent.contacts, wrenches, WRENCH),
        )

    def whole_joints(self, values: Array) -> dict[str, float]:
        """Positions, speeds or torques of all the agent's joints, in its order, from those of the form's."""
        known = dict(zip(self.joints, values.tolist(), strict=True))
        if self.mirror is not None:
            known = _both_sides(known, self.agent, self.mirror)
        return {name: known[name] for name in self.agent.joints}

    def folded(self, by_joint: Mapping[str, float]) -> Array:
        """Weights of the whole agent's torques as weights of those that are variables, one per joint.

        The torque of a mirrored joint is that of its twin, but for the sign; one of the middle line that is
        no variable does not move.
        """
        found = np.array([by_joint.get(name, 0.0) for name in self.joints])
        if self.mirror is None:
            return found
        twins = [(self.mirror.joints[name], self.mirror.signs[name]) for name in self.joints]
        own = zip(self.joints, twins, strict=True)
        return found + [0.0 if twin == name else sign * by_joint.get(twin, 0.0) for name, (twin, sign) in own]

    def parts(self, posture: AgentPosture) -> dict[str, Array]:
        """What `expand` takes, from a posture of the whole agent; hands pass six numbers.

        A rhythm moves by the sum of its joints.
        """
        return {
            "base_position": posture.base_position,
            "base_angles": posture.base_angles,
            "joints": np.array([_moved(posture, joints) for joints in self.coordinates.values()]),
            "torques": np.array([posture.torques[name] for name in self.joints]),
            **{each.name: posture.wrenches[each.name] for each in self.contacts},
        }


def _moved(posture: AgentPosture, joints: Iterable[str]) -> float:
    """By how much joints have moved together; the sign of a zero stays."""
    return sum((posture.joints[name] for name in joints), start=-0.0)


def both_sides(contacts: Iterable[Contact], known: Mapping[str, Any], image: Any) -> dict[str, Any]:
    """Wrenches of all contacts, by name, from those of some, which the others mirror.

    Args:
        contacts: of an agent.
        known: wrenches by name, numbers or expressions.
        image: by which each component is multiplied in a mirror image.
    """
    twins = {each.touched: each.name for each in contacts if each.side == "left"}
    return {
        each.name: known[each.name] if each.name in known else known[twins[each.touched]] * image
        for each in contacts
    }


def _both_sides(known: Mapping[str, float], agent: Agent, mirror: Mirror) -> dict[str, float]:
    """Values of all joints of a symmetric agent from those of its half."""
    found = dict.fromkeys(agent.joints, 0.0)
    for name, value in known.items():
        found[name] = value
        if mirror.joints[name] != name:
            found[mirror.joints[name]] = mirror.signs[name] * value
    return found


def whole(agent: Agent) -> Form:
    """All of an agent."""
    return Form(agent, agent.joints, agent.contacts, None)


def half(agent: Agent) -> Form:
    """The left half of a mirror-symmetric agent.

    Raises:
        ModelError: naming the links, joints or frames that differ.
    """
    mirror = mirror_of(agent.tree)
    for each in agent.contacts:
        if agent.mirrored(each) is None:
            wanted = "hands and feet in pairs, one on each side"
            raise ModelError(agent.tree.name, f"{agent.name}.{each.name}", wanted, "one alone")
    for noun, contacts in (("hands", agent.hands), ("soles", agent.feet)):
        if not contacts:
            continue
        frames = {each.side: each.frame for each in contacts}
        if mirror.links[frames["left"]] != frames["right"]:
            found = f"'{frames['left']}' and '{frames['right']}'"
            raise ModelError(agent.tree.name, f"{agent.name}.{noun}", "mirror images of each other", found)
        if frames["left"] not in mirror.left:
            key, found = f"{agent.name}.{noun}.left", f"'{frames['left']}'"
            raise ModelError(agent.tree.name, key, "a frame to the left of the middle (y > 0)", found)
    _refuse_turned_soles(agent)
    for name in agent.joints:
        if mirror.joints[name] not in agent.joints:
            found = f"'{name}' without '{mirror.joints[name]}'"
            raise ModelError(agent.tree.name, f"{agent.name}.joints", "both joints of a pair", found)
    kept = left_half(agent.tree, mirror)[0].joint_by_name
    joints = tuple(
        name
        for name in agent.joints
        if name in kept and not (mirror.joints[name] == name and mirror.signs[name] < 0.0)
    )
    return Form(agent, joints, tuple(each for each in agent.contacts if each.side != "right"), mirror)


def _refuse_turned_soles(agent: Agent) -> None:
    """Refuse soles whose frames are no mirror images: wrenches on feet live in them (x forward, z up)."""
    frames = link_frames(agent.tree, Placement(), {})
    left, right = (frames[foot.frame] for foot in agent.feet)
    turn = np.abs(np.array(left.mirrored().rotation) - np.array(right.rotation)).max()
    if turn > PARALLEL:
        names = " and ".join(f"'{foot.frame}'" for foot in agent.feet)
        found = f"{names}, which are turned differently"
        wanted = "frames that are mirror images of each other"
        raise ModelError(agent.tree.name, f"{agent.name}.soles", wanted, found)


def forms_of(scene: Scene, *, symmetric: bool) -> tuple[Form, ...]:
    """The forms of a scene's agents, in their order: halves where postures are symmetric."""
    return symmetric_forms(scene) if symmetric else tuple(map(whole, scene.agents))


def symmetric_forms(scene: Scene) -> tuple[Form, ...]:
    """The halves of all agents in a scene that is its own mirror image.

    Raises:
        ModelError: naming what differs, or the disturbance that pushes to a side.
    """
    payload = scene.payload
    if payload.center_of_mass[1] != 0.0:
        found = f"y = {payload.center_of_mass[1]:g} m"
        raise ModelError("payload", "center_of_mass_m", "y = 0 in a symmetric scene", found)
    for agent in scene.agents:
        if agent.quarters % 2:
            found = f"{agent.name} beside it, who looks across it"
            raise ModelError(agent.tree.name, "", "agents before and behind a symmetric load", found)
    forms = tuple(map(half, scene.agents))
    for agent in scene.agents:
        left, right = (payload.grasp_point(agent, hand) for hand in agent.hands)
        if tuple(left) != (right[0], -right[1], right[2]):
            key = f"{agent.name}_grasps_m"
            raise ModelError("payload", key, "mirror images in a symmetric scene", f"{left} and {right}")
    for disturbance in scene.disturbances.cases:
        _refuse_lopsided(disturbance, forms)
    return forms


def _refuse_lopsided(disturbance: Disturbance, forms: tuple[Form, ...]) -> None:
    """Refuse what symmetric agents do not answer symmetrically."""
    where = f"disturbance '{disturbance.name}'"
    if disturbance.sideways:
        raise ModelError(where, "", "y = 0 everywhere in a symmetric scene", "a part along y")
    for form in forms:
        pushed = any(disturbance.push_on(form.agent.name))
        frame = form.agent.pushed_frame if pushed else ""
        if pushed and form.mirror and (not form.mirror.is_middle(frame) or frame in form.mirror.loose):
            found = f"'{form.agent.pushed_frame}'"
            raise ModelError(where, "", "a push on the middle line in a symmetric scene", found)


def padded(free: Array) -> Array:
    """Six rows from the free numbers of a grasp: a point grasp passes no moment."""
    return np.concatenate([free, np.zeros(6 - len(free))])
