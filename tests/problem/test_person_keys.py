"""Keys of a person's body and of the grasp: what they make of a problem, and what is refused."""

from __future__ import annotations

import math
from pathlib import Path

import casadi as ca
import pytest

from evodesign.errors import InputError
from evodesign.human.anthropometry import Person
from evodesign.human.anthropometry_tables import Sex, ShoulderWidth
from evodesign.human.body import DEFAULT_JOINTS, human_tree
from evodesign.human.coupled_joints import coupled_joints, rhythms
from evodesign.mechanics.payload import Grasp, GraspDirection
from evodesign.posture.formulations.base import Setting
from evodesign.posture.formulations.codesign import JointProblem
from evodesign.posture.formulations.joint import posture_program
from evodesign.posture.formulations.person import person_program
from evodesign.posture.formulations.reach import robot_reach_program
from evodesign.posture.symmetry import symmetric_forms, whole
from evodesign.posture.terms.registry import TERMS
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.source import read_source
from evodesign.records import ProblemSource
from evodesign.tree.urdf_write import urdf_text

PERSON = 'stature_m = 1.82\nmass_kg = 72.7\nsex = "male"'
GRASP = 'grasp = "point"'


def with_lines(problem: DesignProblem, after: str, *lines: str) -> ProblemSource:
    """The point-grasp problem with further lines after one of its own."""
    text = problem.source.text
    assert after in text
    return ProblemSource("p.toml", text.replace(after, "\n".join((after, *lines)), 1), problem.source.files)


def refused(source: ProblemSource) -> str:
    with pytest.raises(InputError) as caught:
        build_problem(source)
    return str(caught.value)


