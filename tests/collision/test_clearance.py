"""Distances of bodies against closed forms, MuJoCo, and points that lie in both."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations

import mujoco
import numpy as np
import pytest

from evodesign.body.inertia import Inertia
from evodesign.body.placement import Placement, matrix_from_rpy
from evodesign.body.shape import Box, Cylinder, Shape, Sphere
from evodesign.collision.clearance import PlacedSolids, SolidBodies, places_of
from evodesign.collision.pairs import checked_pairs
from evodesign.collision.scene_bodies import CheckedBodies, SceneBodies
from evodesign.collision.shapes import solids_of
from evodesign.tree.model import Joint, JointKind, Link, Look, Mesh, Tree
from evodesign.tree.surface import surface_of

SHAPES: tuple[Shape, ...] = (Sphere(0.08), Cylinder(0.05, 0.3), Box(0.2, 0.1, 0.3))
OF_MUJOCO = ("sphere", "cylinder", "box")


def body(name: str, shape: Shape) -> Link:
    return Link(name, own_inertia=Inertia(1.0), looks=(Look(shape, Placement()),))


def pair(one: Link, other: Link, other_at: Placement) -> PlacedSolids:
    joint = Joint("joint", JointKind.FIXED, one.name, other.name, Placement())
    bodies = SolidBodies.of_tree(Tree("two", (one, other), (joint,)))
    return bodies.placed({one.name: Placement(), other.name: other_at})


def distance(one: Shape, other: Shape, other_at: Placement) -> float:
    placed = pair(body("one", one), body("other", other), other_at)
    return placed.nearest(places_of(placed.names, [("one", "other")])).distance


def random_placement(rng: np.random.Generator, far: float = 0.4) -> Placement:
    xyz = rng.uniform(-far, far, 3).tolist()
    return Placement(matrix_from_rpy(rng.uniform(-3.0, 3.0, 3).tolist()), (xyz[0], xyz[1], xyz[2]))


def by_mujoco(shapes: tuple[int, int], place: Placement) -> float:
    """The distance of two of SHAPES in MuJoCo, up to a metre."""
    sizes = {"sphere": "0.08", "cylinder": "0.05 0.15", "box": "0.1 0.05 0.15"}
    geoms = [f'<geom type="{OF_MUJOCO[k]}" size="{sizes[OF_MUJOCO[k]]}"/>' for k in shapes]
    xml = f"<mujoco><worldbody><body>{geoms[0]}</body><body>{geoms[1]}</body></worldbody></mujoco>"
    model = mujoco.MjModel.from_xml_string(xml)
    data = mujoco.MjData(model)
    model.body_pos[2] = place.translation
    quaternion = np.zeros(4)
    mujoco.mju_mat2Quat(quaternion, np.array(place.rotation).ravel())
    model.body_quat[2] = quaternion
    mujoco.mj_forward(model, data)
    return float(mujoco.mj_geomDistance(model, data, 0, 1, 1.0, np.zeros(6)))


@pytest.mark.parametrize(
    ("one", "other", "at", "expected"),
    [
        (Sphere(0.1), Sphere(0.2), (0.5, 0.0, 0.0), 0.2),
        (Sphere(0.1), Sphere(0.2), (0.0, 0.25, 0.0), -0.05),
        (Box(0.2, 0.2, 0.2), Sphere(0.1), (0.3, 0.3, 0.0), 0.2 * np.sqrt(2.0) - 0.1),
        (Cylinder(0.1, 0.4), Cylinder(0.1, 0.4), (0.15, 0.0, 0.0), -0.05),
        (Cylinder(0.1, 0.4), Box(0.2, 0.2, 0.2), (0.0, 0.0, 0.37), 0.07),
    ],
)
def test_distances_in_closed_form(
    one: Shape, other: Shape, at: tuple[float, float, float], expected: float
) -> None:
    assert distance(one, other, Placement(translation=at)) == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize("shapes", [(i, j) for i in range(3) for j in range(i, 3)])
def test_distances_apart_are_those_of_mujoco(shapes: tuple[int, int]) -> None:
    rng = np.random.default_rng(sum(shapes))
    compared = 0
    for _ in range(60):
        place = random_placement(rng)
        ours, theirs = distance(SHAPES[shapes[0]], SHAPES[shapes[1]], place), by_mujoco(shapes, place)
        if theirs > 1e-3:
            assert ours == pytest.approx(theirs, abs=2e-4)
            compared += 1
        else:
            assert ours < 2e-3
    assert compared > 10


def inside(points: np.ndarray, shape: Shape) -> np.ndarray:
    """Which points of a shape's frame lie in it."""
    if isinstance(shape, Sphere):
        return np.asarray(np.linalg.norm(points, axis=1) < shape.radius)
    if isinstance(shape, Cylinder):
        flat = np.linalg.norm(points[:, :2], axis=1) < shape.radius
        return np.asarray(flat & (np.abs(points[:, 2]) < shape.length / 2.0))
    return np.asarray((np.abs(points) < np.array(shape.sides) / 2.0).all(axis=1))


