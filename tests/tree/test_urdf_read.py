from __future__ import annotations

import copy
import math
from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest
from lxml import etree

from evodesign.body.shape import Box, Cylinder, Sphere
from evodesign.errors import ModelError
from evodesign.problem.meshes import with_surfaces
from evodesign.tree.mesh_write import mesh_files, vertices_of
from evodesign.tree.model import JointKind, Mesh, Tree
from evodesign.tree.urdf_read import InertiaRule, read_urdf
from evodesign.tree.urdf_write import urdf_text
from tests.oracles.pinocchio_model import floating_model

TENSOR = '<inertia ixx="0.01" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.03"/>'
BOX = '<visual><origin xyz="0 0 0.1" rpy="0 0 0"/><geometry><box size="0.1 0.2 0.3"/></geometry></visual>'
ARM = f"""<?xml version="1.0" encoding="ISO-8859-1"?>
<!-- a comment -->
<robot name="arm">
  <material name="red"><color rgba="1 0 0 1"/></material>
  <link name="chest">
    <inertial><origin xyz="0 0 0.4" rpy="0 0 0.5"/><mass value="12.0"/>{TENSOR}</inertial>
    {BOX}
    <collision><!-- the same --><geometry><!-- shape --><box size="0.1 0.2 0.3"/></geometry></collision>
  </link>
  <link name="upper"/>
  <link name="hand"/>
  <joint name="shoulder" type="revolute">
    <origin xyz="0 0.2 0.3" rpy="0.1 0.2 0.3"/><parent link="chest"/><child link="upper"/>
    <axis xyz="0 2 0"/><limit lower="-1" upper="2.5" effort="80" velocity="3"/><dynamics damping="a lot"/>
  </joint>
  <joint name="weld" type="fixed">
    <parent link="upper"/><child link="hand"/><axis xyz="nan nan nan"/><limit lower="3" upper="inf"/>
  </joint>
  <gazebo reference="chest"><sensor name="eye"><pose>anything</pose></sensor></gazebo>
</robot>"""

ONE_LINK = '<robot name="r"><link name="body">{}</link></robot>'


def read(text: str, masses: InertiaRule = InertiaRule.SHAPES) -> Tree:
    return read_urdf(text, "arm.urdf", masses)


def one_link(inside: str, masses: InertiaRule = InertiaRule.SHAPES):
    return read(ONE_LINK.format(inside), masses).links[0]


def inertial(mass: float) -> str:
    return f'<inertial><mass value="{mass}"/>{TENSOR}</inertial>'


def look(shape: str, role: str = "visual") -> str:
    return f"<{role}><geometry>{shape}</geometry></{role}>"


def test_links_and_joints_keep_names_and_places():
    tree = read(ARM)
    assert (tree.name, tree.root, tree.actuated) == ("arm", "chest", ("shoulder",))
    shoulder = tree.joint_by_name["shoulder"]
    assert (shoulder.parent, shoulder.child) == ("chest", "upper")
    assert shoulder.parent_from_child.translation == (0.0, 0.2, 0.3)
    assert (shoulder.lower, shoulder.upper, shoulder.effort, shoulder.velocity) == (-1.0, 2.5, 80.0, 3.0)


def test_an_axis_is_normalised():
    assert read(ARM).joint_by_name["shoulder"].axis == (0.0, 1.0, 0.0)
    slanted = read(ARM.replace("0 2 0", "1 -2 2")).joint_by_name["shoulder"].axis
    assert slanted == pytest.approx((1 / 3, -2 / 3, 2 / 3), rel=1e-15)


def test_an_axis_that_is_left_out_is_x():
    assert read(ARM.replace('<axis xyz="0 2 0"/>', "")).joint_by_name["shoulder"].axis == (1.0, 0.0, 0.0)


def test_axis_and_limit_of_a_weld_do_not_matter():
    weld = read(ARM).joint_by_name["weld"]
    assert weld.kind is JointKind.FIXED
    assert (weld.lower, weld.upper, weld.axis) == (0.0, 0.0, (1.0, 0.0, 0.0))