def expressions(problem: DesignProblem) -> list[str]:
    """Every program of a problem, as CasADi writes it down, with bounds and limits."""
    setting = Setting(problem.scene, problem.space, problem.weights, problem.options)
    forms = symmetric_forms(problem.scene)
    programs = [
        posture_program(forms, setting),
        posture_program((whole(problem.scene.robot), whole(problem.scene.human)), setting),
        robot_reach_program(forms[0], setting),
        person_program(forms[1], problem.scene, 1.0),
    ]
    if not problem.scene.disturbances:
        programs.append(JointProblem(problem.scene, problem.space, problem.tasks, problem.joint).program)
    return [
        ca.Function("nlp", [each.symbols, each.given], [each.cost, each.rows]).serialize()
        + repr((each.bounds, each.limits))
        for each in programs
    ]


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", ["point_grasp", "sartore2023_motors", "sartore2022", "sartore2022_as_published"]
)
def test_without_the_keys_programs_are_those_without_the_terms(
    name: str, repository: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """To the last digit, and so are the digests under which programs and results are kept."""
    problem = build_problem(read_source(repository / "problems" / f"{name}.toml"))
    assert all(scene.payload.grasp_direction is GraspDirection.FREE for scene in problem.scenes)
    assert all(scene.human.coupled_joints == () for scene in problem.scenes)
    assert all(scene.human.gaze is None for scene in problem.scenes)
    assert all(scene.human.measured is None for scene in problem.scenes)
    assert all(scene.human.rhythms == () for scene in problem.scenes)
    before = expressions(problem)
    for term in ("coupled_joints", "grip", "gaze", "measured_posture"):
        monkeypatch.delitem(TERMS, term)
    assert expressions(problem) == before


def test_a_person_whose_joints_share_ranges(problem: DesignProblem) -> None:
    built = build_problem(with_lines(problem, PERSON, 'joint_ranges = "coupled"'))
    assert built.scene.human.coupled_joints == coupled_joints()
    assert built.scene.human.tree == problem.scene.human.tree
    assert built.scene.robot.coupled_joints == ()


def test_a_person_whose_spine_has_a_rhythm(problem: DesignProblem) -> None:
    built = build_problem(with_lines(problem, PERSON, 'joint_ranges = "rhythm"'))
    assert built.scene.human.rhythms == rhythms()
    assert [each.name for each in built.scene.human.coupled_joints] == ["thoracic_flexion"]
    assert built.scene.robot.rhythms == ()
    held = [name for name in DEFAULT_JOINTS if name != "jL4L3_roty"]
    lines = ('joint_ranges = "rhythm"', f"joints = {held}".replace("'", '"'))
    assert refused(with_lines(problem, PERSON, *lines)) == (
        "p.toml: human.joint_ranges: wanted the spine's joints of one movement all among human.joints, such "
        "as 'jL4L3_roty', found 'rhythm' of 'human'"
    )


def test_a_person_from_a_urdf_shares_ranges_where_the_spine_has_the_joints(problem: DesignProblem) -> None:
    frames = (
        'urdf = "person.urdf"\nhands = { left = "LeftPalm", right = "RightPalm" }\n'
        'soles = { left = "LeftSole", right = "RightSole", size_m = [0.27, 0.10] }\njoint_ranges = "coupled"'
    )
    text = urdf_text(human_tree(Person(1.75, 75.0, Sex.FEMALE)))
    files = {**problem.source.files, "person.urdf": text}
    asked = problem.source.text.replace(PERSON, frames)
    built = build_problem(ProblemSource("p.toml", asked, files))
    assert built.scene.human.coupled_joints == coupled_joints()
    files["person.urdf"] = text.replace("jL4L3_roty", "waist")
    assert refused(ProblemSource("p.toml", asked, files)) == (
        "p.toml: human.joint_ranges: wanted 'separate', or a person with the generated one's spine, such as "
        "its joint 'jL4L3_roty', found 'coupled' of 'human'"
    )
    both = asked.replace("joint_ranges", 'shoulder_width = "joint_centres"\njoint_ranges')
    assert "human.shoulder_width: wanted either urdf or" in refused(ProblemSource("p.toml", both, files))


def test_a_person_who_looks_at_the_load(problem: DesignProblem) -> None:
    built = build_problem(with_lines(problem, PERSON, "gaze_cone_deg = 50"))
    gaze = built.scene.human.gaze
    assert gaze is not None
    assert gaze.cone == pytest.approx(math.radians(50.0))
    assert gaze.place == built.scene.human.tree.link_by_name["Head"].inertia.center
    assert built.scene.robot.gaze is None
    headless = urdf_text(human_tree(Person(1.75, 75.0, Sex.FEMALE))).replace('"Head"', '"skull"')
    frames = (
        'urdf = "person.urdf"\nhands = { left = "LeftPalm", right = "RightPalm" }\n'
        'soles = { left = "LeftSole", right = "RightSole", size_m = [0.27, 0.10] }\ngaze_cone_deg = 50'
    )
    asked = problem.source.text.replace(PERSON, frames)
    assert refused(ProblemSource("p.toml", asked, {**problem.source.files, "person.urdf": headless})) == (
        "p.toml: human.gaze_cone_deg: wanted a person with a link 'Head' that looks along its x, as the "
        "generated one has, found 50 for 'human'"
    )


def test_shoulders_are_as_wide_as_they_are_said_to_be(problem: DesignProblem) -> None:
    narrow = build_problem(with_lines(problem, PERSON, 'shoulder_width = "joint_centres"')).scene.human
    named = build_problem(with_lines(problem, PERSON, 'shoulder_width = "drillis_contini"')).scene.human
    assert named.tree == problem.scene.human.tree
    assert narrow.tree == human_tree(Person(1.82, 72.7, Sex.MALE, ShoulderWidth.JOINT_CENTRES))
    for person, share in ((named, 0.259), (narrow, 0.78 * 0.259)):
        joints = person.tree.joint_by_name
        chain = ("jLeftC7Shoulder_rotx", "jLeftShoulder_rotx")
        half = sum(joints[name].parent_from_child.translation[1] for name in chain)
        assert 2.0 * half == pytest.approx(share * 1.82)


def test_a_grasp_has_a_direction_and_a_cone(problem: DesignProblem) -> None:
    free = problem.scene.payload
    assert (free.grasp_direction, free.grasp) == (GraspDirection.FREE, Grasp.POINT)
    under = build_problem(with_lines(problem, GRASP, 'grasp_direction = "under"')).scene.payload
    assert (under.grasp_direction, under.grasp_cone) == (GraspDirection.UNDER, math.radians(60.0))
    lines = ('grasp_direction = "side"', "grasp_cone_deg = 45.0")
    assert build_problem(with_lines(problem, GRASP, *lines)).scene.payload.grasp_cone == math.radians(45.0)
    assert refused(with_lines(problem, GRASP, "grasp_cone_deg = 45.0")) == (
        "p.toml: payload.grasp_cone_deg: wanted a grasp_direction with it, found 45 for free forearms"
    )


@pytest.mark.parametrize("direction", GraspDirection)
def test_axes_of_a_grasp_are_unit_vectors_and_mirror_images(direction: GraspDirection) -> None:
    left, right = (direction.axis(side) for side in ("left", "right"))
    if direction is GraspDirection.FREE:
        assert left is right is None
        return
    assert left is not None
    assert right is not None
    assert math.hypot(*left) == pytest.approx(1.0)
    assert left == (right[0], -right[1], right[2])
    assert left[0] > 0.0, "no forearm points back at its agent"


def test_a_direction_needs_arms_that_bend(problem: DesignProblem) -> None:
    asked = with_lines(problem, GRASP, 'grasp_direction = "side"')
    head, rest = asked.text.split("joints = [", 1)
    legs = 'joints = ["l_hip_pitch", "r_hip_pitch"]' + rest.split("]", 1)[1]
    assert refused(ProblemSource("p.toml", head + legs, asked.files)) == (
        "p.toml: payload.grasp_direction: wanted 'free', or an arm of 'icub_shapes' that bends, found no "
        "moving joint between the trunk and 'l_hand_frame'"
    )
