"""What the figures draw is what they were given."""

from __future__ import annotations

from pathlib import Path

import msgspec
import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.text import Annotation

from evodesign.errors import InputError
from evodesign.problem.build import DesignProblem
from evodesign.records import CaseDetail
from evodesign.report.figures.faces import faces_of
from evodesign.report.figures.joint_torques import joint_torques, torque_boxes
from evodesign.report.figures.paint import key_below, new_figure, write_figure
from evodesign.report.figures.posture_figure import Camera, posture_figure
from evodesign.report.scene_models import placed_scene
from evodesign.tasks import Lift
from tests.report.scenes import random_cast, random_instant, random_stages

TORQUES = {
    "old $robot$": {0.8: [0.0, 1.0, -2.0, 5.0], 1.0: [3.0, 3.5, -1.0, 0.25]},
    "<script>": {0.8: [1.0, 2.0], 1.2: [4.0, -4.0, 0.5]},
}


def titles(figure: Figure) -> list[str]:
    return [axes.get_title() for axes in figure.axes]


def test_boxes_span_the_quartiles_and_show_the_median() -> None:
    figure = torque_boxes(TORQUES, "torques")
    assert titles(figure) == ["load at 0.8 m", "load at 1 m", "load at 1.2 m"]
    for axes, height in zip(figure.axes, (0.8, 1.0, 1.2), strict=True):
        given = [by_height[height] for by_height in TORQUES.values() if height in by_height]
        assert len(axes.patches) == len(given)
        for box, values in zip(axes.patches, given, strict=True):
            edges = box.get_path().vertices[:, 1]
            assert [edges.min(), edges.max()] == pytest.approx(np.quantile(values, [0.25, 0.75]))
        medians = [line.get_ydata()[0] for line in axes.lines if line.get_linewidth() == 1.4]
        assert medians == pytest.approx([float(np.median(values)) for values in given])
        dots = [sorted(cloud.get_offsets()[:, 1].tolist()) for cloud in axes.collections]
        assert dots == [sorted(values) for values in given]


@pytest.mark.parametrize("width", [3.0, 5.2, 7.6, 8.1, 12.0])
def test_a_key_of_any_length_stays_within_figures_of_any_width(width: float) -> None:
    figure = new_figure(width, 3.0, "")
    axes = figure.subplots()
    words = [
        "robot",
        "person",
        "load",
        "force on the feet, the largest 372 N",
        "force on the hands, the largest 39 N",
    ]
    key_below(figure, [axes.plot([], [], label=label)[0] for label in words])
    figure.draw_without_rendering()
    (legend,) = figure.legends
    box = legend.get_window_extent()
    assert [text.get_text() for text in legend.get_texts()] == words
    assert 0.0 <= box.x0 < box.x1 <= figure.bbox.width


def test_joint_figure_puts_each_torque_on_its_row() -> None:
    by_joint = {"robot": [(0.8, {"knee": -3.0, "hip": 2.0}), (1.0, {"knee": 1.5, "hip": 0.0})]}
    axes = joint_torques(by_joint, "torques").axes[0]
    assert [label.get_text() for label in axes.get_yticklabels()] == ["knee", "hip"]
    assert [cloud.get_offsets().tolist() for cloud in axes.collections] == [
        [[-3.0, 0.0], [2.0, 1.0]],
        [[1.5, 0.0], [0.0, 1.0]],
    ]


def test_posture_figure_has_a_panel_per_height_and_an_arrow_per_contact(problem: DesignProblem) -> None:
    stages = random_stages(problem, 5)
    figure = posture_figure(stages, "postures")
    assert titles(figure) == ["load at 0.8 m", "load at 1 m", "load at 1.2 m"]
    for axes in figure.axes:
        arrows = [child for child in axes.get_children() if isinstance(child, Annotation)]
        assert 4 <= len(arrows) <= 8, "one per foot, one per hand that is not seen end on"
        ground, body = axes.collections
        assert len(ground.get_paths()) == 1
        assert len(body.get_paths()) > 500