def test_a_continuous_joint_has_no_limits():
    text = ARM.replace('type="revolute"', 'type="continuous"')
    for given in (text, text.replace('<limit lower="-1" upper="2.5" effort="80" velocity="3"/>', "")):
        shoulder = read(given).joint_by_name["shoulder"]
        assert (shoulder.lower, shoulder.upper) == (-math.inf, math.inf)


def test_effort_and_velocity_that_are_left_out_are_infinite():
    shoulder = read(ARM.replace('effort="80" velocity="3"', "")).joint_by_name["shoulder"]
    assert shoulder.effort == shoulder.velocity == math.inf


def test_a_shape_with_mass_overrides_centre_and_tensor():
    chest = read(ARM).link_by_name["chest"]
    (solid,) = chest.solids
    assert solid.shape == Box(0.1, 0.2, 0.3)
    assert solid.density == pytest.approx(12.0 / 0.006, rel=1e-14)
    assert chest.inertia.mass == pytest.approx(12.0, rel=1e-14)
    assert chest.inertia.center == (0.0, 0.0, 0.1)
    assert chest.inertia.about_center[0][0] == pytest.approx(0.04 + 0.09, rel=1e-12)


def test_the_same_shape_seen_and_touched_counts_once():
    assert len(read(ARM).link_by_name["chest"].solids) == 1


def test_a_person_keeps_the_inertia_of_the_file():
    turned = f'<inertial><origin xyz="0 1 0.4" rpy="0.3 0.2 0.5"/><mass value="12"/>{TENSOR}</inertial>'
    body = one_link(turned + BOX, InertiaRule.FILE)
    assert not body.solids
    assert [item.shape for item in body.looks] == [Box(0.1, 0.2, 0.3)]
    found = floating_model(ONE_LINK.format(turned)).inertias[1]
    assert body.inertia.mass == found.mass
    np.testing.assert_allclose(body.inertia.center, found.lever, atol=1e-15)
    np.testing.assert_allclose(body.inertia.about_center, found.inertia, atol=1e-15)


def test_a_link_without_shapes_keeps_its_inertia():
    body = one_link(inertial(3.0))
    assert (body.solids, body.looks, body.inertia.mass) == ((), (), 3.0)
    assert body.inertia.about_center[2][2] == 0.03


def test_a_shape_without_mass_is_a_look():
    for inside in (look('<sphere radius="0.2"/>'), inertial(0.0) + look('<sphere radius="0.2"/>')):
        body = one_link(inside)
        assert [item.shape for item in body.looks] == [Sphere(0.2)]
        assert (body.solids, body.inertia.mass) == ((), 0.0)


def test_several_shapes_share_one_density_and_keep_the_mass():
    body = one_link(inertial(3.0) + look('<sphere radius="0.2"/>') + look('<box size="1 1 1"/>'))
    assert body.solids[0].density == body.solids[1].density
    assert body.inertia.mass == pytest.approx(3.0, rel=1e-14)


LIMIT = '<limit lower="-1" upper="1" effort="1" velocity="1"/>'
MESH, ROD = '<mesh filename="nowhere/a.stl" scale="1 -1 2"/>', '<cylinder radius="0.1" length="0.5"/>'


@pytest.mark.parametrize("seen", [look(MESH), look(MESH) + look('<sphere radius="0.2"/>')])
def test_collision_shapes_stand_in_for_visuals_with_a_mesh(seen):
    body = one_link(inertial(3.0) + seen + look(ROD, "collision"))
    assert [solid.shape for solid in body.solids] == [Cylinder(0.1, 0.5)]


def test_a_shape_that_is_seen_beside_a_mesh_is_a_mesh_itself() -> None:
    body = one_link(inertial(3.0) + look(MESH) + look(ROD), InertiaRule.AUTO)
    assert [mesh.file for mesh in body.meshes] == ["nowhere/a.stl", "cylinder"]
    rod = body.meshes[1]
    assert rod.volume == pytest.approx(0.1**2 * math.pi * 0.5)
    assert np.abs(vertices_of(rod)).max(axis=0) == pytest.approx([0.1, 0.1, 0.25], rel=4e-3)
    assert body.shown == (), "the file of the other is not known"
    assert mesh_files(Tree("r", (body,), ()), "meshes") == ({}, {})
    known = Tree("r", (replace(body, meshes=(replace(body.meshes[0], surface=rod.surface), rod)),), ())
    assert with_surfaces(known, {}, "p.toml") == known
    names, files = mesh_files(known, "meshes")
    assert [*files] == ["meshes/a.stl", "meshes/cylinder.stl"]
    assert all(f'filename="{file}"' in urdf_text(known, names) for file in files)