@pytest.mark.parametrize("seed", range(4))
def test_bodies_overlap_where_a_point_lies_in_both(seed: int) -> None:
    rng, seen = np.random.default_rng(seed), {True: 0, False: 0}
    points = rng.uniform(-0.25, 0.25, (40_000, 3))
    for _ in range(40):
        one, other = (SHAPES[int(rng.integers(3))] for _ in range(2))
        place = random_placement(rng, far=0.2)
        found = distance(one, other, place)
        rotation, origin = np.array(place.rotation), np.array(place.translation)
        both = bool((inside(points, one) & inside((points - origin) @ rotation, other)).any())
        if abs(found) > 0.015:  # thinner overlaps may hold no point of so many
            assert both == (found < 0.0)
            seen[both] += 1
    assert min(seen.values()) > 3


def test_a_mesh_counts_as_its_hull_stretched_as_it_is() -> None:
    corners = [(x, y, z) for x in (-0.1, 0.1) for y in (-0.05, 0.05) for z in (-0.15, 0.15)]
    faces = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6)]
    faces += [(0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)]
    surface = surface_of(np.array(corners), np.array(faces), 0.009)
    mesh = Mesh("box.stl", surface=surface)
    longer = replace(mesh, stretch=((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 2.0)))
    for shown, box in ((mesh, Box(0.2, 0.1, 0.3)), (longer, Box(0.2, 0.1, 0.6))):
        link = Link("one", own_inertia=Inertia(1.0), meshes=(shown,))
        at = Placement(matrix_from_rpy((0.3, 0.2, 0.1)), (0.05, 0.1, 0.42))
        placed = pair(link, body("other", SHAPES[0]), at)
        found = placed.nearest(places_of(placed.names, [("one", "other")]))
        assert found.distance == pytest.approx(distance(box, SHAPES[0], at), abs=1e-4)


def test_the_hull_of_a_mesh_that_a_design_leaves_alone_is_made_once() -> None:
    corners = np.array([(0.0, 0.0, 0.0), (0.1, 0.0, 0.0), (0.0, 0.1, 0.0), (0.0, 0.0, 0.1)])
    mesh = Mesh("corner.stl", surface=surface_of(corners, np.array([(0, 2, 1)]), 0.0))
    longer = replace(mesh, stretch=((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 2.0)))
    one, again, other = (
        solids_of(Link("one", own_inertia=Inertia(mass), meshes=(shown,)))[0]
        for mass, shown in ((1.0, mesh), (2.0, replace(mesh)), (1.0, longer))
    )
    assert one is again
    assert other.half_sides == pytest.approx(one.half_sides * [1.0, 1.0, 2.0])


