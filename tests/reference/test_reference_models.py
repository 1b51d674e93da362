"""The published robot and person as a user's problem: they load, resize, evaluate, and reach what is known.

Reach figures: ../shared/reference/PUBLISHED_CODE.md, "What a well-posed formulation finds".
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

from evodesign.evaluation.evaluate import Evaluator
from evodesign.posture.check import TOLERANCE
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.notes import notes
from evodesign.records import ProblemSource, Status
from evodesign.tree.resize import resize
from evodesign.tree.urdf_read import InertiaRule, read_urdf
from evodesign.tree.urdf_write import urdf_text
from tests.oracles.pinocchio_model import carried_inertia, floating_model
from tests.tree.test_icub_robot import reference_text
from tests.tree.test_urdf_write import assert_mujoco_has, assert_same_tree, floating_in_mujoco

ROBOT, PERSON = "robot_reference.urdf", "human_subject04_48dof.urdf"
PAPER_START = (1.00992, 1.44575, 1.41355, 1.14021, 0.513441, 1.34682, 0.874503, 1.10944)
"""The paper code's start lengths: upper arm, forearm, thigh, shank, pelvis, torso 1 and 2, chest."""
WITHIN = 0.02
"""Of the reach figures [m]."""

HUMAN = f"""
[human]
urdf = "{PERSON}"
hands = {{ left = "left_palm", right = "right_palm" }}
soles = {{ left = "left_sole", right = "right_sole", size_m = [0.26, 0.088] }}
trunk = ["Pelvis", "T8"]
# palms in the middle of the boxes of the hands, soles under those of the feet
frames = [
    {{ name = "left_palm", link = "LeftHand", xyz_m = [0.0, 0.1, 0.0] }},
    {{ name = "right_palm", link = "RightHand", xyz_m = [0.0, -0.1, 0.0] }},
    {{ name = "left_sole", link = "LeftFoot", xyz_m = [0.057, 0.0, -0.0779] }},
    {{ name = "right_sole", link = "RightFoot", xyz_m = [0.057, 0.0, -0.0779] }},
]
"""
SOLVER = """
[solver]
symmetry = "off"    # the published robot is not symmetric to the last digit
compile = false     # takes longer than it saves here
"""
GRASPS = """
robot_grasps_m = { left = [-0.25, 0.2, 0.025], right = [-0.25, -0.2, 0.025] }
human_grasps_m = { left = [0.25, -0.2, 0.025], right = [0.25, 0.2, 0.025] }
"""


def problem_text(repository: Path, grasps: str) -> str:
    """Point-grasp with the published robot and person, and grasp points beside the default ones."""
    text = (repository / "problems" / "point_grasp.toml").read_text(encoding="utf-8")
    before, rest = text.split("[human]\n")
    after = rest[rest.index("[payload]") :]
    for old, new in (
        ('start = "../populations/icub.toml"\n', ""),
        ("[[design.length]]\n", SOLVER + "\n[[design.length]]\n"),
        ('grasp = "point"\n', f'grasp = "point"\n{grasps}'),
    ):
        assert old in after
        after = after.replace(old, new, 1)
    return before.replace("robots/icub_shapes.urdf", ROBOT) + HUMAN + after


def build(repository: Path, grasps: str) -> Evaluator:
    files = {name: reference_text(name) for name in (ROBOT, PERSON)}
    text = problem_text(repository, grasps)
    return Evaluator(build_problem(ProblemSource(path="reference.toml", text=text, files=files)))


@pytest.fixture(scope="module")
def edges(repository: Path) -> Evaluator:
    """With our default grasp points, at the load's top edges, 0.0125 m above its centre."""
    return build(repository, "")


@pytest.fixture(scope="module")
def handles(repository: Path) -> Evaluator:
    """With the published grasp points, 0.025 m above the load's centre."""
    return build(repository, GRASPS)


