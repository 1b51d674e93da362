"""Hollow solids and beams, each against a computation that shares nothing with the formula."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from numpy.polynomial.legendre import leggauss

from evodesign.body.placement import Placement
from evodesign.body.shape import Box, Cylinder, Shape, Solid, Sphere
from evodesign.hardware.structure import (
    STRENGTHS,
    Failure,
    RectangularTube,
    RoundTube,
    Section,
    SectionLoad,
    bending_work,
    buckling_force,
    safety_factors,
    torsion_work,
    von_mises,
    wall_buckling_stress,
)

NODES, WEIGHTS = leggauss(12)


def over(lower: float, upper: float) -> tuple[np.ndarray, np.ndarray]:
    """Nodes and weights of Gauss's quadrature."""
    half = (upper - lower) / 2.0
    return lower + half * (NODES + 1.0), half * WEIGHTS


def second_moments(shape: Shape) -> np.ndarray:
    """Integrals of 1, x^2, y^2, z^2 over a full shape by quadrature."""
    total = np.zeros(4)
    if isinstance(shape, Box):
        grids = [over(-side / 2, side / 2) for side in shape.sides]
        for x, a in zip(*grids[0], strict=True):
            for y, b in zip(*grids[1], strict=True):
                for z, c in zip(*grids[2], strict=True):
                    total += a * b * c * np.array([1.0, x * x, y * y, z * z])
        return total
    angles, angle_weights = np.arange(32) * math.tau / 32, np.full(32, math.tau / 32)
    if isinstance(shape, Cylinder):
        heights = over(-shape.length / 2, shape.length / 2)
        for r, a in zip(*over(0.0, shape.radius), strict=True):
            for angle, b in zip(angles, angle_weights, strict=True):
                x, y = r * math.cos(angle), r * math.sin(angle)
                for z, c in zip(*heights, strict=True):
                    total += a * b * c * r * np.array([1.0, x * x, y * y, z * z])
        return total
    cosines = over(-1.0, 1.0)
    for r, a in zip(*over(0.0, shape.radius), strict=True):
        for angle, b in zip(angles, angle_weights, strict=True):
            for cosine, c in zip(*cosines, strict=True):
                sine = math.sqrt(1 - cosine * cosine)
                x, y, z = r * sine * math.cos(angle), r * sine * math.sin(angle), r * cosine
                total += a * b * c * r * r * np.array([1.0, x * x, y * y, z * z])
    return total


@pytest.mark.parametrize(
    ("shape", "smaller"),
    [
        (Box(0.1, 0.2, 0.3), Box(0.094, 0.194, 0.294)),
        (Cylinder(0.05, 0.3), Cylinder(0.047, 0.294)),
        (Sphere(0.08), Sphere(0.077)),
    ],
)
def test_mass_and_inertia_of_a_hollow_solid_are_those_of_quadrature(shape: Shape, smaller: Shape) -> None:
    solid = Solid(shape, Placement(), 2700.0, wall=0.003, filling=0.4)
    outer, inner = second_moments(shape), second_moments(smaller)
    volume, x, y, z = 2700.0 * (outer - inner) + 0.4 / outer[0] * outer
    assert solid.mass == pytest.approx(volume, rel=1e-9)
    inertia = solid.inertia.about_center
    assert [inertia[i][i] for i in range(3)] == pytest.approx([y + z, x + z, x + y], rel=1e-9)


def test_a_wall_that_leaves_no_room_gives_back_the_full_solid() -> None:
    full = Solid(Box(0.1, 0.2, 0.3), Placement(), 1000.0)
    thick = Solid(Box(0.1, 0.2, 0.3), Placement(), 1000.0, wall=0.05)
    assert thick.mass == pytest.approx(full.mass, rel=1e-12)
    for row, wanted in zip(thick.inertia.about_center, full.inertia.about_center, strict=True):
        assert row == pytest.approx(wanted)


