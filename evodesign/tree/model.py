"""Links, joints and the tree they form.

A link carries solids (shapes of constant density, which a design may change), or an inertia of its own
(kept as given), or neither (a bare frame). Dimensions, densities and joint placements may be symbolic;
names, axes, limits and the tree's form are not.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from functools import cached_property

from evodesign.body.inertia import Inertia, total
from evodesign.body.placement import Matrix, Placement, Scalar, Vector, dot
from evodesign.body.shape import Shape, Solid
from evodesign.errors import ModelError, nearest_name
from evodesign.hardware.actuators import Actuator
from evodesign.tree.surface import Surface


class JointKind(StrEnum):
    """Joint types of URDF that evodesign moves or welds."""

    FIXED = "fixed"
    REVOLUTE = "revolute"
    CONTINUOUS = "continuous"
    PRISMATIC = "prismatic"


@dataclass(frozen=True, slots=True)
class Look:
    """A shape that is only seen: it has a place in the link but no mass."""

    shape: Shape
    link_from_look: Placement


@dataclass(frozen=True, slots=True)
class Mesh:
    """A surface that is only seen.

    Args:
        file: its name in the robot's file.
        scale: factors along the axes of the file's coordinates.
        link_from_mesh: the place of the scaled mesh in the link.
        stretch: in the link's axes, what is done to the scaled and turned mesh before it is moved there.
        surface: its triangles, in the file's coordinates; None where the file is not known.
    """

    file: str
    scale: Vector = (1.0, 1.0, 1.0)
    link_from_mesh: Placement = field(default_factory=Placement)
    stretch: Matrix = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    surface: Surface | None = None

    @property
    def encloses(self) -> bool:
        """Whether its volume is known."""
        return self.surface is not None and self.surface.volume > 0.0

    @property
    def volume(self) -> Scalar:
        """What it encloses, scaled and stretched [m^3]; 0 where that is not known."""
        if self.surface is None:
            return 0.0
        first, second, third = self.stretch
        across = (
            second[1] * third[2] - second[2] * third[1],
            second[2] * third[0] - second[0] * third[2],
            second[0] * third[1] - second[1] * third[0],
        )
        return self.surface.volume * abs(math.prod(self.scale)) * dot(first, across)


@dataclass(frozen=True, slots=True)
class Link:
    """A rigid body or a bare frame.

    Args:
        name: unique in the tree.
        solids: shapes of constant density that make up its mass.
        own_inertia: inertia of a link without solids, in its frame.
        mounted: solids that it carries beside, such as the actuators of the joints beyond.
        looks: shapes without mass.
        meshes: surfaces, likewise.
    """

    name: str
    solids: tuple[Solid, ...] = ()
    own_inertia: Inertia = field(default_factory=Inertia)
    looks: tuple[Look, ...] = ()
    meshes: tuple[Mesh, ...] = ()
    mounted: tuple[Solid, ...] = ()

    @property
    def inertia(self) -> Inertia:
        """Inertia of the whole link in its frame, with what is mounted on it."""
        if not self.solids and not self.mounted:
            return self.own_inertia
        own = [solid.inertia for solid in self.solids] or [self.own_inertia]
        return total([*own, *(solid.inertia for solid in self.mounted)])

    @property
    def mass(self) -> Scalar:
        """Mass of the whole link [kg], with what is mounted on it."""
        own = sum(solid.mass for solid in self.solids) if self.solids else self.own_inertia.mass
        return own + sum(solid.mass for solid in self.mounted) if self.mounted else own

    @property
    def shown(self) -> tuple[Mesh, ...]:
        """Its meshes, if the triangles of all are known; where there are any, shapes are not shown."""
        return self.meshes if all(mesh.surface is not None for mesh in self.meshes) else ()

    @property
    def volume(self) -> Scalar:
        """Volume of its solids, or of its meshes if all enclose one, or of shapes only seen [m^3]."""
        if not self.solids and self.meshes and all(mesh.encloses for mesh in self.meshes):
            return sum(mesh.volume for mesh in self.meshes)
        return sum(part.shape.volume for part in self.solids or self.looks)


@dataclass(frozen=True, slots=True)
class Joint:
    """A joint from a parent link to a child link, whose frame is the joint's.

    Args:
        name: unique in the tree.
        kind: fixed, revolute, continuous or prismatic.
        parent, child: link names.
        parent_from_child: the child's placement at joint position zero.
        axis: unit vector in the child's frame.
        lower, upper: limits [rad or m]; infinite for a continuous joint, zero for a fixed one.
        effort: largest torque or force [N m or N]; infinite when not given.
        velocity: largest speed [rad/s or m/s]; infinite when not given.
        actuator: what a design drives it with; None where the design does not say.
    """

    name: str
    kind: JointKind
    parent: str
    child: str
    parent_from_child: Placement
    axis: Vector = (1.0, 0.0, 0.0)
    lower: float = 0.0
    upper: float = 0.0
    effort: float = float("inf")
    velocity: float = float("inf")
    actuator: Actuator | None = None


@dataclass(frozen=True)
class Tree:
    """A floating-base tree of links and joints, in an order in which parents come before children.

    Args:
        name: of the robot or person.
        links: in any order; the constructor's caller need not sort.
        joints: in any order.
        notes: sentences on what the file says and the tree does not take as it stands.
    Raises:
        ModelError: names that repeat or miss, no root or several, or a loop.
    """

    name: str
    links: tuple[Link, ...]
    joints: tuple[Joint, ...]
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        _check_names(self)
        ordered = _ordered_joints(self)
        object.__setattr__(self, "joints", ordered)

    @cached_property
    def link_by_name(self) -> Mapping[str, Link]:
        """Links by name."""
        return {link.name: link for link in self.links}

    @cached_property
    def joint_by_name(self) -> Mapping[str, Joint]:
        """Joints by name."""
        return {joint.name: joint for joint in self.joints}

    @cached_property
    def parent_joint(self) -> Mapping[str, Joint]:
        """The joint above each link; the root is missing."""
        return {joint.child: joint for joint in self.joints}

    @cached_property
    def child_joints(self) -> Mapping[str, tuple[Joint, ...]]:
        """The joints below each link."""
        below = _joints_below(self)
        return {link.name: tuple(below.get(link.name, ())) for link in self.links}

    @cached_property
    def mass(self) -> Scalar:
        """Mass of all links [kg], with what is mounted on them."""
        return sum(link.mass for link in self.links)

    @cached_property
    def root(self) -> str:
        """Name of the link that no joint holds."""
        return _roots(self)[0]

    @property
    def actuated(self) -> tuple[str, ...]:
        """Names of the joints that can move, parents before children."""
        return tuple(joint.name for joint in self.joints if joint.kind is not JointKind.FIXED)

    def to_root(self, link: str) -> list[str]:
        """A link and those that carry it, up to the root."""
        found = [link]
        while found[-1] in self.parent_joint:
            found.append(self.parent_joint[found[-1]].parent)
        return found

    def reshaped(self, links: tuple[Link, ...], joints: tuple[Joint, ...]) -> Tree:
        """The same links and joints in the same order with other numbers; nothing is checked again."""
        other = object.__new__(Tree)
        fields = {"name": self.name, "links": links, "joints": joints, "notes": self.notes}
        for place, value in fields.items():
            object.__setattr__(other, place, value)
        return other

    def link(self, name: str, asked_by: str) -> Link:
        """The link of a name.

        Raises:
            ModelError: no such link; `asked_by` says which key asked for it.
        """
        if name not in self.link_by_name:
            hint = nearest_name(name, self.link_by_name)
            raise ModelError(self.name, asked_by, "the name of a link", f"'{name}'{hint}")
        return self.link_by_name[name]


def _check_names(tree: Tree) -> None:
    for noun, names in (
        ("link", [link.name for link in tree.links]),
        ("joint", [joint.name for joint in tree.joints]),
    ):
        repeated = min((name for name, count in Counter(names).items() if count > 1), default=None)
        if repeated is not None:
            raise ModelError(tree.name, f"{noun} {repeated}", "a unique name", "the name twice")
    known = {link.name for link in tree.links}
    for joint in tree.joints:
        for role, name in (("parent", joint.parent), ("child", joint.child)):
            if name not in known:
                hint = nearest_name(name, known)
                key = f"joint {joint.name}.{role}"
                raise ModelError(tree.name, key, "the name of a link", f"'{name}'{hint}")


def _roots(tree: Tree) -> list[str]:
    held = {joint.child for joint in tree.joints}
    return [link.name for link in tree.links if link.name not in held]


def _joints_below(tree: Tree) -> dict[str, list[Joint]]:
    """The joints below each link that has some."""
    below: dict[str, list[Joint]] = {}
    for joint in tree.joints:
        below.setdefault(joint.parent, []).append(joint)
    return below


def _ordered_joints(tree: Tree) -> tuple[Joint, ...]:
    """Joints breadth first from the root, in file order among brothers."""
    roots = _roots(tree)
    if len(roots) != 1:
        found = "none" if not roots else f"{len(roots)}: {', '.join(roots)}"
        raise ModelError(tree.name, "links", "one root link that no joint holds", found)
    for name, count in Counter(joint.child for joint in tree.joints).items():
        if count > 1:
            raise ModelError(tree.name, f"link {name}", "one parent joint", "several")
    below = _joints_below(tree)
    ordered = list(below.get(roots[0], ()))
    for joint in ordered:  # which grows meanwhile
        ordered.extend(below.get(joint.child, ()))
    if len(ordered) != len(tree.joints):
        reached = {joint.name for joint in ordered}
        lost = next(joint for joint in tree.joints if joint.name not in reached)
        raise ModelError(tree.name, f"joint {lost.name}", "a tree without loops", "a loop")
    return tuple(ordered)
