"""Directions that part hulls of corners, against coal and the rows of programs."""

from __future__ import annotations

import casadi as ca
import coal
import numpy as np
import pytest
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from evodesign.body.placement import Placement
from evodesign.collision.supports import ConvexShape
from evodesign.posture.placed_shape import BLEND, PlacedShape, placed_shape, smooth_max
from evodesign.posture.separating_axes import ways_of
from evodesign.tree.kinematics import Pose

RNG = np.random.default_rng(7)
HULL = RNG.standard_normal((14, 3)) * (0.05, 0.08, 0.03)
FLAT = np.array([[0.05, 0.0, 0.0], [0.0, 0.06, 0.0], [-0.05, -0.02, 0.0]])
OTHERS = {"hull": HULL[:9] * 0.7, "flat": FLAT, "single": FLAT[:1]}


def shape_of(points: np.ndarray) -> ConvexShape:
    return ConvexShape(Placement(), ball=1e-6, corners=tuple((x, y, z) for x, y, z in points.tolist()))


def placed(shape: ConvexShape, rotation: np.ndarray, position: np.ndarray) -> PlacedShape:
    return placed_shape(shape, Pose(ca.SX(ca.DM(rotation)), ca.SX(ca.DM(position))))


def column(shape: PlacedShape) -> np.ndarray:
    return np.array(ca.evalf(ca.densify(shape.numbers))).ravel()


def convex(points: np.ndarray) -> coal.Convex:
    hull = ConvexHull(points)
    corners, faces = coal.StdVec_Vec3s(), coal.StdVec_Triangle()
    corners.extend(list(points[hull.vertices]))
    place = {int(vertex): number for number, vertex in enumerate(hull.vertices)}
    faces.extend([coal.Triangle(*(place[int(vertex)] for vertex in face)) for face in hull.simplices])
    return coal.Convex(corners, faces)


@pytest.mark.parametrize("other", OTHERS)
def test_the_best_direction_parts_hulls_as_far_as_they_are_apart(other: str) -> None:
    """Never farther than coal says; where coal finds 10 mm, they are clear; in each other, nearly as deep."""
    points = OTHERS[other]
    thick = (
        points
        if other == "hull"
        else np.concatenate([points + 1e-7 * each for each in [*np.eye(3), *-np.eye(3)]])
    )
    geometries = convex(HULL), convex(thick)
    for rotation in Rotation.random(40, random_state=1).as_matrix():
        position = RNG.standard_normal(3) * 0.08
        pair = (placed(shape_of(HULL), np.eye(3), np.zeros(3)), placed(shape_of(points), rotation, position))
        by_coal = coal.distance(
            geometries[0], coal.Transform3s(), geometries[1], coal.Transform3s(rotation, position),
            coal.DistanceRequest(), coal.DistanceResult(),
        )  # fmt: skip
        (ways,) = ways_of([[(column(pair[0]), column(pair[1]))]])
        assert ways.distance <= by_coal + 1e-5
        assert ways.distance > 0.0 or by_coal < 0.01
        if by_coal < 0.0:
            assert ways.distance > by_coal - 1.5e-3
        row = float(ca.evalf(pair[0].apart_along(pair[1], ca.DM(ways.best))))
        assert row == pytest.approx(ways.distance, abs=1e-9)


def test_a_hull_beside_a_box_and_its_mirror_image() -> None:
    box = ConvexShape(Placement(), (0.03, 0.05, 0.02))
    plane = ca.DM([0.0, 1.0, 0.0]), ca.DM(0.0)
    for rotation in Rotation.random(20, random_state=2).as_matrix():
        position = RNG.standard_normal(3) * 0.1
        one = placed(box, np.eye(3), np.zeros(3))
        other = placed(shape_of(HULL), rotation, position)
        for each in (other, other.mirrored(plane)):
            (ways,) = ways_of([[(column(one), column(each))]])
            row = float(ca.evalf(one.apart_along(each, ca.DM(ways.best))))
            assert row == pytest.approx(ways.distance, abs=1e-9)
            away = np.array(ca.evalf(each.centre)).ravel()
            assert ways.distance <= float(np.linalg.norm(away))
        mirror = np.diag([1.0, -1.0, 1.0])
        seen = PlacedShape.of(ca.DM(column(other.mirrored(plane))))
        unit = np.array([0.6, 0.0, 0.8])
        farthest = float((HULL @ rotation.T @ mirror @ unit).max())
        assert farthest <= float(seen.support(ca.DM(unit))) <= farthest + 1e-3


def test_the_smooth_maximum_is_a_little_more_and_has_the_right_slope() -> None:
    values = RNG.standard_normal((5, 200)) * 1e-3
    found = smooth_max([*values])
    assert np.all(found >= values.max(axis=0))
    assert np.all(found <= values.max(axis=0) + 1.5 * BLEND)
    symbols = ca.SX.sym("x", 5)
    smooth = ca.Function("smooth", [symbols], [smooth_max(ca.vertsplit(symbols))])
    slope = ca.Function("slope", [symbols], [ca.gradient(smooth(symbols), symbols)])
    for point in values.T[:10]:
        steps = [(smooth(point + 1e-8 * e) - smooth(point - 1e-8 * e)) / 2e-8 for e in np.eye(5)]
        np.testing.assert_allclose(np.array(slope(point)).ravel(), np.array(steps, float).ravel(), atol=1e-5)