def integral(section: Section, value: Callable[[float, float], float]) -> float:
    """Of a value over a section's material by quadrature."""
    if isinstance(section, RoundTube):
        angles = np.arange(64) * math.tau / 64
        return sum(
            a * math.tau / 64 * r * value(r * math.cos(angle), r * math.sin(angle))
            for r, a in zip(*over(section.radius - section.wall, section.radius), strict=True)
            for angle in angles
        )

    def full(width: float, height: float) -> float:
        return sum(
            a * b * value(x, y)
            for x, a in zip(*over(-width / 2, width / 2), strict=True)
            for y, b in zip(*over(-height / 2, height / 2), strict=True)
        )

    inner = (section.width - 2 * section.wall, section.height - 2 * section.wall)
    return full(section.width, section.height) - full(*inner)


SECTIONS = [RoundTube(0.04, 0.002), RectangularTube(0.08, 0.05, 0.003)]


@pytest.mark.parametrize("section", SECTIONS)
def test_area_and_second_moments_are_those_of_quadrature(section: Section) -> None:
    assert section.area == pytest.approx(integral(section, lambda x, y: 1.0), rel=1e-9)
    first, second = section.second_moments
    assert first == pytest.approx(integral(section, lambda x, y: y * y), rel=1e-9)
    assert second == pytest.approx(integral(section, lambda x, y: x * x), rel=1e-9)


def test_torsion_of_a_round_tube_is_its_polar_moment_and_bredts_formula_comes_near_it() -> None:
    tube = RoundTube(0.04, 0.0004)
    polar = integral(tube, lambda x, y: x * x + y * y)
    assert tube.torsion_constant == pytest.approx(polar, rel=1e-9)
    square = RectangularTube(0.08, 0.08, 0.0004)
    midline = 0.08 - 0.0004
    assert square.torsion_constant == pytest.approx(4 * midline**4 * 0.0004 / (4 * midline))
    assert square.torsion_stress(10.0) == pytest.approx(10.0 / (2 * midline**2 * 0.0004))


def test_stress_in_the_extreme_fibre_is_the_largest_of_a_search_along_the_edge() -> None:
    load = SectionLoad(normal=-500.0, bending=(30.0, -20.0), twist=0.0)
    for section in SECTIONS:
        first, second = section.second_moments
        if isinstance(section, RoundTube):
            angles = np.linspace(0.0, math.tau, 200001)
            points = (section.radius * np.cos(angles), section.radius * np.sin(angles))
        else:
            points = (np.array([-0.04, -0.04, 0.04, 0.04]), np.array([-0.025, 0.025, -0.025, 0.025]))
        stresses = load.normal / section.area + 30.0 * points[1] / first + 20.0 * points[0] / second
        assert von_mises(section, load) == pytest.approx(np.abs(stresses).max(), rel=1e-9)
    tube = RoundTube(0.04, 0.002)
    twisted = von_mises(tube, SectionLoad(0.0, (0.0, 0.0), 25.0))
    assert twisted == pytest.approx(math.sqrt(3) * 25.0 * 0.04 / tube.torsion_constant)


def frame_stiffness(
    nodes: np.ndarray, beams: list[tuple[int, int]], bending: list[float], axial: float
) -> np.ndarray:
    """Stiffness of a plane frame of Euler-Bernoulli beams: finite elements of x, z and turn at each node."""
    stiffness = np.zeros((3 * len(nodes), 3 * len(nodes)))
    for (i, j), ei in zip(beams, bending, strict=True):
        along = nodes[j] - nodes[i]
        length = np.linalg.norm(along)
        c, s = along / length
        turn = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
        both = np.kron(np.eye(2), turn)
        a, b = axial / length, ei / length**3
        local = np.array(
            [
                [a, 0, 0, -a, 0, 0],
                [0, 12 * b, 6 * b * length, 0, -12 * b, 6 * b * length],
                [0, 6 * b * length, 4 * b * length**2, 0, -6 * b * length, 2 * b * length**2],
                [-a, 0, 0, a, 0, 0],
                [0, -12 * b, -6 * b * length, 0, 12 * b, -6 * b * length],
                [0, 6 * b * length, 2 * b * length**2, 0, -6 * b * length, 4 * b * length**2],
            ]
        )
        places = [3 * i, 3 * i + 1, 3 * i + 2, 3 * j, 3 * j + 1, 3 * j + 2]
        stiffness[np.ix_(places, places)] += both.T @ local @ both
    return stiffness


