"""An MJCF robot as URDF text, by way of MuJoCo's own compiler, which resolves includes, defaults and angles.

    body             link of the same name and frame; the one below the world that carries joints is the root
                     and floats; if it is turned in the file, it is fixed to a root with the world's axes
    hinge, slide     joint at its anchor, with MuJoCo's positions (also where `ref` is not zero); links
                     without mass lie between joints of one body, and between an anchor and a body's origin
    joint equality   mimic joint, or a fixed one where it follows nothing
    actuators        effort limit (`mjcf_effort`)
    site             link without mass
    geom             visual and collision (`mjcf_geoms`)

What a tree does not have (`mjcf_unread`) is told in <note>, which `read_urdf` passes on; a robot with ball
joints is refused. Nobody who reads the URDF needs MuJoCo: a run or a copied problem is read without it.

Source: MuJoCo XML reference (body, joint, equality); MuJoCo's mj_kinematics.
"""

from __future__ import annotations

import math
import re
import warnings
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from lxml import etree

from evodesign.body.inertia import Inertia
from evodesign.body.placement import Placement, scale, vector
from evodesign.errors import ModelError, listed
from evodesign.tree.frames import parent_from_child
from evodesign.tree.mjcf_effort import effort_limit
from evodesign.tree.mjcf_followers import FollowerRule, follower_rules
from evodesign.tree.mjcf_geoms import add_geoms, placement
from evodesign.tree.mjcf_unread import Unread
from evodesign.tree.model import Joint, JointKind
from evodesign.tree.placeholder import placeholder
from evodesign.tree.urdf_write import add_inertial, add_joint, numbers_text, robot_text

FIRST_ELEMENT = re.compile(r"\ufeff?(?:\s+|<\?.*?\?>|<!--.*?-->)*+<mujoco\b", re.DOTALL)
UNDEFINED = re.compile(r"""(?<!name)=\s*["'][\s0-9.eE+-]*\bnan\b""", re.IGNORECASE)
"""A number that is none, other than a name of three letters."""


@dataclass(frozen=True, slots=True)
class TranslatedRobot:
    """A robot's URDF, and the meshes that came with it, as binary STL [m] by their names in it."""

    urdf: str
    meshes: Mapping[str, bytes] = field(default_factory=dict)


def is_mjcf(text: str) -> bool:
    """Whether the outermost element of an XML text is <mujoco>."""
    return FIRST_ELEMENT.match(text) is not None


def translated(path: Path, source: str) -> TranslatedRobot:
    """The robot of an MJCF file.

    Args:
        path: of the file; what it includes and its meshes are found from there.
        source: the file's name, for messages.
    Raises:
        ImportError: MuJoCo is not installed.
        ModelError: MuJoCo cannot compile the file, or it holds no robot, several, or one with ball joints.
    """
    import mujoco

    model, touching, said = _compiled(mujoco, path, source)
    root = _root(model, source)
    bodies = tuple(body for body in range(1, model.nbody) if model.body_rootid[body] == root)
    moving = [joint for joint in range(model.njnt) if model.jnt_bodyid[joint] in bodies[1:]]
    of_links, of_joints = _Names(set()), _Names(set())
    figures = np.concatenate([model.body_mass, model.body_inertia.ravel(), model.body_ipos.ravel()])
    if not np.isfinite(figures).all():
        raise ModelError(source, "worldbody", "finite masses and inertias", "others")
    links = {body: of_links.of(model.body(body).name or f"body_{body}") for body in bodies}
    joints = {joint: of_joints.of(model.joint(joint).name or f"joint_{joint}") for joint in moving}
    return _Translation(mujoco, model, source, links, joints, of_links, of_joints, touching, said).result()


