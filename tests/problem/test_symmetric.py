"""`symmetry = "auto"`: exact robots stay as they are, near ones are averaged, others solved whole."""

from __future__ import annotations

import re
from dataclasses import replace

import msgspec
import numpy as np
import pytest

from evodesign.body.placement import Placement
from evodesign.errors import InputError
from evodesign.mechanics.agent import ROBOT
from evodesign.posture.check import AgentModel, Checker
from evodesign.posture.formulations.base import Setting
from evodesign.posture.postures import PostureProblem, Symmetry
from evodesign.posture.results import CaseSolution
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.records import Hold, ProblemSource, Status
from evodesign.tree.model import Link, Tree
from evodesign.tree.symmetry import mirror_of
from evodesign.tree.urdf_write import urdf_text
from tests.problem.test_notes import strange
from tests.tree.nearly_symmetric import inverse, matrix, random_rotation

URDF = "robots/icub_shapes.urdf"


def source_with(problem: DesignProblem, tree: Tree, symmetry: str | None = None) -> ProblemSource:
    """The point-grasp problem with another robot, as a file says it."""
    text = problem.source.text + (f'[solver]\nsymmetry = "{symmetry}"\n' if symmetry else "")
    files = {**problem.source.files, URDF: urdf_text(tree)}
    return ProblemSource(path="p.toml", text=text, files=files)


def heavier(tree: Tree, name: str, factor: float) -> Tree:
    def changed(link: Link) -> Link:
        return replace(link, solids=tuple(replace(s, density=s.density * factor) for s in link.solids))

    return replace(tree, links=tuple(changed(link) if link.name == name else link for link in tree.links))


def moved(tree: Tree, name: str, shift: tuple[float, float, float]) -> Tree:
    step = Placement(translation=shift)
    joints = tuple(
        replace(joint, parent_from_child=step @ joint.parent_from_child) if joint.name == name else joint
        for joint in tree.joints
    )
    return replace(tree, joints=joints)


@pytest.fixture(scope="module")
def near(problem: DesignProblem) -> Tree:
    tree = heavier(problem.scene.robot.tree, "l_lower_leg", 1.01)
    return moved(tree, "r_elbow", (0.0004, 0.0, 0.0003))


def test_an_exact_problem_is_solved_for_symmetric_postures_without_a_word(problem: DesignProblem) -> None:
    assert problem.symmetry is Symmetry.ON
    assert strange(problem) == ()
    on = build_problem(msgspec.structs.replace(problem.source, symmetry="on"))
    assert on.scenes == problem.scenes


def test_a_near_robot_is_averaged_everywhere_and_told(problem: DesignProblem, near: Tree) -> None:
    built = build_problem(source_with(problem, near))
    assert built.symmetry is Symmetry.ON
    (note,) = strange(built)
    assert note.startswith("robot 'icub_shapes' is averaged with its mirror image, here and in exports: the ")
    assert "1 % in the mass of link l_lower_leg / r_lower_leg" in note
    assert "0.5 mm in the place of joint l_elbow / r_elbow" in note
    trees = {id(scene.robot.tree) for scene in built.scenes}
    assert len(trees) == 1
    tree = built.scene.robot.tree
    assert mirror_of(tree).links["l_elbow_1"] == "r_elbow_1"
    total = [sum(link.inertia.mass for link in each.links) for each in (near, tree)]
    assert total[0] == pytest.approx(total[1], rel=1e-12)


@pytest.mark.parametrize(("asked", "found"), [("on", "on"), ("polish", "polish"), ("off", "off")])
def test_what_is_asked_for_is_what_a_near_robot_gets(
    asked: str, found: str, problem: DesignProblem, near: Tree
) -> None:
    built = build_problem(source_with(problem, near, asked))
    assert built.symmetry == found
    assert bool(strange(built)) == (asked != "off")
    assert (built.scene.robot.tree == build_problem(source_with(problem, near, "off")).scene.robot.tree) == (
        asked == "off"
    )


def test_a_robot_beyond_is_solved_whole_and_refused_where_symmetry_is_asked_for(
    problem: DesignProblem,
) -> None:
    tree = heavier(problem.scene.robot.tree, "l_lower_leg", 1.3)
    built = build_problem(source_with(problem, tree))
    assert built.symmetry is Symmetry.OFF
    words = (
        "robot.*: wanted a mirror image in the plane y = 0, found 26 % in the mass of link "
        r"l_lower_leg / r_lower_leg \(2 % allowed\) and 1 more such difference"
    )
    (note,) = strange(built)
    assert note.startswith("postures are solved whole, not symmetric: ")
    assert re.search(words.removeprefix("robot"), note)
    assert built.scene.robot.tree.link_by_name["l_lower_leg"].inertia.mass > 1.0
    with pytest.raises(InputError, match=r"solver.symmetry: wanted 'auto', 'off'.*26 % in the mass"):
        build_problem(source_with(problem, tree, "on"))