RIGID = 1e13
"""Stiffness against stretching [N] that leaves bending alone."""


def moments_of(points: np.ndarray, force: np.ndarray, at: np.ndarray) -> list[float]:
    """Moments about some points of a force at another [N m]."""
    return [float((at - p)[0] * force[1] - (at - p)[1] * force[0]) for p in points]


def test_a_cantilever_of_three_links_bends_as_finite_elements_say() -> None:
    nodes = np.array([[0.0, 0.0], [0.3, 0.1], [0.5, 0.4], [0.9, 0.35]])
    beams = [(0, 1), (1, 2), (2, 3)]
    sections = [RoundTube(0.05, 0.002), RoundTube(0.04, 0.002), RectangularTube(0.05, 0.04, 0.002)]
    young = STRENGTHS["aluminium_6061"].young
    bending = [young * section.second_moments[0] for section in sections]
    load, unit = np.array([20.0, -50.0]), np.array([0.0, 1.0])
    stiffness = frame_stiffness(nodes, beams, bending, RIGID)
    forces = np.zeros(12)
    forces[9:11] = load
    moved = np.linalg.solve(stiffness[3:, 3:], forces[3:])
    tip = nodes[3]
    found = 0.0
    for (i, j), ei in zip(beams, bending, strict=True):
        ends = nodes[[i, j]]
        big, small = moments_of(ends, load, tip), moments_of(ends, unit, tip)
        length = float(np.linalg.norm(nodes[j] - nodes[i]))
        found += bending_work(length, ei, (big[0], big[1]), (small[0], small[1]))
    assert found == pytest.approx(moved[7], rel=1e-6)


def test_a_straight_cantilever_bends_as_the_closed_form_says() -> None:
    section, young, length, force = RoundTube(0.04, 0.002), 69e9, 0.7, 80.0
    ei = young * section.second_moments[0]
    found = bending_work(length, ei, (force * length, 0.0), (length, 0.0))
    assert found == pytest.approx(force * length**3 / (3 * ei), rel=1e-12)
    gj = STRENGTHS["aluminium_6061"].shear * section.torsion_constant
    assert torsion_work(length, gj, 15.0, 0.2) == pytest.approx(15.0 * length / gj * 0.2, rel=1e-12)


def test_a_portal_sways_as_finite_elements_and_the_closed_form_say() -> None:
    """Feet hinged, a force H at the beam's corner: sway = H h^2 (2 h/I_c + L/I_b) / (12 E)."""
    height, width, force = 0.8, 0.5, 100.0
    column, beam = RoundTube(0.04, 0.002), RectangularTube(0.06, 0.05, 0.002)
    young = 69e9
    columns, across = young * column.second_moments[0], young * beam.second_moments[0]
    nodes = np.array([[0.0, 0.0], [0.0, height], [width, height], [width, 0.0]])
    stiffness = frame_stiffness(nodes, [(0, 1), (1, 2), (2, 3)], [columns, across, columns], RIGID)
    free = [2, 3, 4, 5, 6, 7, 8, 11]  # feet turn and do not move
    forces = np.zeros(12)
    forces[3], forces[6] = force / 2, force / 2  # shared, so that the portal is antisymmetric
    moved = np.linalg.solve(stiffness[np.ix_(free, free)], forces[free])
    top, unit = force * height / 2, height / 2
    found = 2 * bending_work(height, columns, (0.0, top), (0.0, unit))
    found += bending_work(width, across, (top, -top), (unit, -unit))
    assert found == pytest.approx(moved[1], rel=1e-6)
    closed = force * height**2 / 12 * (2 * height / columns + width / across)
    assert found == pytest.approx(closed, rel=1e-12)


