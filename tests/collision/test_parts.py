"""PartClearance between actuators and links, beside MuJoCo's distances and points on housings."""

from __future__ import annotations

import math
from itertools import combinations

import mujoco
import numpy as np
import pytest

from evodesign.body.placement import Placement
from evodesign.body.shape import Box, Cylinder, Solid, Sphere
from evodesign.collision.parts import PART, clearance_in, part_clearance
from evodesign.design.space import DesignSpace
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.shipped import SHIPPED
from evodesign.problem.source import read_source
from evodesign.tree.frames import link_frames
from evodesign.tree.model import JointKind, Tree

SIZES = {
    "waist": 12.0,
    "hip": 18.0,
    "hip_yaw": 18.0,
    "knee": 14.0,
    "ankle": 10.0,
    "torso": 15.0,
    "shoulder": 14.0,
    "elbow": 6.0,
}
"""Rated torques [N m], about those of a design."""


@pytest.fixture(scope="module")
def geometry() -> DesignProblem:
    return build_problem(read_source(SHIPPED / "icub_geometry.toml"))


def designed(problem: DesignProblem, share: float) -> Tree:
    """The tree of a design, each of whose parameters is so far between its bounds."""
    space: DesignSpace = problem.space
    values = space.values((share,) * len(space.parameters))
    sizes = {f"margin.{name}": size for name, size in SIZES.items()}
    return space.resized(problem.scene.designed_tree, space.given(values, sizes))


class World:
    """The tree at zero in MuJoCo: solids of links, and housings from the joints' own figures."""

    def __init__(self, tree: Tree) -> None:
        spec, frames = mujoco.MjSpec(), link_frames(tree, Placement(), {})
        self.names: list[str] = []
        for joint in tree.joints:
            if joint.actuator is not None and joint.actuator.mounting is not None:
                place, mounting = frames[joint.child], joint.actuator.mounting
                diameter, length = map(float, joint.actuator.size)
                axis = np.array(place.rotation, float) @ np.array(joint.axis, float)
                middle = np.array(place.translation, float) + mounting.share * length * axis
                ends = np.concatenate([middle - axis * length / 2.0, middle + axis * length / 2.0])
                kind = mujoco.mjtGeom.mjGEOM_CYLINDER
                spec.worldbody.add_geom(type=kind, size=[diameter / 2.0, 0.0, 0.0], fromto=ends)
                self.names.append(f"{PART}{joint.name}")
        for link in tree.links:
            for solid in link.solids:
                place = frames[link.name] @ solid.link_from_solid
                quaternion = np.empty(4)
                mujoco.mju_mat2Quat(quaternion, np.array(place.rotation, float).ravel())
                kind, size = shaped(solid)
                spec.worldbody.add_geom(type=kind, size=size, pos=place.translation, quat=quaternion)
                self.names.append(link.name)
        self.model = spec.compile()
        self.data = mujoco.MjData(self.model)
        mujoco.mj_forward(self.model, self.data)

    def distance(self, one: int, other: int) -> float:
        return float(mujoco.mj_geomDistance(self.model, self.data, one, other, 10.0, np.zeros(6)))


def shaped(solid: Solid) -> tuple[int, list[float]]:
    shape = solid.shape
    if isinstance(shape, Sphere):
        return mujoco.mjtGeom.mjGEOM_SPHERE, [float(shape.radius), 0.0, 0.0]
    if isinstance(shape, Cylinder):
        return mujoco.mjtGeom.mjGEOM_CYLINDER, [float(shape.radius), float(shape.length) / 2.0, 0.0]
    return mujoco.mjtGeom.mjGEOM_BOX, [float(side) / 2.0 for side in shape.sides]


def moving_between(tree: Tree, one: str, other: str) -> int:
    """How many joints that are not fixed are between two links, by walking up from both."""
    above = [dict.fromkeys(tree.to_root(name)) for name in (one, other)]
    different = above[0].keys() ^ above[1].keys()
    return sum(tree.parent_joint[link].kind is not JointKind.FIXED for link in different)