@pytest.mark.parametrize("touched", ["", look(MESH, "collision"), look(MESH + "", "collision") * 2])
@pytest.mark.parametrize("seen", [look(MESH), look(MESH) + look(ROD)])
def test_a_link_of_meshes_keeps_the_inertia_of_the_file(seen, touched):
    body = one_link(inertial(3.0) + seen + touched)
    assert (body.solids, body.looks, body.inertia.mass) == ((), (), 3.0)
    assert [body.inertia.about_center[i][i] for i in range(3)] == [0.01, 0.02, 0.03]


def test_visual_shapes_do_not_mind_a_mesh_that_is_touched():
    body = one_link(inertial(3.0) + look(ROD) + look(MESH, "collision"))
    assert [solid.shape for solid in body.solids] == [Cylinder(0.1, 0.5)]


def test_meshes_are_looked_at_and_rule_out_what_is_touched_where_nothing_else_is_asked_for():
    inside = inertial(3.0) + look(MESH) + look(ROD, "collision")
    body = one_link(inside, InertiaRule.AUTO)
    assert (body.solids, body.looks) == ((), ())
    assert body.meshes == (Mesh("nowhere/a.stl", (1.0, -1.0, 2.0)),)
    assert body.inertia.about_center[0][0] == 0.01
    assert one_link(inside, InertiaRule.SHAPES).meshes == body.meshes
    assert one_link(inertial(3.0) + look(ROD), InertiaRule.AUTO).solids, "no mesh, so it is its shapes"


def test_a_link_below_a_microgram_has_no_mass():
    assert one_link(inertial(1e-10)).inertia.mass == 0.0
    assert not one_link(inertial(1e-10) + look(ROD)).solids


def notes(inside: str, rule: InertiaRule = InertiaRule.SHAPES) -> list[str]:
    return [note.split(": ")[1] for note in read(ONE_LINK.format(inside), rule).notes]


def test_a_tensor_that_no_body_has_is_noted_where_it_is_kept():
    thin = inertial(3.0).replace('izz="0.03"', 'izz="0.04"')
    assert (
        read(ONE_LINK.format(thin)).notes[0].startswith("no body has the inertia tensor (a principal moment")
    )
    assert notes(thin) == notes(inertial(3.0).replace('ixy="0"', 'ixy="0.1"')) == ["body"]
    assert one_link(thin).inertia.about_center[2][2] == 0.04
    assert notes(thin + look(ROD)) == [], "the shape tells the inertia"
    assert notes(thin + look(ROD), InertiaRule.FILE) == ["body"]
    assert notes(thin.replace('izz="0.04"', 'izz="0.0302"')) == [], "rounded figures"
    assert notes(inertial(3.0).replace("0.01", "0").replace("0.02", "0").replace("0.03", "0")) == []


def test_many_of_a_kind_are_one_note():
    thin = inertial(3.0).replace('izz="0.03"', 'izz="0.04"')
    links = "".join(f'<link name="part_{i}">{thin}</link>' for i in range(5))
    joints = "".join(
        f'<joint name="j{i}" type="fixed"><parent link="part_0"/><child link="part_{i}"/></joint>'
        for i in range(1, 5)
    )
    (note,) = read(f'<robot name="r">{links}{joints}</robot>').notes
    assert note.endswith("alone): part_0, part_1, part_2 and 2 more")


@pytest.mark.parametrize(("shape", "why"), [
    ('<box size="0.1 0 0.3"/>', "whose size is zero"),
    ('<sphere radius="0"/>', "whose size is zero"),
    ('<cone radius="1" length="2"/>', "whose <cone> is no box, cylinder, sphere, capsule or mesh"),
])  # fmt: skip
def test_a_shape_that_cannot_be_used_is_left_out_with_a_note(shape, why):
    tree = read(ONE_LINK.format(inertial(3.0) + look(shape) + look(ROD)))
    assert tree.notes == (f"link body: a visual is left out, {why}",)
    assert [solid.shape for solid in tree.links[0].solids] == [Cylinder(0.1, 0.5)]