def test_a_column_buckles_where_finite_differences_of_the_bent_line_have_a_zero_eigenvalue() -> None:
    section, young, length = RoundTube(0.02, 0.001), 69e9, 1.2
    count = 400
    step = length / count
    second = (
        np.diag([-2.0] * (count - 1)) + np.diag([1.0] * (count - 2), 1) + np.diag([1.0] * (count - 2), -1)
    )
    least = float(np.linalg.eigvalsh(-second / step**2)[0])
    hinged = buckling_force(section, length, young, effective=1.0)
    assert hinged == pytest.approx(young * section.second_moments[0] * least, rel=1e-4)
    assert buckling_force(section, length, young) == pytest.approx(hinged / 4.0)


def test_each_way_to_give_way_has_its_safety_factor() -> None:
    material, tube = STRENGTHS["aluminium_6061"], RoundTube(0.04, 0.002)
    bent = SectionLoad(0.0, (50.0, 0.0), 0.0)
    assert safety_factors(tube, bent, 0.3, material)[Failure.YIELD] == pytest.approx(
        material.strength / (50.0 * 0.04 / tube.second_moments[0])
    )
    pressed = SectionLoad(-1000.0, (0.0, 0.0), 0.0)
    slender = RoundTube(0.01, 0.001)
    assert safety_factors(slender, pressed, 3.0, material)[Failure.COLUMN] == pytest.approx(
        buckling_force(slender, 3.0, material.young) / 1000.0
    )
    thin = RoundTube(0.1, 0.0001)
    stress = von_mises(thin, bent)
    assert safety_factors(thin, bent, 0.3, material)[Failure.WALL] == pytest.approx(
        wall_buckling_stress(thin, material) / stress
    )
    assert safety_factors(tube, SectionLoad(0.0, (0.0, 0.0), 0.0), 0.3, material) == {}


def test_a_flat_side_gives_way_where_a_plates_bending_has_a_zero_eigenvalue() -> None:
    """Finite differences of the plate's equation across it, for the half wave that gives way first."""
    material, side, wall = STRENGTHS["aluminium_6061"], 0.12, 0.002
    bending = material.young * wall**3 / (12.0 * (1.0 - material.poisson**2))
    count = 400
    step = side / (count + 1)
    second = (
        np.diag(np.ones(count - 1), 1) + np.diag(np.ones(count - 1), -1) - 2.0 * np.eye(count)
    ) / step**2

    def critical(half_wave: float) -> float:
        """Force per width [N/m]: w = f(y) sin(pi x / a) in D (d2/dy2 - k^2)^2 f = N k^2 f, f and f'' zero."""
        k = math.pi / half_wave
        operator = second - k**2 * np.eye(count)
        return bending * float(np.linalg.eigvalsh(operator @ operator).min()) / k**2

    least = min(critical(half_wave) for half_wave in np.linspace(0.6, 1.6, 101) * side)
    for section in (RectangularTube(0.12, 0.06, wall), RectangularTube(0.05, 0.12, wall)):
        assert wall_buckling_stress(section, material) == pytest.approx(least / wall, rel=1e-3)
    pressed = SectionLoad(-100.0, (0.0, 0.0), 0.0)
    wide = RectangularTube(0.12, 0.12, 0.0005)
    found = safety_factors(wide, pressed, 0.1, material)[Failure.WALL]
    assert found == pytest.approx(wall_buckling_stress(wide, material) / von_mises(wide, pressed))
    assert found < material.strength / von_mises(wide, pressed)