def _compiled(mujoco: Any, path: Path, source: str) -> tuple[Any, frozenset[int], tuple[str, ...]]:
    """A model whose geoms touch nothing, those that touch in the file, and what MuJoCo warns of."""
    spec = None
    if UNDEFINED.search(path.read_text(encoding="utf-8-sig", errors="replace")):
        raise ModelError(source, "", "finite numbers", "'nan', for which MuJoCo takes its defaults")
    try:
        with warnings.catch_warnings(record=True) as warned:
            warnings.simplefilter("always")
            spec = mujoco.MjSpec.from_file(str(path))
            touching = [geom for geom in spec.geoms if geom.contype or geom.conaffinity]
            for geom in touching:  # else convex hulls are made of all meshes that touch, for seconds
                geom.contype = geom.conaffinity = 0
            spec.compiler.discardvisual = False
            model = spec.compile()
    except (ValueError, mujoco.FatalError) as error:
        found = " ".join(str(error).split())
        if spec is not None and (missing := _missing_mesh(spec, path)):
            raise ModelError(source, "asset", "meshes", missing) from error
        raise ModelError(source, "", "an MJCF file that MuJoCo compiles", found) from error
    said = tuple(" ".join(f"MuJoCo says: {each.message}".split()) for each in warned)
    return model, frozenset(geom.id for geom in touching), said


def _missing_mesh(spec: Any, path: Path) -> str:
    """The first mesh whose file holds something else in place of it, if that is why nothing compiles."""
    for mesh in spec.meshes:
        file = path.parent / spec.compiler.meshdir / mesh.file
        with suppress(OSError):
            if mesh.file and (what := placeholder(file.read_bytes()[:1000])):
                return f"'{file}', which {what}"
    return ""


def _root(model: Any, source: str) -> int:
    """The body below the world that carries joints."""
    roots = model.body_rootid[model.jnt_bodyid]
    carrying = sorted(set(roots[model.jnt_bodyid != roots].tolist()))
    if len(carrying) != 1:
        found = ", ".join(f"'{model.body(body).name}'" for body in carrying) or "none"
        raise ModelError(source, "worldbody", "one body that carries others on hinges or slides", found)
    return int(carrying[0])


@dataclass(frozen=True, slots=True)
class _Names:
    """Names that are taken."""

    taken: set[str]

    def of(self, name: str, suffix: str = "_") -> str:
        """The name, or a longer one where another has it."""
        while name in self.taken:
            name += suffix
        self.taken.add(name)
        return name


