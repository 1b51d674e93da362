"""The views from the side and from the front show who stands where, at their true size."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.text import Annotation

from evodesign.mechanics.agent import HUMAN, ROBOT
from evodesign.problem.build import DesignProblem
from evodesign.report.figures.design import FRONT, SIDE, alone, front_figure, side_figure
from evodesign.report.scene_models import PlacedScene
from tests.report.scenes import random_company, random_detail, random_stages
from tests.report.several import LOADS, PEOPLE, problem_of_several

HALF_ROUND = np.diag([-1.0, -1.0, 1.0])


@pytest.fixture(scope="module")
def stages(problem: DesignProblem) -> list[PlacedScene]:
    return random_stages(problem, 5)


def titles(figure: Figure) -> list[str]:
    return [axes.get_title() for axes in figure.axes]


def test_level_cameras_see_x_or_y_to_the_right_and_heights_as_they_are() -> None:
    point = np.array([[1.0, 2.0, 3.0]])
    assert SIDE.seen(point)[0] == pytest.approx([1.0, 3.0, -2.0]), "the robot, at -x, is on the left"
    assert FRONT.seen(point)[0] == pytest.approx([2.0, 3.0, 1.0]), "the left hand, at +y, is on the right"


def test_who_is_drawn_alone_looks_along_x_at_the_load(stages: list[PlacedScene]) -> None:
    stage = stages[0]
    robot, person = alone(stage)
    assert (list(robot.models.trees), list(person.models.trees)) == ([ROBOT], [HUMAN])
    assert {solid[0] for solid in robot.solids} == {ROBOT, "load"}
    for name, one, turn in ((ROBOT, robot, np.eye(3)), (HUMAN, person, HALF_ROUND)):
        for link, place in stage.frames[name].items():
            assert np.allclose(one.frames[name][link].translation, turn @ place.translation)
        found = {wrench.contact: wrench for wrench in one.wrenches}
        for wrench in stage.wrenches:
            if wrench.agent == name:
                assert np.allclose(found[wrench.contact].point, turn @ wrench.point)
                assert np.allclose(found[wrench.contact].force, turn @ wrench.force)
        assert np.allclose(one.world_from_load.translation, stage.world_from_load.translation)


def test_side_view_has_a_panel_per_height_with_a_scale_in_metres(stages: list[PlacedScene]) -> None:
    figure = side_figure(stages, "robot: postures")
    assert figure.get_suptitle() == "robot: postures from the robot's right"
    assert titles(figure) == ["load at 0.8 m", "load at 1 m", "load at 1.2 m"]
    first, *others = figure.axes
    assert first.get_ylabel() == "height [m]"
    assert not any(axes.get_ylabel() for axes in others)
    for axes in figure.axes:
        assert np.allclose(np.diff(axes.get_yticks()), 0.5)
        assert axes.get_aspect() == 1.0
        _, body = axes.collections
        low, high = axes.get_ylim()
        corners = np.vstack([path.vertices for path in body.get_paths()])
        assert low < corners[:, 1].min()
        assert corners[:, 1].max() < high, "nothing is cut off"


def test_front_view_has_two_panels_per_height_and_only_each_ones_own_forces(
    stages: list[PlacedScene],
) -> None:
    figure = front_figure(stages, "postures")
    heights = [f"load at {height} m" for height in ("0.8", "1", "1.2")]
    assert titles(figure) == [f"{who}\n{height}" for height in heights for who in ("robot", "person")]
    for axes in figure.axes:
        arrows = [child for child in axes.get_children() if isinstance(child, Annotation)]
        assert len(arrows) <= 4, "two feet and two hands"


def test_legend_names_robot_person_and_load(stages: list[PlacedScene]) -> None:
    for figure in (side_figure(stages, ""), front_figure(stages, "")):
        (legend,) = figure.legends
        assert [text.get_text() for text in legend.get_texts()][:3] == ["robot", "person", "load"]


def test_several_pairs_have_a_row_each(problem: DesignProblem) -> None:
    several = problem_of_several(problem)
    scene_set = random_company(several, 1)
    stages = [scene_set.placed_scene(case) for case in random_detail(several, 1, (0.8, 1.0)).cases]
    figure = front_figure(stages, "postures")
    wanted = [
        f"{who}{person}, {load}\nload at {height:g} m"
        for person in PEOPLE
        for load in LOADS
        for height in (0.8, 1.0)
        for who in ("robot with ", "")
    ]
    assert titles(figure) == wanted


def test_long_titles_stay_within_a_narrow_figure(stages: list[PlacedScene]) -> None:
    figure = front_figure(stages[:1], "a problem of a rather long name, design 1234: postures")
    figure.draw_without_rendering()
    title = figure._suptitle
    assert title is not None
    box, width = title.get_window_extent(), figure.bbox.width
    assert 0.0 <= box.x0 < box.x1 <= width
    (legend,) = figure.legends
    assert legend.get_window_extent().width <= width


def test_a_design_without_a_posture_says_so() -> None:
    for figure in (side_figure([], "none"), front_figure([], "none")):
        assert [text.get_text() for text in figure.axes[0].texts] == ["no posture"]
