"""Small inputs, each with one fault of a kind that public robots have: a right value or a sentence.

They lie in the folder `shared` beside the checkout. The kinds have inputs of their own in
tests/tree/test_silent_readers.py.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

from evodesign.body.placement import Placement
from evodesign.errors import InputError
from evodesign.posture.symmetry import whole
from evodesign.posture.terms.floating_base import joint_ranges
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.notes import notes
from evodesign.problem.source import read_source
from evodesign.tree.frames import link_frames
from tests.machine import leave_out
from tests.problem.test_notes import strange

CASES = Path(__file__).parents[3] / "shared/cases"

SENTENCES = {
    "atlas_drake": r"not read: <drake:proximity_properties> in <geometry>: l_foot_rear",
    "limits_degrees": r"limits beyond two turns, which look like degrees: torso_roll \(-23 to 23 rad\)",
    "mesh_mm": r"links with meshes of more than 10 m, which look like millimetres: head \(200 m\)",
    "mj_eqsolo": r"locked where an equality holds them: neck_pitch, neck_roll",
    "mj_springs": r"springs of joints hold torque at rest, .*: l_knee \(200 N m/rad about 0.5 rad\)",
    "mimic_chain": r"locked where they are while .* mimic are at zero: neck_pitch, neck_roll",
    "capsule": r"capsules are meshes of triangles, .*: l_upper_arm, r_upper_arm, l_forearm",
}
REFUSALS = {
    "mesh_empty": r"link head: wanted a mesh of triangles, found '.*h.stl', which is empty",
    "mesh_lfs": r"link head: wanted a mesh of triangles, found '.*h.stl', which is a Git LFS pointer",
    "underscore": r"link torso_2.inertial.mass.value: wanted a finite number .*found '1_4.5349'",
    "xacro_head": r"wanted a URDF: expand with xacro .*, found <xacro:head>",
}


def case(name: str) -> Path:
    if not CASES.is_dir():
        leave_out("the small inputs are not in the folder 'shared' beside the checkout")
    return CASES / name / "p.toml"


def built(name: str) -> DesignProblem:
    return build_problem(read_source(case(name)))


@pytest.mark.parametrize("name", SENTENCES)
def test_what_a_case_says_and_a_robot_has_not_is_told(name: str) -> None:
    assert any(re.search(SENTENCES[name], note) for note in notes(built(name)))


@pytest.mark.parametrize("name", REFUSALS)
def test_what_cannot_be_read_of_a_case_is_refused(name: str) -> None:
    with pytest.raises(InputError, match=REFUSALS[name]):
        built(name)


@pytest.mark.parametrize("name", ["quat_xyzw_sym", "toml_bom", "quat_as_rpy", "limit_above_pi"])
def test_of_what_is_read_rightly_nothing_is_told(name: str) -> None:
    told = strange(built(name))
    assert [each for each in told if not each.startswith("human: how measured people stand")] == []


@pytest.mark.parametrize("name", ["quat_xyzw_sym", "quat_as_rpy", "capsule", "atlas_drake"])
def test_masses_and_places_of_a_case_are_those_of_pinocchio(name: str) -> None:
    tree = built(name).scene.robot.tree
    text = (case(name).parent / "r.urdf").read_text(encoding="utf-8")
    model = pin.buildModelFromXML(text)
    data = model.createData()
    pin.framesForwardKinematics(model, data, pin.neutral(model))
    assert tree.mass == pytest.approx(sum(each.mass for each in model.inertias), rel=1e-12)
    for link, place in link_frames(tree, Placement(), {}).items():
        theirs = data.oMf[model.getFrameId(link)]
        np.testing.assert_allclose(place.rotation, theirs.rotation, atol=1e-12)
        np.testing.assert_allclose(place.translation, theirs.translation, atol=1e-12)


@pytest.mark.parametrize("name", ["mimic_chain", "mj_eqsolo"])
def test_the_head_of_a_case_is_turned_by_0_7(name: str) -> None:
    """Of a held joint at 0.3 and its follower: 0.1 + 2 * 0.3, as MuJoCo's constraints and the READMEs say."""
    frames = link_frames(built(name).scene.robot.tree, Placement(), {})
    turned = frames["neck_2"].inverse @ frames["neck_3"]
    np.testing.assert_allclose(pin.rpy.matrixToRpy(np.array(turned.rotation)), (0.7, 0.0, 0.0), atol=1e-12)
    turned = frames["neck_1"].inverse @ frames["neck_2"]
    np.testing.assert_allclose(pin.rpy.matrixToRpy(np.array(turned.rotation)), (0.0, -0.3, 0.0), atol=1e-12)


def test_a_range_beyond_half_a_turn_is_looked_at_where_it_lies() -> None:
    form = whole(built("limit_above_pi").scene.robot)
    ranges = dict(zip(form.joints, joint_ranges(form), strict=True))
    assert ranges["l_wrist_prosup"] == ranges["r_wrist_prosup"] == (3.5, 5.0)
