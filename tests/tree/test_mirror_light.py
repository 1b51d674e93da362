"""Sensors, frames and mounts that stand on one side do not decide whether a robot is symmetric."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

from evodesign.errors import ModelError
from evodesign.tree.averaging import averaged
from evodesign.tree.mirror_images import PLACE, SHARE, seen_in_root
from evodesign.tree.model import Tree
from evodesign.tree.symmetry import mirror_of
from evodesign.tree.urdf_read import InertiaRule, read_urdf
from evodesign.tree.urdf_write import urdf_text
from tests.oracles.pinocchio_model import floating_model

ICUB = (Path(__file__).parents[2] / "problems/robots/icub_shapes.urdf").read_text(encoding="utf-8")
SEEN = '<visual><geometry><box size="0.02 0.03 0.01"/></geometry></visual>'


def body(mass: float) -> str:
    moments = " ".join(
        f'i{axis}="{1e-3 * mass * (axis[0] == axis[1])}"' for axis in ("xx", "xy", "xz", "yy", "yz", "zz")
    )
    return f'<inertial><origin xyz="0.01 0.02 0"/><mass value="{mass}"/><inertia {moments}/></inertial>'


def held(name: str, parent: str, inside: str = "", xyz: str = "0.05 0.04 0.1") -> str:
    """A link that a fixed joint holds, turned in some way."""
    return (
        f'<link name="{name}">{inside}</link><joint name="{name}_joint" type="fixed">'
        f'<parent link="{parent}"/><child link="{name}"/><origin xyz="{xyz}" rpy="0.1 0.2 0.3"/></joint>'
    )


def icub(more: str = "") -> Tree:
    return read_urdf(ICUB.replace("</robot>", f"{more}</robot>"), "icub", InertiaRule.AUTO)


@pytest.mark.parametrize(
    "more",
    [
        held("imu", "chest"),
        held("imu", "l_upper_leg"),
        held("imu", "chest", SEEN),
        held("imu", "chest") + held("optical", "imu"),
        held("imu", "chest", body(1e-10)),
    ],
)
def test_frames_without_mass_stand_anywhere_on_an_exact_robot(more: str) -> None:
    mirror = mirror_of(icub(more))
    assert "imu" in mirror.loose
    assert mirror.joints["l_knee"] == "r_knee"


@pytest.mark.parametrize("parent", ["chest", "l_upper_leg", "root_link"])
@pytest.mark.parametrize("inside", [body(1e-6), body(0.001), body(0.05), body(0.01) + SEEN])
def test_the_mass_of_a_sensor_is_halved_to_both_sides_as_in_the_mean_with_the_image(
    inside: str, parent: str
) -> None:
    tree = icub(held("imu", parent, inside))
    with pytest.raises(ModelError):
        mirror_of(tree)
    mean = averaged(tree)
    assert mean.halved == ("imu",)
    assert str(mean).endswith("of light links without a partner half the mass is on either side: imu")
    mirror = mirror_of(mean.tree)
    assert mirror.links["imu"] == "imu_image"
    model, before = (floating_model(urdf_text(each)) for each in (mean.tree, tree))
    assert pin.computeTotalMass(model) == pytest.approx(pin.computeTotalMass(before), rel=1e-12)
    ours, theirs = (pin.centerOfMass(each, each.createData(), pin.neutral(each)) for each in (model, before))
    np.testing.assert_allclose(ours, theirs * (1.0, 0.0, 1.0), atol=1e-12)


def test_a_heavy_link_on_one_side_is_refused_as_before() -> None:
    with pytest.raises(
        ModelError, match="joint imu_joint: wanted a mirror image in the plane y = 0, found none"
    ):
        averaged(icub(held("imu", "chest", body(0.5))))


@pytest.mark.parametrize("inside", ["", body(0.001)])
def test_a_mount_between_two_links_of_one_side_changes_nothing(inside: str) -> None:
    hip = re.search(r'<joint name="l_hip_pitch".*?</joint>', ICUB, re.DOTALL)
    assert hip is not None
    origin = re.search(r"<origin[^>]*/>", hip[0])
    assert origin is not None
    mounted = hip[0].replace(origin[0], "").replace('"root_link"', '"mount"')
    mount = (
        f'<link name="mount">{inside}</link><joint name="mount_joint" type="fixed"><parent link="root_link"/>'
        f'<child link="mount"/>{origin[0]}</joint>'
    )
    tree = read_urdf(ICUB.replace(hip[0], mount + mounted), "icub", InertiaRule.AUTO)
    mean = averaged(tree)
    mirror = mirror_of(mean.tree)
    assert mirror.joints["l_hip_pitch"] == "r_hip_pitch"
    assert mean.tree.parent_joint["l_hip_1"].parent == "root_link"
    assert mean.tree.mass == pytest.approx(tree.mass, rel=1e-12)


def shifted(millimetres: float) -> Tree:
    """An iCub whose left shoulder is further back."""
    tree = icub()
    joint = tree.joint_by_name["l_shoulder_pitch"]
    x, y, z = joint.parent_from_child.translation
    moved = replace(
        joint, parent_from_child=replace(joint.parent_from_child, translation=(x + 1e-3 * millimetres, y, z))
    )
    return replace(tree, joints=tuple(moved if each.name == joint.name else each for each in tree.joints))


def test_a_shoulder_may_be_off_by_a_share_of_the_longest_link_above_it() -> None:
    reach = seen_in_root(icub())["l_shoulder_1"].reach
    assert SHARE * reach > PLACE, "or the test is of the other tolerance"
    most = 1e3 * SHARE * reach
    mean = averaged(shifted(0.95 * most))
    mirror_of(mean.tree)
    assert f"{0.95 * most:.2g} mm in the place of joint l_" in str(mean)
    with pytest.raises(ModelError, match=rf"mm in the place of joint .* \({most:.2g} mm allowed\)"):
        averaged(shifted(1.05 * most))
