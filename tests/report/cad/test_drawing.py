"""The drawing: nothing overlaps or leaves the sheet, and dimensions are those of the robot."""

from __future__ import annotations

import io
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from lxml import etree
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from evodesign.body.shape import Box, Cylinder, Sphere
from evodesign.report.cad.listing import link_rows, motor_rows, section_text
from evodesign.report.cad.outlines import FRONT, SIDE
from evodesign.report.cad.parts import Parts, parts_of
from evodesign.report.cad.sheet import REDUCTIONS, drawing, drawing_svg, spread
from tests.report.cad.press import press
from tests.report.cad.robots import designed, frames_at_zero, in_pinocchio

ROBOTS = [("icub_lifting", 7), ("sartore2023_motors", 1), ("icub_materials", 2)]


@pytest.fixture(
    scope="module",
    params=[*(pytest.param(each, marks=pytest.mark.slow) for each in ROBOTS), ("press", 0)],
    ids=lambda each: each[0],
)
def parts(request: pytest.FixtureRequest, repository: Path) -> Parts:
    name, seed = request.param
    return parts_of(press(), {}) if name == "press" else parts_of(*designed(repository, name, seed))


@pytest.fixture(scope="module")
def figure(parts: Parts) -> Figure:
    return drawing(parts, "a design of a problem with a rather long name, design 1234")


def test_no_text_overlaps_another_or_leaves_the_border(figure: Figure) -> None:
    figure.set_dpi(300)  # letters are not rounded to pixels
    FigureCanvasAgg(figure).draw()
    (axes,) = figure.axes
    boxes = [(each.get_text(), each.get_window_extent()) for each in axes.texts if each.get_text()]
    assert len(boxes) > 30
    assert [pair for pair in combinations(boxes, 2) if pair[0][1].overlaps(pair[1][1])] == []
    to_sheet = axes.transData.inverted()
    corners = np.array([to_sheet.transform(box.get_points()) for _, box in boxes])
    assert corners.min() > 10.0
    assert corners[..., 0].max() < 410.0
    assert corners[..., 1].max() < 287.0


def test_whole_width_depth_and_height_are_those_of_the_robot(parts: Parts, figure: Figure) -> None:
    """By support points of the shapes in pinocchio's frames: no hulls, no views."""
    frames = frames_at_zero(in_pinocchio(parts.tree))
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for link in parts.tree.links:
        for solid in link.solids:
            place = solid.link_from_solid
            turn = frames[link.name].rotation @ np.array(place.rotation)
            middle = frames[link.name].act(np.array(place.translation, float))
            half = np.array([reach(solid.shape, turn.T @ direction) for direction in np.eye(3)])
            low, high = np.minimum(low, middle - half), np.maximum(high, middle + half)
    for motor in parts.motors:
        place = motor.root_from_motor
        turn, middle = np.array(place.rotation), np.array(place.translation, float)
        half = np.array([reach(motor.solid.shape, turn.T @ direction) for direction in np.eye(3)])
        low, high = np.minimum(low, middle - half), np.maximum(high, middle + half)
    if parts.meshes:
        low[0] = -0.25  # the cover: a ball of 50 mm at -0.2 m
    (axes,) = figure.axes
    shown = [each.get_text() for each in axes.texts]
    depth, width, height = 1000.0 * (high - low)
    for name, wanted in (("depth", depth), ("width", width), ("height", height)):
        assert any(text.isdigit() and abs(int(text) - wanted) < 1.0 for text in shown), (name, wanted)


def reach(shape: Sphere | Cylinder | Box, direction: np.ndarray) -> float:
    """How far a shape reaches from its centre along a unit vector [m]."""
    match shape:
        case Sphere(radius):
            return float(radius)
        case Cylinder(radius, length):
            across = float(np.hypot(direction[0], direction[1]))
            return float(radius) * across + float(length) / 2.0 * abs(float(direction[2]))
        case Box():
            return float(np.abs(direction) @ np.array(shape.sides, float)) / 2.0


def test_outlines_are_drawn_to_the_scale_that_is_told(parts: Parts, figure: Figure) -> None:
    (axes,) = figure.axes
    title = next(each.get_text() for each in axes.texts if each.get_text().startswith("front, 1 : "))
    reduction = float(title.rpartition(" ")[2])
    assert reduction in REDUCTIONS
    patches = [patch.get_path().vertices for patch in axes.patches if len(patch.get_path().vertices) > 3]
    tallest = max(float(np.ptp(vertices[:, 1])) for vertices in patches)
    frames = frames_at_zero(in_pinocchio(parts.tree))
    wanted = max(
        2.0 * reach(solid.shape, np.array(solid.link_from_solid.rotation).T @ frames[link.name].rotation[2])
        for link in parts.tree.links
        for solid in link.solids
    )
    assert tallest == pytest.approx(1000.0 * wanted / reduction, rel=1e-3)


def test_the_bill_has_every_link_and_motor_once(parts: Parts) -> None:
    names = [name for row in link_rows(parts) for name in row.names]
    assert sorted(names) == sorted(link.name for link in parts.tree.links if link.solids or link.meshes)
    joints = [name for row in motor_rows(parts) for name in row.joints]
    assert sorted(joints) == sorted(joint.name for joint in parts.tree.joints if joint.actuator)
    weighed = sum(row.mass * len(row.names) for row in link_rows(parts))
    driven = sum(row.mass * len(row.joints) for row in motor_rows(parts))
    shapeless = sum(float(link.mass) for link in parts.tree.links if link.name in parts.left_out)
    assert weighed + driven + shapeless == pytest.approx(float(parts.tree.mass), abs=0.05)


def test_sections_are_outer_dimensions_in_millimetres() -> None:
    assert section_text(Box(0.1, 0.02345, 0.3)) == "100 x 23.4 x 300"
    assert section_text(Cylinder(0.05, 0.1581)) == "Ø100 x 158.1"
    assert section_text(Sphere(0.06)) == "ball Ø120"


def test_views_are_right_handed_and_from_ahead_and_the_right() -> None:
    """Who looks stands where depth grows: ahead (x), and at the robot's right (-y)."""
    assert FRONT.depth(np.array([1.0, 0.0, 0.0])) == 1.0
    assert SIDE.depth(np.array([0.0, -1.0, 0.0])) == 1.0


def test_the_file_is_a3_and_equal_robots_give_equal_files() -> None:
    file = drawing_svg(parts_of(press(), {}), "a press")
    root = etree.parse(io.BytesIO(file)).getroot()
    size = [float(root.get(name).removesuffix("pt")) * 25.4 / 72.0 for name in ("width", "height")]
    np.testing.assert_allclose(size, [420.0, 297.0], atol=0.01)
    assert drawing_svg(parts_of(press(), {}), "a press") == file


@given(st.lists(st.floats(0.0, 300.0), min_size=1, max_size=40).map(sorted))
def test_labels_keep_their_order_and_their_distance_and_stay_where_there_is_room(wanted: list[float]) -> None:
    places = spread(wanted, 2.6)
    assert (np.diff(places) >= 2.6 - 1e-9).all()
    assert np.mean(places) == pytest.approx(np.mean(wanted), abs=1e-6)
    if len(wanted) == 1 or np.diff(wanted).min() >= 2.6:
        np.testing.assert_allclose(places, wanted, atol=1e-9)