def test_the_nearest_of_many_is_found_and_the_overlapping_ones() -> None:
    rng = np.random.default_rng(1)
    names = [f"link {number}" for number in range(12)]
    joints = [Joint(n, JointKind.FIXED, names[0], n, Placement()) for n in names[1:]]
    links = [body(name, SHAPES[number % 3]) for number, name in enumerate(names)]
    bodies = SolidBodies.of_tree(Tree("many", tuple(links), tuple(joints)))
    for _ in range(20):
        frames = {name: random_placement(rng) for name in names}
        placed = bodies.placed(frames)
        pairs = [(a, b) for i, a in enumerate(names) for b in names[i + 1 :]]
        places = places_of(placed.names, pairs)
        each = {p: placed.nearest(places_of(placed.names, [p])).distance for p in pairs}
        nearest = placed.nearest(places)
        assert nearest.distance == min(each.values()) == each[nearest.first, nearest.second]
        overlapping = {(gap.first, gap.second): gap.distance for gap in placed.overlapping(places)}
        assert overlapping == {p: found for p, found in each.items() if found < 0.0}
        assert placed.in_each_other(places) == {(0, *pair) for pair in overlapping}


def test_many_postures_at_once_have_the_distances_of_each() -> None:
    rng, count = np.random.default_rng(2), 9
    names = [f"link {number}" for number in range(6)]
    links = [body(name, SHAPES[number % 3]) for number, name in enumerate(names)]
    joints = [Joint(n, JointKind.FIXED, names[0], n, Placement()) for n in names[1:]]
    bodies = SolidBodies.of_tree(Tree("many", tuple(links), tuple(joints)))
    frames = [[random_placement(rng) for _ in names] for _ in range(count)]
    turns = np.array([[place.rotation for place in each] for each in frames], float)
    origins = np.array([[place.translation for place in each] for each in frames], float)
    together, pairs = bodies.placed_at(turns, origins), places_of(bodies.names, combinations(names, 2))
    assert together.postures == count
    alone = [bodies.placed(dict(zip(names, each, strict=True))) for each in frames]
    gaps = {
        (number, gap.first, gap.second): gap.distance
        for number, placed in enumerate(alone)
        for gap in placed.overlapping(pairs, 0.02)
    }
    assert together.gaps(together.in_all(pairs), 0.02) == gaps
    assert together.in_each_other(together.in_all(pairs)) == {key for key, gap in gaps.items() if gap < 0.0}
    assert len({number for number, *_ in gaps}) > count // 2


def test_an_agent_without_any_shape_touches_nothing_and_leaves_the_others_what_they_are() -> None:
    joint = Joint("joint", JointKind.REVOLUTE, "one", "other", Placement(), (0.0, 1.0, 0.0), -1.0, 1.0)
    links = (Link("one", own_inertia=Inertia(1.0)), Link("other", own_inertia=Inertia(1.0)))
    tree = Tree("bare", links, (joint,))
    bare = SolidBodies.of_tree(tree)
    frames = {"one": Placement(), "other": Placement()}
    placed = bare.placed(frames)
    assert placed.overlapping(places_of(placed.names, [("one", "other")])) == []
    assert checked_pairs(tree, ["joint"], ["other"], ["one"]) == ()
    two = SolidBodies(("a", "b"), tuple(solid for link in map(_ball, "ab") for solid in solids_of(link)))
    there = {"a": Placement(), "b": Placement(translation=(0.3, 0.0, 0.0))}
    both = placed.beside(two.placed(there))
    assert both.nearest(places_of(both.names, [("a", "b"), ("one", "a")])).distance == pytest.approx(0.1)


def test_a_scene_with_an_agent_without_any_shape_finds_what_the_others_overlap_with() -> None:
    bare = CheckedBodies.of(Tree("bare", (Link("one", own_inertia=Inertia(1.0)),), ()), [])
    ball = CheckedBodies.of(Tree("ball", (_ball("a"),), ()), [("a", "load"), ("a", "floor")])
    scene = SceneBodies({"robot": bare, "human": ball}, (0.2, 0.2, 0.2))

    def at(links: Sequence[str]) -> np.ndarray:
        return np.array([np.eye(4) for _ in links])

    found = scene.near({"robot": (np.eye(3), at), "human": (np.diag([-1.0, -1.0, 1.0]), at)}, 0.15)
    assert {(gap.first, gap.second): pytest.approx(gap.distance) for gap in found} == {
        ("human a", "load"): -0.05,
        ("human a", "floor"): -0.1,
    }


def _ball(name: str) -> Link:
    return body(name, Sphere(0.1))
