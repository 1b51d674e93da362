"""Trees with hardware: links with walls, joints with actuators.

    wall       every solid of the link becomes hollow; a share of its mass in the file (cables, boards,
               covers) stays, spread evenly over it, whatever the wall
    actuator   its mass is a ball at the joint, or a cylinder about its axis, in the link before it; the
               joint's effort limit is its peak torque and its velocity limit its speed without load

Thicknesses, densities and figures of actuators may be expressions.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from evodesign.body.placement import Scalar
from evodesign.body.shape import Solid
from evodesign.errors import ModelError
from evodesign.hardware.actuators import Actuator, mounted_solid
from evodesign.tree.model import Joint, JointKind, Link, Tree


@dataclass(frozen=True, slots=True)
class WallOfLink:
    """What a link is made of.

    Args:
        thickness: [m].
        density: of the material [kg/m^3]; None where it is decided later.
        share: of the link's mass in the file that stays beside the wall.
    """

    thickness: Scalar
    density: float | None
    share: float


def with_walls(tree: Tree, walls: Mapping[str, WallOfLink]) -> Tree:
    """The tree with some links hollow.

    Args:
        tree: of numbers, as the file describes it; links that are hollow already stay as they are.
        walls: by link name.
    Raises:
        ModelError: a link without solids.
    """
    if not walls:
        return tree
    for name in walls:
        if not tree.link(name, "wall").solids:
            wanted = "a link made of spheres, cylinders or boxes"
            raise ModelError(tree.name, f"wall of link {name}", wanted, "a link without")
    links = tuple(_hollow(link, walls.get(link.name)) for link in tree.links)
    return tree.reshaped(links, tree.joints)


def _hollow(link: Link, wall: WallOfLink | None) -> Link:
    if wall is None or link.solids[0].wall is not None:
        return link
    solids = tuple(
        replace(
            solid,
            density=solid.density if wall.density is None else wall.density,
            wall=wall.thickness,
            filling=wall.share * solid.mass,
        )
        for solid in link.solids
    )
    return replace(link, solids=solids)


def with_actuators(tree: Tree, actuators: Mapping[str, Actuator]) -> Tree:
    """The tree with some joints driven by actuators.

    Args:
        tree: in its final size.
        actuators: by joint name.
    Raises:
        ModelError: a joint that is missing or does not turn.
    """
    if not actuators:
        return tree
    for name in actuators:
        joint = tree.joint_by_name.get(name)
        if joint is None or joint.kind not in (JointKind.REVOLUTE, JointKind.CONTINUOUS):
            found = "no such joint" if joint is None else f"a {joint.kind} one"
            raise ModelError(tree.name, f"actuator of joint {name}", "a joint that turns", found)
    joints = tuple(_driven(joint, actuators.get(joint.name)) for joint in tree.joints)
    mounted: dict[str, list[Solid]] = {}
    for link, solid in mounted_solids(tree, actuators):
        mounted.setdefault(link, []).append(solid)
    links = tuple(
        replace(link, mounted=(*link.mounted, *mounted[link.name])) if link.name in mounted else link
        for link in tree.links
    )
    return tree.reshaped(links, joints)


def _driven(joint: Joint, actuator: Actuator | None) -> Joint:
    if actuator is None:
        return joint
    return replace(joint, actuator=actuator, effort=actuator.peak, velocity=actuator.speed)


def mounted_solids(tree: Tree, actuators: Mapping[str, Actuator]) -> Iterator[tuple[str, Solid]]:
    """The solids of actuators, each with the link that holds it.

    Args:
        tree: in its final size.
        actuators: by joint name.
    """
    for joint in tree.joints:
        if joint.name in actuators:
            yield joint.parent, mounted_solid(actuators[joint.name], joint.parent_from_child, joint.axis)


def rated_torques(tree: Tree) -> dict[str, Scalar]:
    """The torques [N m] within which postures must keep, by joint name: rated ones, derated by the duty."""
    return {name: each.held for name, each in actuators_of(tree).items() if each.holds}


def actuators_of(tree: Tree) -> dict[str, Actuator]:
    """The actuators of a tree, by joint name."""
    return {joint.name: joint.actuator for joint in tree.joints if joint.actuator is not None}