@pytest.mark.parametrize("kind", ["revolute", "prismatic"])
@pytest.mark.parametrize(("figures", "offset"), [('multiplier="-2" offset="0.3"', 0.3), ("", 0.0)])
def test_a_mimic_joint_is_locked_where_pinocchio_puts_it(kind, figures, offset):
    text = ARM.replace('<joint name="weld" type="fixed">', '<joint name="weld" type="revolute">')
    text = text.replace(
        '<axis xyz="nan nan nan"/><limit lower="3" upper="inf"/>', '<axis xyz="0 0 1"/>' + LIMIT
    )
    text = text.replace('<joint name="shoulder" type="revolute">', f'<joint name="shoulder" type="{kind}">')
    tree = read(text.replace('<dynamics damping="a lot"/>', f'<mimic joint="weld" {figures}/>'))
    assert tree.notes == ("locked where they are while the joints that they mimic are at zero: shoulder",)
    assert tree.actuated == ("weld",)
    model = pin.buildModelFromXML(text.replace('<dynamics damping="a lot"/>', ""))
    data, positions = model.createData(), pin.neutral(model)
    positions[model.joints[model.getJointId("shoulder")].idx_q] = offset
    pin.framesForwardKinematics(model, data, positions)
    found, place = data.oMf[model.getFrameId("upper")], tree.joint_by_name["shoulder"].parent_from_child
    assert np.allclose(place.rotation, found.rotation, atol=1e-15)
    assert np.allclose(place.translation, found.translation, atol=1e-15)