def test_torque_limits_of_an_averaged_robot_are_the_weaker_side_s(problem: DesignProblem) -> None:
    joints = tuple(
        replace(joint, effort=77.0 if joint.name == "l_knee" else joint.effort)
        for joint in problem.scene.robot.tree.joints
    )
    tree = heavier(replace(problem.scene.robot.tree, joints=joints), "l_lower_leg", 1.01)
    built = build_problem(source_with(problem, tree))
    limits = built.scene.robot.torque_limits
    assert limits["l_knee"] == limits["r_knee"] == 77.0
    assert "of different effort limits the smaller counts" in strange(built)[0]


def test_a_hand_off_its_mirrored_place_is_named(problem: DesignProblem) -> None:
    joint = problem.scene.robot.tree.parent_joint[problem.scene.robot.frame("right_hand")].name
    tree = moved(problem.scene.robot.tree, joint, (0.0, 0.004, 0.0))
    (note,) = strange(build_problem(source_with(problem, tree)))
    assert "robot.hands: wanted mirror images of each other, found 'l_hand_frame' and 'r_hand_frame'" in note


def test_soles_that_are_turned_differently_are_named(problem: DesignProblem) -> None:
    name = problem.scene.robot.tree.parent_joint["r_sole"].name
    turn = Placement.from_xyz_rpy((0.0, 0.0, 0.0), (0.0, 0.0, 0.1))
    joints = tuple(
        replace(joint, parent_from_child=joint.parent_from_child @ turn) if joint.name == name else joint
        for joint in problem.scene.robot.tree.joints
    )
    (note,) = strange(build_problem(source_with(problem, replace(problem.scene.robot.tree, joints=joints))))
    assert "robot.soles: wanted frames that are mirror images of each other" in note


# Frames that are turned


def turned(tree: Tree, seed: int) -> Tree:
    """The same robot with all frames but those of root and soles turned at random."""
    rng = np.random.default_rng(seed)
    turns = {
        link.name: Placement()
        if link.name in {tree.root, "l_sole", "r_sole"}
        else Placement(matrix(random_rotation(rng)))
        for link in tree.links
    }
    links = tuple(
        replace(
            link,
            solids=tuple(
                replace(s, link_from_solid=inverse(turns[link.name]) @ s.link_from_solid) for s in link.solids
            ),
            own_inertia=link.own_inertia.moved(inverse(turns[link.name])),
        )
        for link in tree.links
    )
    joints = tuple(
        replace(
            joint,
            parent_from_child=inverse(turns[joint.parent]) @ joint.parent_from_child @ turns[joint.child],
            axis=inverse(turns[joint.child]).apply(joint.axis),
        )
        for joint in tree.joints
    )
    return Tree(tree.name, links, joints)


def solve(problem: DesignProblem, scale: float = 1.0) -> CaseSolution:
    scene, space = problem.scene, problem.space
    values = [value * scale for value in space.unscaled(scene.robot.tree)]
    checker = Checker(
        scene,
        AgentModel.of(scene.robot, space.resized(scene.robot.tree, values)),
        AgentModel.of(scene.human, scene.human.tree),
    )
    options = replace(problem.options, compiled=False)
    setting = Setting(scene, space, problem.weights, options)
    return PostureProblem(setting, problem.symmetry).solve(values, Hold(height_m=1.0), checker)


def test_turned_frames_change_no_posture_of_a_resized_robot(problem: DesignProblem) -> None:
    """The check is pinocchio's, of the whole robot."""
    other = build_problem(source_with(problem, turned(problem.scene.robot.tree, 3)))
    assert other.symmetry is Symmetry.ON
    assert strange(other) == ()
    one, same = solve(problem, 1.05), solve(other, 1.05)
    assert one.status is same.status is Status.SOLVED
    assert max(same.residuals.values()) < 1e-6
    assert same.postures[ROBOT].torque_norm == pytest.approx(one.postures[ROBOT].torque_norm, rel=1e-4)


def test_averaging_changes_whole_postures_by_no_more_than_what_it_averages(
    problem: DesignProblem, near: Tree
) -> None:
    """1 % of a shank and 0.5 mm of an elbow are less than 0.1 % of the torques."""
    mean = build_problem(source_with(problem, near)).scene.robot.tree
    one, other = (solve(build_problem(source_with(problem, tree, "off"))) for tree in (near, mean))
    assert one.status is other.status is Status.SOLVED
    torques = [solution.postures[ROBOT].torque_norm for solution in (one, other)]
    assert torques[0] == pytest.approx(torques[1], rel=1e-3)
    assert torques[0] != pytest.approx(torques[1], rel=1e-9)
