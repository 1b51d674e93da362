"""What bodies are asked to be apart where the robot's build leaves them less."""

from __future__ import annotations

from itertools import pairwise

import coal
import numpy as np
import pytest
import trimesh
from scipy.spatial.transform import Rotation

from evodesign.body.inertia import Inertia
from evodesign.body.placement import Placement
from evodesign.body.shape import Sphere
from evodesign.collision.margins import LET_THROUGH, fitted_margins, narrow_margins
from evodesign.collision.rules import CollisionRules
from evodesign.tree.model import Joint, JointKind, Link, Look, Mesh, Tree
from evodesign.tree.surface import surface_of
from tests.collision.chains import two_links


def chain(*places: float) -> Tree:
    """Balls of 0.1 m along x, each on a joint of the one before."""
    names = [f"ball {number}" for number in range(len(places))]
    links = [Link(n, own_inertia=Inertia(1.0), looks=(Look(Sphere(0.1), Placement()),)) for n in names]
    steps = [place - before for before, place in pairwise(places)]
    joints = [
        Joint(
            f"joint {number}",
            JointKind.REVOLUTE,
            names[number],
            names[number + 1],
            Placement(translation=(step, 0.0, 0.0)),
            (0.0, 0.0, 1.0),
            -1.0,
            1.0,
        )
        for number, step in enumerate(steps)
    ]
    return Tree("chain", tuple(links), tuple(joints))


def test_what_is_built_nearer_than_the_margin_keeps_what_it_has() -> None:
    tree = chain(0.0, 0.1, 0.202, 0.5, 0.69)
    pairs = [("ball 0", "ball 2"), ("ball 0", "ball 3"), ("ball 2", "ball 3"), ("ball 3", "ball 4")]
    narrow = narrow_margins(tree, pairs, 0.005)
    assert narrow == {("ball 0", "ball 2"): pytest.approx(0.202 - 0.2, abs=1e-6)}
    rules = CollisionRules(0.005, tuple(pairs), narrow=narrow)
    assert rules.margin_of(("ball 2", "ball 0")) == pytest.approx(0.002, abs=1e-6)
    assert rules.margin_of(("ball 0", "ball 3")) == 0.005
    assert rules.margin_of(("ball 3", "ball 4")) == 0.005  # in each other at zero, as arms beside hips are


WALLS = {
    (1, 0): (0.01, 0.21, 0.05),
    (-1, 0): (0.01, 0.21, 0.05),
    (0, 1): (0.21, 0.01, 0.05),
    (0, -1): (0.21, 0.01, 0.05),
}
"""Sides [m] of the walls of a hollow square, 10 cm from its middle along x and y."""


def cage(length: float) -> Tree:
    """The walls as one mesh, and a rod of a length [m] that turns about their middle."""
    walls = [
        trimesh.creation.box(sides).apply_translation((0.1 * x, 0.1 * y, 0.0))
        for (x, y), sides in WALLS.items()
    ]
    meshes = {"frame": trimesh.util.concatenate(walls), "bar": trimesh.creation.box((length, 0.01, 0.01))}
    frame, bar = (
        Link(
            name,
            own_inertia=Inertia(1.0),
            meshes=(Mesh(name, surface=surface_of(mesh.vertices, mesh.faces, 0.0)),),
        )
        for name, mesh in meshes.items()
    )
    return two_links(frame, bar)


def test_shapes_that_fill_a_hollow_have_no_rows_where_nothing_overlaps() -> None:
    """The box of the cage holds a rod of 10 cm in all postures."""
    found = fitted_margins(cage(0.1), ["to middle", "to bar"], [("frame", "bar")], 0.005)
    assert found == {("frame", "bar"): -np.inf}


def test_the_margin_of_coarse_shapes_errs_least_in_postures() -> None:
    """Of all margins, in postures of the test's own, in which the walls are coal's boxes."""
    tree, length = cage(0.2), 0.2
    margin = fitted_margins(tree, ["to middle", "to bar"], [("frame", "bar")], 0.005)["frame", "bar"]
    rod, whole, rng = coal.Box(length, 0.01, 0.01), coal.Box(0.21, 0.21, 0.05), np.random.default_rng(7)

    def distance(box: coal.Box, place: tuple[float, float, float], turn: coal.Transform3s) -> float:
        there = coal.Transform3s(np.eye(3), np.array(place))
        return float(coal.distance(box, there, rod, turn, coal.DistanceRequest(), coal.DistanceResult()))

    found = []
    for about_y, about_z in rng.uniform(-1.5, 1.5, (1000, 2)):
        rows = Rotation.from_euler("YZ", [about_y, about_z]).as_matrix()
        turn = coal.Transform3s(rows, np.zeros(3))
        walls = min(
            distance(coal.Box(*sides), (0.1 * x, 0.1 * y, 0.0), turn) for (x, y), sides in WALLS.items()
        )
        found.append((distance(whole, (0.0, 0.0, 0.0), turn), walls < 0.0))
    fitted, overlap = np.array(found).T

    def errs(least: float) -> float:
        return float(
            np.mean((fitted < least) & (overlap == 0.0))
            + LET_THROUGH * np.mean((fitted >= least) & (overlap == 1.0))
        )

    assert 0.05 < overlap.mean() < 0.5
    assert errs(margin) < min(map(errs, [-np.inf, *np.linspace(-0.06, 0.005, 200)])) + 0.02
