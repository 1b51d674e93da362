"""Bodies of Open CASCADE: closed forms of volume and inertia, triangles by trimesh, files in millimetres."""

from __future__ import annotations

import io
import math

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from evodesign.body.placement import Placement, matrix_from_rpy
from evodesign.body.shape import Box, Cylinder, Shape, Solid, Sphere
from evodesign.report.cad import kernel
from evodesign.tree.mesh_write import stl
from tests.report.cad.reread import measured, parts_in

PLACE = Placement(matrix_from_rpy((0.3, -0.7, 1.9)), (0.05, -0.2, 0.4))
STAMP = "2024-01-01T00:00:00"

lengths = st.floats(0.02, 0.5)
shapes = st.one_of(
    st.builds(Sphere, lengths),
    st.builds(Cylinder, lengths, lengths),
    st.builds(Box, lengths, lengths, lengths),
)


def volume_by_hand(shape: Shape, wall: float) -> float:
    """Of a closed shell [m^3], or of the full shape where the wall is 0."""
    match shape:
        case Sphere(r):
            return 4.0 / 3.0 * math.pi * (r**3 - ((r - wall) ** 3 if wall else 0.0))
        case Cylinder(r, l):
            return math.pi * (r**2 * l - ((r - wall) ** 2 * (l - 2.0 * wall) if wall else 0.0))
        case Box(x, y, z):
            return x * y * z - ((x - 2.0 * wall) * (y - 2.0 * wall) * (z - 2.0 * wall) if wall else 0.0)


@given(shape=shapes, share=st.floats(0.0, 0.4))
@settings(max_examples=40)
def test_bodies_have_the_volume_and_the_inertia_of_closed_forms(shape: Shape, share: float) -> None:
    wall = share * float(shape.least_width) / 2.0 if share > 0.01 else None
    solid = Solid(shape, PLACE, 2700.0, wall)
    body = kernel.body_of(solid)
    assert kernel.volume(body) == pytest.approx(volume_by_hand(shape, wall or 0.0), rel=1e-9)
    found, wanted = kernel.inertia(body, 2700.0), solid.inertia
    assert found.mass == pytest.approx(wanted.mass, rel=1e-9)
    np.testing.assert_allclose(found.center, wanted.center, atol=1e-9)
    scale = np.linalg.norm(wanted.about_center)
    np.testing.assert_allclose(found.about_center, wanted.about_center, rtol=0.0, atol=1e-8 * scale)


@pytest.mark.parametrize("wall", [None, 0.002, 0.01])
@pytest.mark.parametrize(
    "shape", [Sphere(0.06), Cylinder(0.05, 0.16), Cylinder(0.011, 0.5), Box(0.1, 0.05, 0.2)]
)
def test_triangles_are_closed_and_fill_the_volume_to_a_thousandth(shape: Shape, wall: float | None) -> None:
    vertices, corners = kernel.triangles(kernel.body_of(Solid(shape, PLACE, 1.0, wall)))
    mesh = trimesh.load(io.BytesIO(stl(vertices, corners)), file_type="stl")
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    assert mesh.body_count == (1 if wall is None else 2)  # outside and cavity
    assert mesh.volume == pytest.approx(volume_by_hand(shape, wall or 0.0), rel=1e-3)
    np.testing.assert_allclose(mesh.bounds.mean(axis=0), PLACE.translation, atol=2e-4)


def test_a_wall_that_leaves_no_cavity_gives_a_full_body() -> None:
    assert kernel.volume(kernel.solid_body(Box(0.1, 0.1, 0.004), 0.002)) == pytest.approx(4e-5, rel=1e-12)


def test_a_step_file_has_millimetres_a_name_and_the_body() -> None:
    body = kernel.body_of(Solid(Cylinder(0.05, 0.16), PLACE, 1.0, 0.003))
    content = kernel.step_file("arm", [kernel.Product("Arm ü/1", body, PLACE)], STAMP)
    assert b"SI_UNIT(.MILLI.,.METRE.)" in content
    assert b"FILE_NAME('arm','2024-01-01T00:00:00',('evodesign')" in content
    ((name, part),) = parts_in(content).items()
    assert name == "Arm ü/1"
    volume, center, _ = measured(part.body)
    assert volume == pytest.approx(volume_by_hand(Cylinder(0.05, 0.16), 0.003), rel=1e-9)
    np.testing.assert_allclose(center, PLACE.translation, atol=1e-9)


def test_names_survive_whatever_their_length_and_letters() -> None:
    names = ["a" * 200, "it's; a 'name'", "two  spaces, " * 20 + "x", "Ünï/ö", "x"]
    products = [kernel.Product(name, kernel.solid_body(Sphere(0.1), None), PLACE) for name in names]
    contents = [kernel.step_file("many", products, STAMP) for _ in range(4)]
    assert len(set(contents)) == 1  # though Open CASCADE counts on from file to file
    assert set(parts_in(contents[-1])) == set(names)


def test_open_cascade_writes_nothing_to_the_terminal(capfd: pytest.CaptureFixture[str]) -> None:
    body = kernel.solid_body(Sphere(0.1), None)
    kernel.step_file("ball", [kernel.Product("ball", body, Placement())], STAMP)
    assert capfd.readouterr() == ("", "")


def test_bodies_that_overlap_stay_two_and_the_union_is_known() -> None:
    one, other = (
        kernel.body_of(Solid(Box(0.1, 0.1, 0.1), Placement(translation=(x, 0.0, 0.0)), 1.0))
        for x in (0.0, 0.06)
    )
    assert kernel.volume(kernel.together([one, other])) == pytest.approx(2e-3, rel=1e-12)
    assert kernel.united_volume([one, other]) == pytest.approx(1.6e-3, rel=1e-9)
    assert kernel.shared_volume(one, other) == pytest.approx(0.4e-3, rel=1e-9)
