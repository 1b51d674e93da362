"""Table I of the paper against quadrature of Eq. 3, and the algebra of inertia."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from evodesign.body.inertia import Inertia, total
from evodesign.body.placement import Placement, matrix_from_rpy, multiply, rpy_from_matrix, transpose
from evodesign.body.shape import Box, Cylinder, Shape, Solid, Sphere
from tests.pitches import pitches

sizes = st.floats(0.05, 2.0)
angles = st.floats(-3.0, 3.0)
coordinates = st.floats(-1.0, 1.0)
shapes = st.one_of(
    st.builds(Sphere, sizes), st.builds(Cylinder, sizes, sizes), st.builds(Box, sizes, sizes, sizes)
)
placements = st.builds(
    Placement.from_xyz_rpy,
    st.tuples(coordinates, coordinates, coordinates),
    st.tuples(angles, angles, angles),
)
solids = st.builds(Solid, shapes, placements, st.floats(100.0, 8000.0))


def cloud(shape: Shape) -> tuple[np.ndarray, np.ndarray]:
    """Gauss-Legendre points (n, 3) and volume weights (n,) of a shape about its centre."""
    nodes, weights = np.polynomial.legendre.leggauss(12)
    unit = (nodes + 1.0) / 2.0
    if isinstance(shape, Box):
        a, b, c = np.meshgrid(nodes * shape.x / 2, nodes * shape.y / 2, nodes * shape.z / 2, indexing="ij")
        w = np.einsum("i,j,k->ijk", weights, weights, weights) * shape.volume / 8.0
        return np.stack([a, b, c], -1).reshape(-1, 3), w.ravel()
    turns = np.arange(24) * 2.0 * math.pi / 24
    r, t, s = np.meshgrid(shape.radius * unit, turns, nodes, indexing="ij")
    w = np.einsum("i,j,k->ijk", weights / 2.0, np.full(24, 2.0 * math.pi / 24), weights)
    if isinstance(shape, Cylinder):
        points = np.stack([r * np.cos(t), r * np.sin(t), s * shape.length / 2.0], -1)
        return points.reshape(-1, 3), (w * r * shape.radius * shape.length / 2.0).ravel()
    rim = np.sqrt(1.0 - s**2)  # s is the cosine of the polar angle
    points = np.stack([r * rim * np.cos(t), r * rim * np.sin(t), r * s], -1)
    return points.reshape(-1, 3), (w * r**2 * shape.radius).ravel()


def by_quadrature(solid: Solid) -> tuple[float, np.ndarray, np.ndarray]:
    """Mass, centre and inertia about the link's origin by quadrature of Eq. 3."""
    points, volumes = cloud(solid.shape)
    rotation = np.array(solid.link_from_solid.rotation)
    points = points @ rotation.T + np.array(solid.link_from_solid.translation)
    masses = solid.density * volumes
    center = masses @ points / masses.sum()
    squares = np.einsum("n,nd,ne->de", masses, points, points)
    return float(masses.sum()), center, np.trace(squares) * np.eye(3) - squares


def about_origin(inertia: Inertia) -> np.ndarray:
    c = np.array(inertia.center)
    return np.array(inertia.about_center) + inertia.mass * (c @ c * np.eye(3) - np.outer(c, c))


@given(solids)
def test_inertia_of_a_placed_solid_is_the_integral_of_its_density(solid: Solid) -> None:
    mass, center, inertia = by_quadrature(solid)
    assert solid.inertia.mass == pytest.approx(mass, rel=1e-12)
    assert np.allclose(solid.inertia.center, center, atol=1e-12)
    assert np.allclose(about_origin(solid.inertia), inertia, rtol=1e-10, atol=1e-10 * mass)


@given(st.lists(solids, min_size=2, max_size=4))
def test_bodies_welded_together_have_the_sum_of_masses_and_moments(parts: list[Solid]) -> None:
    whole = total([part.inertia for part in parts])
    integrals = [by_quadrature(part) for part in parts]
    mass = sum(m for m, _, _ in integrals)
    assert whole.mass == pytest.approx(mass, rel=1e-12)
    assert np.allclose(whole.center, sum(m * c for m, c, _ in integrals) / mass, atol=1e-12)
    assert np.allclose(about_origin(whole), sum(i for _, _, i in integrals), rtol=1e-10, atol=1e-10 * mass)


