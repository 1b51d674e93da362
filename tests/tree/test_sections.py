"""Links of other sections: masses and moments by formulas of the test's own, and by points that are moved."""

from __future__ import annotations

import itertools
import math

import casadi as ca
import numpy as np
import pytest

from evodesign.body.inertia import Inertia
from evodesign.body.placement import Placement
from evodesign.body.shape import Box, Cylinder, Solid, Sphere
from evodesign.errors import ModelError
from evodesign.tree.model import Joint, JointKind, Link, Tree
from evodesign.tree.sections import section_of, with_sections

FACTOR = 1.3


def arm(*solids: Solid, inertia: Inertia | None = None) -> Tree:
    """A base, a link along z, and a hand at its end."""
    link = Link("arm", solids, Inertia() if inertia is None else inertia)
    joints = (
        Joint("first", JointKind.REVOLUTE, "base", "arm", Placement(), (0.0, 1.0, 0.0), -1.0, 1.0),
        Joint(
            "second",
            JointKind.REVOLUTE,
            "arm",
            "hand",
            Placement(translation=(0.01, 0.0, 0.4)),
            (0.0, 1.0, 0.0),
            -1.0,
            1.0,
        ),
    )
    base, hand = (Link(name, (Solid(Sphere(0.05), Placement(), 500.0),)) for name in ("base", "hand"))
    return Tree("arm", (base, link, hand), joints)


def solid(shape: Box | Cylinder | Sphere, **hollow: float) -> Solid:
    return Solid(shape, Placement(translation=(0.0, 0.0, 0.2)), 1000.0, **hollow)


def widened(tree: Tree, factor: object = FACTOR, across: tuple[float, float, float] | None = None) -> Link:
    changed = with_sections(tree, [(section_of(tree, "arm", across), factor)])
    assert changed.joints == tree.joints, "joints stay"
    return changed.link_by_name["arm"]


def test_a_cylinder_gets_a_larger_radius_and_the_square_of_its_mass() -> None:
    link = widened(arm(solid(Cylinder(0.03, 0.4))))
    radius, mass = 0.03 * FACTOR, 1000.0 * math.pi * (0.03 * FACTOR) ** 2 * 0.4
    assert link.solids[0].shape == Cylinder(radius, 0.4)
    assert float(link.mass) == pytest.approx(mass)
    about = np.array(link.inertia.about_center)
    assert about[2, 2] == pytest.approx(mass * radius**2 / 2.0)
    assert about[0, 0] == pytest.approx(mass * (3.0 * radius**2 + 0.4**2) / 12.0)


def test_a_hollow_cylinder_keeps_its_wall() -> None:
    link = widened(arm(solid(Cylinder(0.03, 0.4), wall=0.002, filling=0.1)))
    outer, inner = 0.03 * FACTOR, 0.03 * FACTOR - 0.002
    wall = 1000.0 * math.pi * (outer**2 * 0.4 - inner**2 * 0.396)
    assert float(link.mass) == pytest.approx(wall + 0.1)


def test_a_box_changes_both_sides_across_or_the_one_that_is_named() -> None:
    tree = arm(solid(Box(0.05, 0.07, 0.4)))
    assert widened(tree).solids[0].shape.sides == pytest.approx((0.05 * FACTOR, 0.07 * FACTOR, 0.4))
    one = widened(tree, across=(0.0, 3.0, 0.0))
    assert one.solids[0].shape.sides == pytest.approx((0.05, 0.07 * FACTOR, 0.4))


def test_an_inertia_of_a_file_is_that_of_points_moved_across() -> None:
    """A cloud of points of the same moments, each moved away from the link's axis through its centre."""
    generator = np.random.default_rng(4)
    points = generator.standard_normal((400, 3)) * [0.02, 0.03, 0.12] + [0.01, -0.02, 0.2]
    points -= points.mean(axis=0) - [0.01, -0.02, 0.2]
    mass, center = 2.0, points.mean(axis=0)

    def moments(cloud: np.ndarray, total: float) -> np.ndarray:
        off = cloud - cloud.mean(axis=0)
        each = total / len(cloud)
        return each * (np.eye(3) * np.sum(off * off) - off.T @ off)

    before = moments(points, mass)
    given = Inertia(mass, tuple(center), tuple(map(tuple, before.tolist())))
    tree = arm(inertia=given)
    change = section_of(tree, "arm")
    found = widened(tree).own_inertia
    stretch = np.eye(3) + sum((FACTOR - 1.0) * np.outer(axis, axis) for axis in map(np.array, change.across))
    after = moments((points - center) @ stretch + center, mass * FACTOR**2)
    assert float(found.mass) == pytest.approx(mass * FACTOR**2)
    assert np.array(found.center) == pytest.approx(center)
    assert np.array(found.about_center) == pytest.approx(after, rel=1e-9)
    along = np.array(change.along)
    for one, other in itertools.combinations([along, *map(np.array, change.across)], 2):
        assert one @ other == pytest.approx(0.0, abs=1e-12)


def test_one_is_the_same_link_and_an_expression_gives_the_same_numbers() -> None:
    tree = arm(solid(Box(0.05, 0.07, 0.4)), solid(Cylinder(0.03, 0.3)))
    assert (
        with_sections(tree, [(section_of(tree, "arm"), 1.0)]).link_by_name["arm"] is tree.link_by_name["arm"]
    )
    symbol = ca.SX.sym("s")
    link = widened(tree, symbol)
    about = ca.vertcat(*[ca.vertcat(*row) for row in link.inertia.about_center])
    numbers = ca.Function("numbers", [symbol], [ca.vertcat(link.mass, about)])(FACTOR)
    plain = widened(tree)
    expected = [float(plain.mass), *np.array(plain.inertia.about_center).ravel()]
    assert np.array(numbers).ravel() == pytest.approx(expected)


@pytest.mark.parametrize(
    ("across", "shape", "wanted"),
    [
        ((0.0, 0.0, 0.0), Box(0.05, 0.07, 0.4), "an axis of some length"),
        ((0.0, 0.1, 1.0), Box(0.05, 0.07, 0.4), "an axis across the link's own"),
        ((1.0, 0.0, 0.0), Cylinder(0.03, 0.4), "boxes, for one axis alone"),
    ],
)
def test_axes_that_say_nothing_are_refused(
    across: tuple[float, float, float], shape: Box | Cylinder, wanted: str
) -> None:
    with pytest.raises(ModelError, match=wanted):
        section_of(arm(solid(shape)), "arm", across)