def test_a_lift_is_a_film_of_its_moments(problem: DesignProblem) -> None:
    lift, rng = Lift(0.8, 1.2, 1.5), np.random.default_rng(5)
    instants = tuple(
        msgspec.structs.replace(random_instant(problem.scene, rng), time_s=time, load_height_m=height)
        for time, height in ((0.0, 0.8), (0.75, 1.0), (1.5, 1.2))
    )
    moments = CaseDetail(case=problem.scene.case(lift), instants=instants).moments
    stages = [placed_scene(random_cast(problem, 5), moment) for moment in moments]
    assert titles(posture_figure(stages, "lift")) == [
        "load at 0.8 m at 0 s",
        "load at 1 m at 0.75 s",
        "load at 1.2 m at 1.5 s",
    ]


def test_arrows_begin_where_forces_act_and_follow_them_on_one_scale(problem: DesignProblem) -> None:
    stages, view = random_stages(problem, 5), Camera()
    figure = posture_figure(stages, "postures", view)
    for by_ground in (True, False):
        wrenches = [w for stage in stages for w in stage.wrenches if w.by_ground == by_ground]
        scale = 0.45 / max(float(np.linalg.norm(wrench.force)) for wrench in wrenches)
        for axes, stage in zip(figure.axes, stages, strict=True):
            arrows = {
                arrow.xyann: np.array(arrow.xy) for arrow in axes.texts if isinstance(arrow, Annotation)
            }
            for wrench in stage.wrenches:
                tail, way = (view.seen(np.array([v]))[0, :2] for v in (wrench.point, wrench.force))
                if wrench.by_ground == by_ground and float(np.linalg.norm(scale * way)) > 0.03:
                    tip = next(tip for begin, tip in arrows.items() if np.allclose(begin, tail))
                    assert np.allclose(tip, tail + scale * way)


def test_nearer_faces_are_painted_over_farther_ones(problem: DesignProblem) -> None:
    side = Camera(azimuth=-np.pi / 2.0, elevation=0.0)
    stage = random_stages(problem, 5)[0]
    (_, body) = posture_figure([stage], "postures", side).axes[0].collections
    faces = [face for _, shape, place in stage.solids for face in faces_of(shape, place)]
    facing = [f for f in faces if float(f.normal @ side.axes[2]) > 0.0]
    assert len(body.get_paths()) == len(facing)
    facing.sort(key=lambda face: float(face.corners[:, 1].mean()), reverse=True)  # the camera is at -y
    for path, face in zip(body.get_paths(), facing, strict=True):
        assert np.allclose(path.vertices[:-1].mean(axis=0), face.corners[:, [0, 2]].mean(axis=0))


def test_design_without_a_posture_still_gives_figures() -> None:
    for figure in (
        torque_boxes({"robot": {}}, "none"),
        posture_figure([], "none"),
        joint_torques({}, "none"),
    ):
        assert figure.get_suptitle() == "none"


def test_files_are_equal_for_equal_figures_and_hold_names_as_text(tmp_path: Path) -> None:
    texts = []
    for place in (tmp_path / "a", tmp_path / "b"):
        place.mkdir()
        svg, png = write_figure(torque_boxes(TORQUES, "<b>$x^2$</b> \N{SNOWMAN} 漢字"), place, "torques")
        texts.append(svg.read_text())
        assert png.read_bytes().startswith(b"\x89PNG")
    assert texts[0] == texts[1]
    assert "&lt;script&gt;" in texts[0]
    assert "<script" not in texts[0]
    assert "old $robot$" in texts[0]


def test_directory_that_cannot_be_written_is_explained(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="a directory that can be written"):
        write_figure(torque_boxes(TORQUES, ""), tmp_path / "missing", "torques")