DAMPING = '<dynamics damping="a lot"/>'
FAULTS = [
    ("0.1 0.2 0.3", "0.1 0.2", "link chest.visual.box.size", "3 finite numbers", "'0.1 0.2'"),
    ("0.1 0.2 0.3", "0.1 -0.2 0.3", "link chest.visual.box.size", "3 finite numbers", "'0.1 -0.2 0.3'"),
    ("0.1 0.2 0.3", "0.1 1e-9 0.3", "link chest.visual.box.size", "from 1e-06 to 1000", "'0.1 1e-9 0.3'"),
    ('size="0.1 0.2 0.3"', "", "link chest.visual.box.size", "3 finite numbers", "nothing"),
    ("<box ", '<box size="1 1 1"/><sphere ', "link chest.visual.geometry", "<cylinder>", "<box>, <sphere>"),
    ("<box ", "<mesh ", "link chest.visual.mesh.filename", "the name of a file", "nothing"),
    ("<box ", '<mesh filename="a" scale="1" ', "link chest.visual.mesh.scale", "3 finite numbers", "'1'"),
    ('<box size="0.1 0.2 0.3"/>', "", "link chest.visual.geometry", "one <box>", "nothing"),
    ('value="12.0"', 'value="-12.0"', "link chest.inertial.mass.value", "from 0", "'-12.0'"),
    ('value="12.0"', 'value="heavy"', "link chest.inertial.mass.value", "a finite number", "'heavy'"),
    ('value="12.0"', "", "link chest.inertial.mass.value", "a finite number", "nothing"),
    ('<mass value="12.0"/>', "", "link chest.inertial.mass", "<mass>", "nothing"),
    (TENSOR, "", "link chest.inertial.inertia", "<inertia>", "nothing"),
    ('iyy="0.02"', 'iyy="nan"', "link chest.inertial.inertia.iyy", "a finite number", "'nan'"),
    ("0 0 0.4", "0 0 1e999", "link chest.inertial.origin.xyz", "3 finite numbers", "'0 0 1e999'"),
    ("0 0.2 0.3", "0 0.2 inf", "joint shoulder.origin.xyz", "3 finite numbers", "'0 0.2 inf'"),
    ("0 2 0", "0 0 0", "joint shoulder.axis.xyz", "a direction", "'0.0 0.0 0.0'"),
    ("0 2 0", "nan nan nan", "joint shoulder.axis.xyz", "3 finite numbers", "'nan nan nan'"),
    ('lower="-1"', 'lower="3"', "joint shoulder.limit.lower", "at most the upper limit 2.5", "3.0"),
    ('lower="-1"', 'lower="-1_0"', "joint shoulder.limit.lower", "a finite number", "'-1_0'"),
    ("<limit lower", "<limits lower", "joint shoulder.limit", "<limit>", "nothing"),
    ('effort="80"', 'effort="-80"', "joint shoulder.limit.effort", "from 0", "'-80'"),
    ('velocity="3"', 'velocity="inf"', "joint shoulder.limit.velocity", "a finite number", "'inf'"),
    ('type="revolute"', 'type="floating"', "joint shoulder.type", "continuous or prismatic", "'floating'"),
    ('type="revolute"', "", "joint shoulder.type", "continuous or prismatic", "nothing"),
    (DAMPING, '<mimic joint="elbow"/>', "joint shoulder.mimic.joint", "name", "'elbow'"),
    (DAMPING, '<mimic joint="shoulder"/>', "joint shoulder.mimic.joint", "name", "'shoulder'"),
    ('<parent link="chest"/>', "", "joint shoulder.parent", "the name of a link", "nothing"),
    ('<child link="upper"/>', "<child/>", "joint shoulder.child", "the name of a link", "nothing"),
    ('<child link="upper"/>', '<child link="uper"/>', "joint shoulder.child", "link", "did you mean 'upper'"),
    ('<link name="hand"/>', '<link name="hand"/><link/>', "link[4].name", "a name", "nothing"),
    ('<link name="hand"/>', '<link name="hand"/><link name="upper"/>', "link upper", "unique", "twice"),
    ('<link name="hand"/>', '<link name="hand"/><link name="foot"/>', "links", "one root", "chest, foot"),
    ('<parent link="upper"/>', '<parent link="hand"/>', "joint weld", "without loops", "a loop"),
    ('<parent link="chest"/>', '<parent link="hand"/>', "joint shoulder", "without loops", "a loop"),
    ('name="weld"', 'name="shoulder"', "joint shoulder", "a unique name", "twice"),
    ('name="weld"', "", "joint[2].name", "a name", "nothing"),
    ('<robot name="arm">', "<robot>", "robot.name", "a name", "nothing"),
    ("0.1 0.2 0.3", "1e4 1 1", "link chest.visual.box.size", "to 1000", "'1e4 1 1'"),
    ('value="12.0"', 'value="1e300"', "link chest.inertial.mass.value", "to 1e+06", "'1e300'"),
    ('izz="0.03"', 'izz="1e300"', "link chest.inertial.inertia.izz", "to 1e+09", "'1e300'"),
    ("0 0.2 0.3", "0 0.2 3e7", "joint shoulder.origin.xyz", "to 1000", "'0 0.2 3e7'"),
    ("0 2 0", "0 1e-9 0", "joint shoulder.axis.xyz", "a direction", "'0.0 1e-09 0.0'"),
    ('value="12.0"', 'value="1&#10;2"', "link chest.inertial.mass.value", "a finite number", "1\\n2"),
    ('value="12.0"', f'value="{"9" * 400}"', "link chest.inertial.mass.value", "a finite", "9..."),
    ('<link name="hand"/>', '<link name="ha&#10;nd"/>', "link[3].name", "on one line", "ha\\nnd"),
    ('"arm"', '"a&#13;m"', "robot.name", "on one line", "'a\\rm'"),
    ('<axis xyz="0 2 0"/>', '<axis/><axis/>', "joint shoulder.axis", "one <axis>", "2"),
    ('<child link="upper"/>', '<child link="hand"/>' * 3, "joint shoulder.child", "one <child>", "3"),
    ('<mass value="12.0"/>', '<mass value="1"/>' * 2, "link chest.inertial.mass", "one <mass>", "2"),
    (BOX, BOX.replace("<geometry>", "<geometry/><geometry>"), "link chest.visual.geometry", "one", "2"),
    ("</inertial>", f"</inertial>{inertial(1.0)}", "link chest.inertial", "one <inertial>", "2"),
]  # fmt: skip