@pytest.fixture(scope="module")
def reference(edges: Evaluator) -> DesignProblem:
    return edges.problem


def of_lengths(problem: DesignProblem, lengths: tuple[float, ...]) -> tuple[float, ...]:
    """Parameter values: lengths of the eight groups, and densities as they are."""
    unscaled = problem.space.unscaled(problem.scene.robot.tree)
    return (*lengths, *unscaled[len(lengths) :])


def test_robot_and_person_load_with_their_figures(reference: DesignProblem) -> None:
    robot, human = reference.scene.robot, reference.scene.human
    for agent, mass, joints in ((robot, 62.573865, 25), (human, 72.70, 48)):
        assert math.fsum(link.inertia.mass for link in agent.tree.links) == pytest.approx(mass, abs=5e-3)
        assert len(agent.joints) == joints
    assert any("jLeftHip_roty" in note for note in notes(reference)), "hip flexion looks turned"


@pytest.mark.slow
@pytest.mark.parametrize(("lengths", "highest"), [((1.0,) * 8, 1.27), (PAPER_START, 1.51)])
def test_reach_is_the_known_one(
    lengths: tuple[float, ...], highest: float, edges: Evaluator, handles: Evaluator
) -> None:
    reaches = []
    for evaluator in (edges, handles):
        reach = evaluator.solve(of_lengths(evaluator.problem, lengths)).reach
        assert reach.status is Status.SOLVED, reach.reason
        assert reach.highest == pytest.approx(highest, abs=WITHIN)
        reaches.append(reach.highest)
    assert reaches[0] - reaches[1] == pytest.approx(0.0125, abs=1e-4), "the hands reach equally high"


def test_every_required_height_is_held_within_the_checks_tolerance(handles: Evaluator) -> None:
    for lengths in ((1.0,) * 8, PAPER_START):
        values = of_lengths(handles.problem, lengths)
        result = handles.solve(values)
        assert [height.status for height in result.cases] == [Status.SOLVED] * 3
        assert all(max(height.residuals.values()) < TOLERANCE for height in result.cases)
        found = handles.assessment(values, result)
        assert found.violation == 0.0
        assert set(found.objectives) == {"robot_torque", "human_torque", "reach_height"}


def test_resized_robot_is_the_same_in_pinocchio_and_mujoco_and_read_again(reference: DesignProblem) -> None:
    tree = reference.space.resized(reference.scene.robot.tree, of_lengths(reference, PAPER_START))
    text = urdf_text(tree)
    assert_same_tree(read_urdf(text, "written.urdf", InertiaRule.SHAPES), tree)
    model = floating_model(text)
    for name, inertia in carried_inertia(tree).items():
        found = model.inertias[model.getJointId(name)]
        assert found.mass == pytest.approx(inertia.mass, rel=1e-12)
        assert np.allclose(found.lever, inertia.center, atol=1e-12)
        assert np.allclose(found.inertia, inertia.about_center, atol=1e-12)
    assert_mujoco_has(floating_in_mujoco(tree).compile(), tree, 1e-9)


def test_unit_lengths_and_own_densities_are_the_published_robot(reference: DesignProblem) -> None:
    tree = reference.scene.robot.tree
    solid = [link for link in tree.links if link.solids]
    assert resize(tree, {x.name: 1.0 for x in solid}, {x.name: x.solids[0].density for x in solid}) == tree


def test_the_person_written_and_read_is_the_published_one(reference: DesignProblem) -> None:
    tree = read_urdf(reference_text(PERSON), PERSON, InertiaRule.FILE)
    assert_same_tree(read_urdf(urdf_text(tree), "written.urdf", InertiaRule.FILE), tree)
    assert pin.computeTotalMass(floating_model(urdf_text(tree))) == pytest.approx(72.70, abs=5e-3)
    assert len(reference.scene.human.tree.links) == len(tree.links) + 4, "two palms, two soles"