@dataclass(frozen=True, slots=True)
class _Translation:
    """A compiled model, names of its robot's links by body, the root first, and of its joints.

    `touching` are the geoms that touch others, `said` what MuJoCo warned of.
    """

    mujoco: Any
    model: Any
    source: str
    links: Mapping[int, str]
    joints: Mapping[int, str]
    link_names: _Names
    joint_names: _Names
    touching: frozenset[int]
    said: tuple[str, ...]

    def result(self) -> TranslatedRobot:
        """The robot."""
        robot = etree.Element("robot", name=self.model.names.split(b"\0")[0].decode(errors="replace"))
        meshes: dict[str, bytes] = {}
        for body, name in self.links.items():
            link = etree.SubElement(robot, "link", name=name)
            add_inertial(link, self._inertia(body))
            meshes |= add_geoms(link, self.mujoco, self.model, body, self.touching)
        coupled = follower_rules(self.mujoco, self.model, self.joints)
        root = next(iter(self.links))
        turned = placement((0.0, 0.0, 0.0), self.model.body_quat[root])
        if turned != Placement():
            upright = self.link_names.of(f"{self.links[root]}_upright")
            etree.SubElement(robot, "link", name=upright)
            add_joint(robot, self._weld(upright, self.links[root], turned))
        for body in [*self.links][1:]:
            for joint in self._above(body):
                self._add(robot, joint, coupled)
        for site in range(self.model.nsite):
            body, name = int(self.model.site_bodyid[site]), self.model.site(site).name
            if name and body in self.links:
                place = placement(self.model.site_pos[site], self.model.site_quat[site])
                self._add(robot, self._weld(self.links[body], self.link_names.of(name, "_site"), place), {})
        for note in self._notes(coupled):
            etree.SubElement(robot, "note", text=note)
        return TranslatedRobot(robot_text(robot), meshes)

    def _inertia(self, body: int) -> Inertia:
        """In the body's frame, of principal moments along axes of their own."""
        model = self.model
        x, y, z = model.body_inertia[body].tolist()
        principal = Inertia(float(model.body_mass[body]), about_center=((x, 0, 0), (0, y, 0), (0, 0, z)))
        return principal.moved(placement(model.body_ipos[body], model.body_iquat[body]))

    def _above(self, body: int) -> Iterator[Joint]:
        """The joints of a body, from its parent on; a fixed one where it has none."""
        model, name = self.model, self.links[body]
        parent = self.links[int(model.body_parentid[body])]
        place = placement(model.body_pos[body], model.body_quat[body])
        end = model.body_jntadr[body] + model.body_jntnum[body]
        for number in range(end - model.body_jntnum[body], end):
            anchor = vector(model.jnt_pos[number])
            at_origin = number == end - 1 and not any(anchor)
            child = name if at_origin else self.link_names.of(f"{name}_below_{self.joints[number]}")
            yield self._joint(number, parent, child, place @ Placement(translation=anchor))
            parent, place = child, Placement(translation=scale(-1.0, anchor))
        if parent != name:
            yield self._weld(parent, name, place)

    def _weld(self, parent: str, child: str, place: Placement) -> Joint:
        return Joint(self.joint_names.of(f"{child}_fixed_joint"), JointKind.FIXED, parent, child, place)

    def _joint(self, number: int, parent: str, child: str, place: Placement) -> Joint:
        """A hinge or slide; `place` is where it puts the child at its `ref`."""
        model, name = self.model, self.joints[number]
        kinds = {
            int(self.mujoco.mjtJoint.mjJNT_HINGE): JointKind.REVOLUTE,
            int(self.mujoco.mjtJoint.mjJNT_SLIDE): JointKind.PRISMATIC,
        }
        kind = kinds.get(int(model.jnt_type[number]))
        if kind is None:
            wanted = "hinges and slides (three hinges turn as a ball joint does)"
            raise ModelError(self.source, f"joint {name}", wanted, "a ball joint")
        lower, upper = -math.inf, math.inf
        if model.jnt_limited[number]:
            lower, upper = model.jnt_range[number].tolist()
        elif kind is JointKind.REVOLUTE:
            kind = JointKind.CONTINUOUS
        effort, axis = effort_limit(self.mujoco, model, number), vector(model.jnt_axis[number])
        at_ref = Joint(name, kind, parent, child, place, axis, lower, upper, effort)
        ref = float(model.qpos0[model.jnt_qposadr[number]])
        return replace(at_ref, parent_from_child=parent_from_child(at_ref, -ref))

    def _add(self, robot: etree._Element, joint: Joint, coupled: Mapping[str, FollowerRule]) -> None:
        """A joint, and its child where that is no body's."""
        if joint.child not in self.links.values():
            etree.SubElement(robot, "link", name=joint.child)
        rule = coupled.get(joint.name)
        if rule is not None and not rule.leader:
            held = parent_from_child(joint, rule.position)
            joint = Joint(joint.name, JointKind.FIXED, joint.parent, joint.child, held)
        element = add_joint(robot, joint)
        if rule is not None and rule.leader:
            slope, offset = numbers_text([rule.slope]), numbers_text([rule.offset])
            etree.SubElement(element, "mimic", joint=rule.leader, multiplier=slope, offset=offset)

    def _notes(self, coupled: Mapping[str, FollowerRule]) -> Iterator[str]:
        """Sentences on what a tree does not have."""
        held = [name for name, rule in coupled.items() if not rule.leader]
        yield from self.said
        if held:
            yield f"locked where an equality holds them: {listed(held)}"
        yield from Unread(self.mujoco, self.model, self.links, self.joints).sentences()