@pytest.mark.parametrize("share", [0.0, 0.3, 0.7, 1.0])
def test_room_is_that_of_another_library_over_all_pairs(geometry: DesignProblem, share: float) -> None:
    tree = designed(geometry, share)
    world, holders = World(tree), {f"{PART}{joint.name}": joint.parent for joint in tree.joints}
    found: dict[frozenset[str], float] = {}
    for one, other in combinations(range(len(world.names)), 2):
        names = world.names[one], world.names[other]
        if not names[0].startswith(PART):
            continue  # two links
        if names[1].startswith(PART) or moving_between(tree, holders[names[0]], names[1]) > 1:
            pair = frozenset(names)
            found[pair] = min(found.get(pair, math.inf), world.distance(one, other))
    for joint in tree.joints:
        actuator = joint.actuator
        if actuator is not None and actuator.mounting is not None and actuator.mounting.share == 0.0:
            axis = np.array(joint.parent_from_child.rotation, float) @ np.array(joint.axis, float)
            diameter, length = map(float, actuator.size)
            solids = tree.link_by_name[joint.parent].solids
            found[frozenset((f"{PART}{joint.name}", joint.parent))] = max(
                clearance_in(solid, axis, diameter / 2.0, length / 2.0) for solid in solids
            )
    before = World(geometry.scene.designed_tree)
    for joint in tree.joints:
        pair = joint.parent, joint.child
        if {*pair} <= {*world.names}:
            apart, built = (
                min(
                    each.distance(one, other)
                    for one, a in enumerate(each.names)
                    for other, b in enumerate(each.names)
                    if (a, b) == pair
                )
                for each in (world, before)
            )
            if apart - max(0.0, built) > 1e-6:
                found[frozenset(pair)] = max(0.0, built) - apart
    loose = set()
    for part in (name for name in world.names if name.startswith(PART)):
        solids = [number for number, name in enumerate(world.names) if name == holders[part]]
        apart = min(world.distance(world.names.index(part), solid) for solid in solids)
        if apart > 1e-6:
            loose.add(part.removeprefix(PART))
            assert found[frozenset((part, holders[part]))] > 0.0
            found[frozenset((part, holders[part]))] = -apart
    assert loose == ({"l_wrist_prosup", "r_wrist_prosup"} if share == 1.0 else set())
    room = part_clearance(tree, geometry.scene.designed_tree)
    assert room is not None
    lacking = -sum(min(0.0, distance) for distance in found.values())
    assert room.lacking == pytest.approx(lacking, abs=3e-5)
    least = min(found.values())
    assert room.least.distance == pytest.approx(least, abs=2e-6)
    assert found[frozenset((room.least.first, room.least.second))] == pytest.approx(least, abs=2e-6)
    assert room.apart == (-room.lacking if lacking > 0.0 else room.least.distance)
    assert all(found[frozenset(names)] < 0.0 for names in room.decisive) == (lacking > 0.0)
    assert len(room.decisive) == max(1, sum(distance < -1e-9 for distance in found.values()))
    assert part_clearance(tree, geometry.scene.designed_tree, room.decisive) == room


HOLDERS = [Sphere(0.08), Cylinder(0.06, 0.3), Cylinder(0.04, 0.2), Box(0.1, 0.08, 0.3), Box(0.2, 0.1, 0.12)]


@pytest.mark.parametrize("shape", HOLDERS)
@pytest.mark.parametrize("axis", [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)])
def test_a_holder_is_as_much_thicker_as_the_points_of_a_housing_lie_within_it(
    shape: Sphere | Cylinder | Box, axis: tuple[float, float, float]
) -> None:
    """Points on both rims; the holder is turned about all axes, and the housing with it."""
    radius, half = 0.045, 0.02
    place = Placement.from_xyz_rpy((0.1, -0.2, 0.05), (0.4, -0.9, 1.3))
    turn = np.array(place.rotation, float)
    along = np.array(axis)
    across = np.roll(along, 1)
    angles = np.linspace(0.0, 2.0 * math.pi, 721)
    rims = np.outer(np.cos(angles), across) + np.outer(np.sin(angles), np.cross(along, across))
    points = np.vstack([radius * rims + end * half * along for end in (-1.0, 1.0)])
    if isinstance(shape, Sphere):
        wanted = float(shape.radius) - np.linalg.norm(points, axis=1).max()
    elif isinstance(shape, Cylinder):
        wanted = float(shape.radius) - np.linalg.norm(points[:, :2], axis=1).max()
    else:
        sides = np.array(shape.sides, float)
        short = np.argsort(sides)[:2]
        wanted = float((sides / 2.0 - np.abs(points).max(axis=0))[short].min())
    found = clearance_in(Solid(shape, place, 1000.0), turn @ along, radius, half)
    assert found == pytest.approx(wanted, abs=1e-6)