@given(st.floats(0.05, 2.0), st.floats(0.05, 2.0))
def test_two_half_cylinders_make_a_whole_one(radius: float, length: float) -> None:
    half = Cylinder(radius, length / 2.0)
    up, down = (Placement(translation=(0.0, 0.0, s * length / 4.0)) for s in (1.0, -1.0))
    joined = total([Solid(half, place, 1000.0).inertia for place in (up, down)])
    whole = Solid(Cylinder(radius, length), Placement(), 1000.0).inertia
    assert joined.mass == pytest.approx(whole.mass)
    assert np.allclose(joined.about_center, whole.about_center, rtol=1e-10, atol=1e-12 * whole.mass)


@given(solids)
def test_principal_moments_obey_the_triangle_inequality(solid: Solid) -> None:
    a, b, c = np.linalg.eigvalsh(np.array(solid.inertia.about_center))
    assert a > 0.0
    assert a + b >= c * (1.0 - 1e-9)


@given(shapes, st.floats(0.3, 3.0))
def test_scaling_all_sizes_scales_mass_cubed_and_moments_to_the_fifth(shape: Shape, factor: float) -> None:
    fields = [getattr(shape, name) * factor for name in shape.__dataclass_fields__]
    larger = type(shape)(*fields)
    assert larger.volume == pytest.approx(shape.volume * factor**3)
    moments = np.array(shape.moments(shape.volume))
    assert np.allclose(larger.moments(larger.volume), moments * factor**5)


def test_massless_total_stays_at_the_origin() -> None:
    assert total([]) == Inertia()


@given(st.tuples(angles, pitches, angles))
def test_roll_pitch_and_yaw_survive_the_round_trip(rpy: tuple[float, float, float]) -> None:
    again = matrix_from_rpy(rpy_from_matrix(matrix_from_rpy(rpy)))
    assert np.allclose(again, matrix_from_rpy(rpy), rtol=0.0, atol=1e-12)


@given(st.tuples(angles, pitches, angles), st.tuples(angles, angles, angles))
def test_a_rotation_that_carries_rounding_keeps_its_place_when_upright(
    rpy: tuple[float, float, float], detour: tuple[float, float, float]
) -> None:
    there = matrix_from_rpy(detour)
    matrix = multiply(there, multiply(transpose(there), matrix_from_rpy(rpy)))
    assert np.allclose(matrix_from_rpy(rpy_from_matrix(matrix)), matrix, rtol=0.0, atol=1e-12)


@pytest.mark.parametrize("order", list(itertools.permutations(range(3))))
@pytest.mark.parametrize("signs", list(itertools.product((1.0, -1.0), repeat=2)))
def test_an_exact_quarter_turn_survives_the_round_trip(
    order: tuple[int, ...], signs: tuple[float, ...]
) -> None:
    first, second = (sign * np.eye(3)[i] for sign, i in zip(signs, order[:2], strict=True))
    turn = np.array([first, second, np.cross(first, second)])
    assert np.allclose(matrix_from_rpy(rpy_from_matrix(turn.tolist())), turn, rtol=0.0, atol=1e-12)


@given(placements, placements, placements)
def test_placements_chain_associatively(a: Placement, b: Placement, c: Placement) -> None:
    left, right = (a @ b) @ c, a @ (b @ c)
    assert np.allclose(left.translation, right.translation, atol=1e-12)
    assert np.allclose(left.rotation, right.rotation, atol=1e-12)


@given(solids)
def test_placing_a_solid_leaves_its_principal_moments(solid: Solid) -> None:
    alone = sorted(solid.shape.moments(solid.mass))
    placed = np.linalg.eigvalsh(np.array(solid.inertia.about_center))
    assert np.allclose(placed, alone, rtol=1e-9, atol=1e-12 * solid.mass)