@pytest.mark.parametrize(("old", "new", "key", "wanted", "found"), FAULTS)
def test_a_fault_is_one_sentence_that_names_file_and_element(old, new, key, wanted, found):
    assert old in ARM
    with pytest.raises(ModelError) as caught:
        read(ARM.replace(old, new, 1))
    error = caught.value
    assert (error.source, error.key) == ("arm.urdf", key)
    assert wanted in error.wanted
    assert found in error.found
    assert "\n" not in str(error)


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("", "text that is not XML"),
        ("wheels and gears", "text that is not XML"),
        ("<robot name='r'><link name='a'/>", "text that is not XML"),
        ("\udcff", "text that is not XML"),
        ("<sdf/>", "<sdf>"),
        ("<robot name='r'/>", "none"),
        ("<robot name='r'><joint name='j' type='fixed'/></robot>", "none"),
        ("<!DOCTYPE robot><robot name='r'><link name='a'/></robot>", "a DOCTYPE declaration"),
    ],
)
def test_a_text_that_is_no_urdf_is_refused(text, found):
    with pytest.raises(ModelError, match=r"^arm\.urdf: ") as caught:
        read(text)
    assert caught.value.found.startswith(found)


def test_a_ring_of_links_is_refused():
    weld = '<joint name="{0}" type="fixed"><parent link="{1}"/><child link="{2}"/></joint>'
    links = '<link name="a"/><link name="b"/>'
    ring = weld.format("ab", "a", "b") + weld.format("ba", "b", "a")
    with pytest.raises(ModelError, match=r"^arm\.urdf: links: wanted one root link .* found none"):
        read(f'<robot name="r">{links}{ring}</robot>')


def test_the_second_of_two_shapes_is_named():
    with pytest.raises(ModelError) as caught:
        one_link(look('<mesh filename="a.stl"/>') + look('<sphere radius="-1"/>'))
    assert caught.value.key == "link body.visual[2].sphere.radius"


LAUGHS = "".join(f"<!ENTITY a{i + 1} '{f'&a{i};' * 10}'>" for i in range(12))
BOMB = f"<!DOCTYPE robot [<!ENTITY a0 'ha'>{LAUGHS}]>"


@pytest.mark.parametrize(
    "text",
    [
        f"{BOMB}<robot name='r'><link name='a'/>&a12;</robot>",
        f"{BOMB}<robot name='&a12;'><link name='a'/></robot>",
        "<!DOCTYPE r [<!ENTITY a0 SYSTEM 'file:///dev/zero'>]><robot name='r'><link name='a'/>&a0;</robot>",
        "<!DOCTYPE robot SYSTEM 'http://localhost:1/robot.dtd'><robot name='r'><link name='a'/></robot>",
    ],
    ids=["in the text", "in an attribute", "a file", "a DTD elsewhere"],
)
def test_entities_are_refused_and_nothing_is_made_of_them(text):
    with pytest.raises(ModelError) as caught:
        read(text)
    assert "ha" * 10 not in str(caught.value)
    assert len(str(caught.value)) < 1000


def damaged_copies(text: str):
    """The document with one element or attribute taken away, doubled, or replaced by nonsense."""
    root = etree.fromstring(text.encode())
    for number, element in enumerate(root.iter(etree.Element)):
        for change in (None, "", "x", "nan", "1e999", "-1", "0 0 0", "1e300 1e300 1e300"):
            for name in element.attrib:
                damaged = copy.deepcopy(root)
                victim = list(damaged.iter(etree.Element))[number]
                victim.attrib.pop(name) if change is None else victim.set(name, change)
                yield damaged
        if element is not root:
            for double in (False, True):
                damaged = copy.deepcopy(root)
                victim = list(damaged.iter(etree.Element))[number]
                parent = victim.getparent()
                parent.append(copy.deepcopy(victim)) if double else parent.remove(victim)
                yield damaged


def test_any_single_damage_is_read_or_refused_with_a_sentence():
    read_well, sentences = 0, []
    for damaged in damaged_copies(ARM):
        try:
            tree = read(etree.tostring(damaged, encoding="unicode"))
        except ModelError as error:
            sentences.append(str(error))
        else:
            read_well += math.isfinite(sum(link.inertia.mass for link in tree.links))
    assert read_well > 50
    assert len(sentences) > 50
    assert not [sentence for sentence in sentences if "yourdfpy" in sentence or "\n" in sentence]
