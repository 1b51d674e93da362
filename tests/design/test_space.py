"""Genomes, parameter values and the robots they stand for."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evodesign.design.parameter import DesignParameter, ParameterKind
from evodesign.design.space import TYPICAL, DesignSpace
from evodesign.errors import ModelError
from evodesign.problem.build import DesignProblem

unit = st.floats(0.0, 1.0)


@given(st.lists(unit, min_size=2, max_size=2))
def test_genome_and_values_are_two_names_of_one_point(genome: list[float]) -> None:
    space = DesignSpace(
        (
            DesignParameter(ParameterKind.LENGTH, "arm", ("arm",), 0.6, 1.8),
            DesignParameter(ParameterKind.DENSITY, "arm", ("arm",), 500.0, 4000.0),
        )
    )
    values = space.values(tuple(genome))
    assert 0.6 <= values[0] <= 1.8
    assert space.genome(values) == pytest.approx(tuple(genome), abs=1e-12)
    assert list(space.named(values)) == ["length.arm", "density.arm"]


def test_unscaled_design_is_the_files_robot(problem: DesignProblem) -> None:
    tree = problem.scene.robot.tree
    resized = problem.space.resized(tree, problem.space.unscaled(tree))
    for link in tree.links:
        assert resized.link_by_name[link.name].inertia.mass == pytest.approx(link.inertia.mass, rel=1e-12)
    for joint in tree.joints:
        assert resized.joint_by_name[joint.name] == joint


def test_left_and_right_change_together(problem: DesignProblem) -> None:
    genome = tuple(0.3 for _ in problem.space.parameters)
    tree = problem.space.resized(problem.scene.robot.tree, problem.space.values(genome))
    for joint in tree.joints:
        if joint.name.startswith("l_"):
            left = joint.parent_from_child.translation
            right = tree.joint_by_name["r_" + joint.name[2:]].parent_from_child.translation
            assert right == (left[0], -left[1], left[2])


def test_parameter_of_a_link_without_a_shape_is_refused(problem: DesignProblem) -> None:
    space = DesignSpace((DesignParameter(ParameterKind.LENGTH, "sole", ("l_sole",), 0.5, 2.0),))
    with pytest.raises(ModelError, match="l_sole"):
        space.check(problem.scene.robot.tree)


def test_programs_are_given_rated_torques_in_place_of_margins() -> None:
    space = DesignSpace(
        (
            DesignParameter(ParameterKind.LENGTH, "arm", ("l_upper_arm", "r_upper_arm"), 0.6, 1.8),
            DesignParameter(ParameterKind.MARGIN, "elbow", (), 1.0, 4.0, joints=("l_elbow", "r_elbow")),
        )
    )
    assert space.margins == (1,)
    assert space.given((1.2, 2.0), {"margin.elbow": 17.0}) == (1.2, 17.0)
    assert space.given((1.2, 2.0), {}) == (1.2, 2.0 * TYPICAL)
    assert space.values((0.5, 0.5))[1] == pytest.approx(2.0)
