"""What robots' files say is read rightly, told in a sentence or refused in one: nothing is passed over.

Right values are those of pinocchio (urdfdom) and MuJoCo on the same text.
"""

from __future__ import annotations

import math
import re
from pathlib import Path

import mujoco
import numpy as np
import pinocchio as pin
import pytest
import trimesh

from evodesign.body.placement import Placement
from evodesign.errors import InputError, ModelError
from evodesign.problem.agent_tables import RobotTable
from evodesign.problem.meshes import mesh_texts, with_surfaces
from evodesign.problem.named_files import read_robot
from evodesign.tree.frames import link_frames
from evodesign.tree.mjcf_read import translated
from evodesign.tree.model import Tree
from evodesign.tree.urdf_read import InertiaRule, read_urdf

TENSOR = '<inertia ixx="0.01" ixy="0.001" ixz="0" iyy="0.02" iyz="0" izz="0.025"/>'
INERTIAL = f'<inertial><origin xyz="0.01 0.02 0.03"/><mass value="2"/>{TENSOR}</inertial>'
SHAPE = '<visual><geometry><box size="0.1 0.2 0.3"/></geometry></visual>'
LIMIT = '<limit lower="-1" upper="2" effort="30" velocity="4"/>'
ROBOT = f"""<robot name="small" version="1.1">
  <link name="trunk">{INERTIAL}</link><link name="arm">{INERTIAL}{SHAPE}</link>
  <link name="hand">{INERTIAL}</link>
  <joint name="shoulder" type="revolute"><origin xyz="0 0.2 0.3" rpy="0.1 0.2 0.3"/>
    <parent link="trunk"/><child link="arm"/><axis xyz="0 1 0"/>{LIMIT}</joint>
  <joint name="wrist" type="revolute"><origin xyz="0 0 -0.3"/>
    <parent link="arm"/><child link="hand"/><axis xyz="1 0 0"/>{LIMIT}</joint>
</robot>"""


def read(text: str, rule: InertiaRule = InertiaRule.FILE) -> Tree:
    return read_urdf(text, "small.urdf", rule)


def changed(*pairs: tuple[str, str]) -> str:
    """The small robot with pieces replaced that each stand in it."""
    text = ROBOT
    for old, new in pairs:
        assert old in text, old
        text = text.replace(old, new, 1)
    return text


QUATERNION = ("0.2 0.3 0.4 0.8", "0 0.149 0 -0.9", "1 0 0 0")


@pytest.mark.parametrize("quaternion", QUATERNION)
def test_a_quaternion_turns_as_pinocchio_turns_it(quaternion: str) -> None:
    text = changed(
        ('rpy="0.1 0.2 0.3"', f'quat_xyzw="{quaternion}"'),
        ('<origin xyz="0.01 0.02 0.03"/>', f'<origin xyz="0.1 0 0" quat_xyzw="{quaternion}"/>'),
    )
    tree, model = read(text), pin.buildModelFromXML(text)
    assert tree.notes == ()
    place = model.jointPlacements[model.getJointId("shoulder")]
    np.testing.assert_allclose(
        tree.joint_by_name["shoulder"].parent_from_child.rotation, place.rotation, atol=1e-15
    )
    trunk = pin.buildModelFromXML(text, pin.JointModelFreeFlyer()).inertias[1]
    ours = tree.link_by_name["trunk"].inertia
    np.testing.assert_allclose(ours.about_center, trunk.inertia, atol=1e-15)
    np.testing.assert_allclose(ours.center, trunk.lever, atol=1e-15)


def test_a_quaternion_places_a_shape_as_the_same_angles_do() -> None:
    visual = SHAPE.replace("<geometry>", "<origin {}/><geometry>")
    turned, same = (
        read(changed((SHAPE, visual.format(how)))).link_by_name["arm"].looks[0].link_from_look
        for how in ('quat_xyzw="0.3826834323650898 0 0 0.9238795325112867"', f'rpy="{math.pi / 4.0} 0 0"')
    )
    np.testing.assert_allclose(turned.rotation, same.rotation, atol=1e-15)


@pytest.mark.parametrize(
    "given", ['lower="-2"', 'upper="1.5"', "", 'lower="0" upper="6.28"', 'lower="3.5" upper="5"']
)
def test_limits_that_are_left_out_are_zero_and_others_kept_as_by_pinocchio(given: str) -> None:
    text = changed((LIMIT, f'<limit {given} effort="30" velocity="4"/>'))
    joint, model = read(text).joint_by_name["shoulder"], pin.buildModelFromXML(text)
    at = model.joints[model.getJointId("shoulder")].idx_q
    assert (joint.lower, joint.upper) == (model.lowerPositionLimit[at], model.upperPositionLimit[at])


FOREIGN = {
    "drake, declared": ("<robot ", '<robot xmlns:drake="http://drake.mit.edu" ', "<drake:declare_convex/>"),
    "drake, not declared": ("<robot ", "<robot ", "<drake:declare_convex/>"),
    "without a prefix": ("<robot ", "<robot ", "<proximity hydroelastic='soft'/>"),
}


@pytest.mark.parametrize("case", FOREIGN)
def test_a_shape_is_read_with_whatever_stands_beside_it(case: str) -> None:
    old, new, child = FOREIGN[case]
    tree = read(changed((old, new), ('0.3"/></geometry>', f'0.3"/>{child}</geometry>')), InertiaRule.SHAPES)
    assert tree.links == read(ROBOT, InertiaRule.SHAPES).links
    (note,) = tree.notes
    assert re.fullmatch(r"not read: <(drake:declare_convex|proximity)> in <geometry>: arm", note)


CAPSULE = '<capsule radius="0.05" length="0.2"/>'


@pytest.mark.parametrize("rule", InertiaRule)
@pytest.mark.parametrize("role", ["visual", "collision"])
def test_a_capsule_has_its_volume_and_the_inertia_that_pinocchio_reads(role: str, rule: InertiaRule) -> None:
    shape = SHAPE.replace("visual", role)
    text = changed((SHAPE, shape.replace('<box size="0.1 0.2 0.3"/>', CAPSULE)), ('"1.1"', '"1.2"'))
    link = read(text, rule).link_by_name["arm"]
    volume = math.pi * 0.05**2 * 0.2 + 4.0 / 3.0 * math.pi * 0.05**3
    assert link.volume == pytest.approx(volume, rel=1e-12)
    (mesh,) = link.shown
    assert mesh.surface is not None
    solid = trimesh.Trimesh(mesh.surface.vertices, mesh.surface.faces)
    assert solid.is_watertight
    assert 0.98 * volume < solid.volume < volume
    assert solid.extents == pytest.approx((0.1, 0.1, 0.3), rel=0.01)
    model = pin.buildModelFromXML(text)
    theirs = model.inertias[model.getJointId("shoulder")]
    assert link.inertia.mass == theirs.mass
    np.testing.assert_allclose(link.inertia.center, theirs.lever, atol=1e-15)
    np.testing.assert_allclose(link.inertia.about_center, theirs.inertia, atol=1e-15)
    geometry = pin.buildGeomFromUrdfString(model, text, pin.GeometryType.COLLISION).geometryObjects
    for each in geometry:  # the length is between the balls' centres
        assert (each.geometry.radius, 2.0 * each.geometry.halfLength) == (0.05, 0.2)


def chain(*followers: str) -> str:
    """A fan of joints on one trunk: `name leader multiplier offset`."""
    links = "".join(f'<link name="{each.split()[0]}_link">{INERTIAL}</link>' for each in ("a", *followers))
    joint = (
        '<joint name="{0}" type="revolute"><parent link="trunk"/><child link="{0}_link"/><axis xyz="1 2 0"/>'
        '<limit lower="-9" upper="9" effort="1" velocity="1"/>{1}</joint>'
    )
    mimic = '<mimic joint="{1}" multiplier="{2}" offset="{3}"/>'
    joints = [joint.format(each.split()[0], mimic.format(*each.split())) for each in followers]
    parts = f'<link name="trunk">{INERTIAL}</link>{links}{joint.format("a", "")}{"".join(joints)}'
    return f'<robot name="fan">{parts}</robot>'


CHAINS = [
    ("b a 1 0.3", "c b 2 0.1"),
    ("c b 2 0.1", "b a -1 0.3"),
    ("d c 0.5 -0.2", "c b 2 0.1", "b a 3 0.3"),
    ("b a 1 0.3", "c a 1 -0.4", "d c -2 0"),
]


@pytest.mark.parametrize("followers", CHAINS)
def test_followers_of_followers_are_locked_where_mujoco_holds_them(followers: tuple[str, ...]) -> None:
    text = chain(*followers)
    frames = link_frames(read(text), Placement(), {})
    model = mujoco.MjModel.from_xml_string(text.replace("</robot>", FUSED))
    data = mujoco.MjData(model)
    for _ in range(len(followers)):  # MuJoCo's own constraints say where the followers are
        for row in range(model.neq):
            one, two = int(model.eq_obj1id[row]), int(model.eq_obj2id[row])
            leader = data.qpos[model.jnt_qposadr[two]]
            data.qpos[model.jnt_qposadr[one]] = np.polynomial.polynomial.polyval(
                leader, model.eq_data[row, :5]
            )
    mujoco.mj_forward(model, data)
    assert model.neq == len(followers)
    for link in (f"{each.split()[0]}_link" for each in followers):
        np.testing.assert_allclose(np.ravel(frames[link].rotation), data.body(link).xmat, atol=1e-12)


FUSED = '<mujoco><compiler fusestatic="false"/></mujoco></robot>'


def test_joints_that_follow_each_other_in_a_ring_are_refused() -> None:
    with pytest.raises(ModelError, match=r"joint b.mimic.joint: wanted a leader .*, found 'b', which does"):
        read(chain("b c 1 0", "c b 1 0"))


NOTED = {
    "a loop of Drake": (
        ("</robot>", '<loop_joint name="crank"/></robot>'),
        r"not read: <loop_joint> in <robot>: crank",
    ),
    "a spring of a joint": (
        (LIMIT, LIMIT + '<spring stiffness="9"/>'),
        r"not read: <spring> in <joint>: shoulder",
    ),
    "a limit of acceleration": (
        ("<limit lower", '<limit acceleration="9" lower'),
        "not read: acceleration of <limit>: sho",
    ),
    "an attribute with a prefix": (
        ("<limit lower", '<limit drake:jerk="9" lower'),
        "not read: drake:jerk of <limit>: sho",
    ),
    "friction": (
        (LIMIT, LIMIT + '<dynamics friction="2"/>'),
        r"damping and friction of joints are not counted: shoulder",
    ),
    "soft limits": (
        (LIMIT, LIMIT + "<safety_controller/>"),
        r"not read: <safety_controller> in <joint>: shoulder",
    ),
    "a spring of Gazebo": (
        ("</robot>", '<gazebo reference="wrist"><springStiffness>40</springStiffness></gazebo></robot>'),
        r"not read: <springStiffness> in <gazebo>: wrist",
    ),
    "weightlessness in Gazebo": (
        ("</robot>", '<gazebo reference="arm"><turnGravityOff>true</turnGravityOff></gazebo></robot>'),
        r"not read: <turnGravityOff> in <gazebo>: arm",
    ),
    "a loop of Gazebo": (
        ("</robot>", '<gazebo><joint name="rod"/></gazebo></robot>'),
        r"<joint> in <gazebo>: rod",
    ),
    "another version": (('"1.1"', '"3.0"'), r"version '3.0' of URDF is not known: read as 1.2"),
    "a mass twice": (('<mass value="2"/>', '<mass value="2" unit="g"/>'), r"not read: unit of <mass>: trunk"),
    "a density": (("<inertial>", "<inertial><density/>"), r"not read: <density> in <inertial>: trunk"),
    "degrees": (
        ('lower="-1" upper="2"', 'lower="-45" upper="115"'),
        r"look like degrees: shoulder \(-45 to 115 rad\)",
    ),
    "an origin in millimetres": (
        ("0 0.2 0.3", "0 200 300"),
        r"joints of more than 10 m, .* millimetres: shoulder",
    ),
    "a shape in millimetres": (
        ("0.1 0.2 0.3", "100 200 300"),
        r"links with shapes of more than 10 m, .* arm \(300 m",
    ),
    "a shape scaled twice": (
        ('size="0.1 0.2 0.3"', 'size="1e-4 2e-4 3e-4"'),
        r"links of less than 2 mm, .* arm \(0.3 mm",
    ),
    "a centre in millimetres": (
        ('<origin xyz="0.01 0.02 0.03"/>', '<origin xyz="10 20 30"/>'),
        r"centres of mass of more than 10 m, which look like millimetres: trunk",
    ),
    "a tensor in kg mm^2": (
        (TENSOR, '<inertia ixx="1e4" ixy="0" ixz="0" iyy="2e4" iyz="0" izz="2.5e4"/>'),
        r"radii of gyration of more than 2 m, which look like kg mm\^2: trunk \(112 m\)",
    ),
    "grams": (
        ('<mass value="2"/>', '<mass value="2000"/>'),
        r"heavier than 500 kg, which look like grams: trunk",
    ),
}


@pytest.mark.parametrize("case", NOTED)
def test_what_is_not_read_or_looks_wrong_is_told_in_one_sentence(case: str) -> None:
    change, sentence = NOTED[case]
    tree = read(changed(change))
    (note,) = tree.notes
    assert re.search(sentence, note)
    assert tree.mass > 0.0


def test_of_very_many_kinds_the_others_are_counted() -> None:
    tree = read(changed((LIMIT, LIMIT + "".join(f"<x{number}/>" for number in range(30)))))
    assert len(tree.notes) == 21
    assert tree.notes[-1] == "not read: 10 more kinds of elements and attributes"


def test_a_quaternion_that_others_ignore_is_read_and_told() -> None:
    text = changed(('rpy="0.1 0.2 0.3"', 'quat_xyzw="1 0 0 1"'), (' version="1.1"', ""))
    tree = read(text)
    (note,) = tree.notes
    assert note.startswith("quat_xyzw is read, which others ignore")
    assert np.array(tree.joint_by_name["shoulder"].parent_from_child.rotation)[2, 1] == pytest.approx(1.0)


def test_what_changes_nothing_is_not_told() -> None:
    harmless = (
        '<material name="red"><color rgba="1 0 0 1"/></material><transmission name="t"/><sensor name="s"/>'
        '<gazebo reference="arm"><mu1>0.9</mu1><turnGravityOff>false</turnGravityOff></gazebo></robot>'
    )
    text = changed(
        ("</robot>", harmless),
        (LIMIT, LIMIT + '<dynamics damping="0" friction="0.0"/><calibration rising="0"/>'),
        ("<geometry>", '<material name="red"/><geometry>'),
    )
    assert read(text) == read(ROBOT)


REFUSED = {
    "a call of xacro": (
        "</robot>",
        '<xacro:head parent="arm"/></robot>',
        r"expand with xacro .*, found <xacro:head>",
    ),
    "a macro in a link": ("<inertial>", "<inertial><xacro:box/>", r"link trunk: .* found <xacro:box>"),
    "a name": ('name="small"', 'name="${name}"', r"small.urdf: .*expand with xacro .*found '\$\{name\}'"),
    "an expression": (
        'value="2"',
        'value="${mass}"',
        r"link trunk: .*expand with xacro .*found '\$\{mass\}'",
    ),
    "an argument": (
        "</geometry>",
        '<mesh filename="$(find a)/b.stl"/></geometry>',
        r"link arm: .*expand with xacro",
    ),
    "an underscore": (
        'value="2"',
        'value="1_4.5"',
        r"mass.value: wanted a finite number from 0 .*found '1_4.5'",
    ),
    "infinity": ('upper="2"', 'upper="infinity"', r"limit.upper: wanted a finite number, found 'infinity'"),
    "no number": ('ixx="0.01"', 'ixx="nan"', r"inertia.ixx: wanted a finite number .*, found 'nan'"),
    "hexadecimal": ('effort="30"', 'effort="0x1E"', r"limit.effort: wanted a finite number .*found '0x1E'"),
    "digits of other scripts": ('value="2"', 'value="२"', r"mass.value: wanted a finite number"),
    "a decimal comma": ('value="2"', 'value="2,5"', r"mass.value: wanted a finite number"),
    "two rotations": (
        'rpy="0.1 0.2 0.3"',
        'rpy="0 0 0" quat_xyzw="0 0 0 1"',
        r"wanted either rpy or quat_xyzw, found both",
    ),
    "no rotation": ('rpy="0.1 0.2 0.3"', 'quat_xyzw="0 0 0 0"', r"origin.quat_xyzw: wanted a rotation"),
    "three of four": ('rpy="0.1 0.2 0.3"', 'quat_xyzw="0 0 1"', r"quat_xyzw: wanted 4 finite numbers"),
    "two shapes": ("</geometry>", f"{CAPSULE}</geometry>", r"<capsule> or <mesh>, found <box>, <capsule>"),
    "no limits": (LIMIT, "", r"joint shoulder.limit: wanted <limit>, found nothing"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_cannot_be_read_is_refused_in_one_sentence(case: str) -> None:
    old, new, sentence = REFUSED[case]
    with pytest.raises(ModelError, match=sentence) as caught:
        read(changed((old, new)))
    assert "\n" not in str(caught.value)


MJCF = """<mujoco model="small">{head}<compiler angle="radian"/>
  <worldbody><body name="trunk"><freejoint/><geom size="0.1"/>
    <body name="arm" pos="0.1 0.2 0"><joint name="elbow" axis="0 1 0" range="-1 2" {joint}/>
      <geom size="0.1" mass="{mass}"/>
      <site name="palm"/>
      <body name="hand" pos="0.3 0 0"><joint name="wrist" axis="1 0.5 0" ref="{ref}"/><geom size="0.05"/>
        <body name="tip" pos="0.1 0 0"><joint name="tip" type="slide" axis="1 0 1" range="-1 1" {slide}/>
          <geom size="0.02"/>
          <body name="end" pos="0 0.1 0"><joint name="end" axis="0 0 1"/><geom size="0.02"/></body>
        </body></body></body>
    <site name="neck" pos="0 0 0.2"/></body></worldbody>{tail}</mujoco>"""


def mjcf(
    head: str = "", joint: str = "", slide: str = "", tail: str = "", ref: str = "0", mass: str = "1"
) -> str:
    return MJCF.format(head=head, joint=joint, slide=slide, tail=tail, ref=ref, mass=mass)


def read_mjcf(text: str, folder: Path) -> Tree:
    (folder / "small.xml").write_text(text)
    return read_urdf(translated(folder / "small.xml", "small.xml").urdf, "small.xml", InertiaRule.FILE)


HELD = {
    "held": ["wrist 0.3"],
    "follows a held one": ["wrist 0.3", "end wrist 0.1 2 0.5"],
    "follows a follower of a held one": ["end tip 0.1 2 0 -1", "tip wrist 0.2 -1", "wrist 0.3"],
    "follows a follower of one that moves": ["tip elbow 0.1 0.2", "wrist tip 0.2 2 3"],
    "two follow one": ["tip elbow -0.3 2", "end elbow 0.5 0 1"],
}


def equality(rule: str) -> str:
    """`joint coefficient` or `joint leader coefficients ..`."""
    moved, *others = rule.split()
    leader = f'joint2="{others.pop(0)}"' if len(others) > 1 else ""
    return f'<joint joint1="{moved}" {leader} polycoef="{" ".join([*others, *["0"] * (5 - len(others))])}"/>'


@pytest.mark.parametrize("ref", ["0", "0.4"])
@pytest.mark.parametrize("case", HELD)
def test_joints_of_equalities_are_locked_where_mujoco_s_constraints_are_satisfied(
    case: str, ref: str, tmp_path: Path
) -> None:
    rules = "".join(map(equality, HELD[case]))
    text = mjcf(tail=f"<equality>{rules}</equality>", ref=ref)
    tree = read_mjcf(text, tmp_path)
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    free = dict.fromkeys(tree.actuated, 0.0)
    coupled = [model.joint(int(joint)).name for joint in model.eq_obj1id]
    assert not set(free) & set(coupled)
    for name in free:
        data.joint(name).qpos[0] = 0.0
    for _ in range(60):  # Newton on the constraints, with the joints that move kept
        mujoco.mj_forward(model, data)
        rows = data.efc_J.reshape(-1, model.nv)[: data.ne][
            :, [int(model.joint(n).dofadr[0]) for n in coupled]
        ]
        step = np.linalg.solve(rows, data.efc_pos[: data.ne])
        for name, by in zip(coupled, step, strict=True):
            data.joint(name).qpos[0] -= by
    assert np.abs(data.efc_pos[: data.ne]).max() < 1e-12
    frames = link_frames(tree, Placement(), {})
    for body in ("arm", "hand", "tip", "end"):
        np.testing.assert_allclose(frames[body].translation, data.body(body).xpos, atol=1e-9)
        np.testing.assert_allclose(np.ravel(frames[body].rotation), data.body(body).xmat, atol=1e-9)


CORD = '<tendon><spatial name="cord" {}><site site="neck"/><site site="palm"/></spatial></tendon>'
MUSCLE = '<actuator><muscle name="biceps" joint="elbow" lengthrange="0.1 0.5"/></actuator>'
NOTED_OF_MJCF = {
    "a spring": (
        {"joint": 'stiffness="200" springref="0.5"'},
        r"springs .*: elbow \(200 N m/rad about 0.5 rad\)",
    ),
    "a spring of a slide": ({"slide": 'stiffness="7"'}, r"springs of joints .*: tip \(7 N/m about 0 m\)"),
    "a tilted gravity": (
        {"head": '<option gravity="0 3 -9"/>'},
        r"gravity is 9.81 .* as in the file: \(0, 3, -9\)",
    ),
    "gravity of the moon": ({"head": '<option gravity="0 0 -1.62"/>'}, r"as in the file: \(0, 0, -1.62\)"),
    "no gravity": ({"head": '<option><flag gravity="disable"/></option>'}, r"as in the file: \(0, 0, 0\)"),
    "damping": ({"joint": 'damping="3"'}, r"damping, friction and armature .*: elbow"),
    "friction": ({"joint": 'frictionloss="3"'}, r"damping, friction and armature .*: elbow"),
    "armature": ({"joint": 'armature="3"'}, r"damping, friction and armature .*: elbow"),
    "a cord": ({"tail": CORD.format('stiffness="50"')}, r"tendons hold torque .*: cord"),
    "a cord that ends": (
        {"tail": CORD.format('limited="true" range="0 1"')},
        r"or limit joints, which is not counted: cord",
    ),
    "coupled by a tendon": (
        {"tail": '<tendon><fixed name="f" stiffness="9"><joint joint="elbow" coef="1"/></fixed></tendon>'},
        r"tendons hold torque .*: f",
    ),
    "wind": ({"head": '<option wind="3 0 0" density="1.2"/>'}, r"not read: drag of the medium"),
    "degrees that are radians": (
        {"head": '<compiler angle="degree"/>', "tail": "<!-- degrees -->"},
        r"no joint turns by more than 3 degrees: were radians read as degrees",
    ),
    "a loop": (
        {"tail": '<equality><weld name="w" body1="hand" body2="trunk"/></equality>'},
        r"moves freely: w",
    ),
    "compensated": (
        {"head": "<!-- gravcomp -->"},
        r"weights that MuJoCo compensates count nevertheless: arm",
    ),
    "a muscle": ({"tail": MUSCLE}, r"passive forces of muscles are not counted: biceps"),
}


@pytest.mark.parametrize("case", NOTED_OF_MJCF)
def test_what_an_mjcf_file_has_and_a_tree_has_not_is_told(case: str, tmp_path: Path) -> None:
    pieces, sentence = NOTED_OF_MJCF[case]
    text = mjcf(**pieces)
    if case == "compensated":
        text = text.replace('name="arm"', 'name="arm" gravcomp="1"')
    if case == "degrees that are radians":
        text = text.replace('<compiler angle="radian"/>', "").replace("<joint ", '<joint limited="true" ')
        text = text.replace('ref="0"', 'range="-1.5 1.5"').replace(
            'axis="0 0 1"', 'axis="0 0 1" range="-1 1"'
        )
        text = text.replace('<site name="neck"', MORE_JOINTS + '<site name="neck"')
    notes = [note for note in read_mjcf(text, tmp_path).notes if not note.startswith("no actuator acts")]
    (note,) = notes
    assert re.search(sentence, note)


MORE_JOINTS = '<body name="head"><joint name="nod" limited="true" range="-0.5 0.5"/><geom size="0.1"/></body>'


def test_springs_that_the_file_switches_off_are_not_told(tmp_path: Path) -> None:
    head, joint = '<option><flag spring="disable"/></option>', 'stiffness="200"'
    assert read_mjcf(mjcf(head=head, joint=joint), tmp_path).notes == ()


@pytest.mark.parametrize(
    ("pieces", "sentence"),
    [
        ({"mass": "nan"}, "wanted finite numbers, found 'nan'"),
        ({"mass": "inf"}, "wanted finite masses and inertias, found others"),
        ({"mass": "1_4.5"}, "an MJCF file that MuJoCo compiles, found .*bad format in attribute 'mass'"),
        ({"mass": "${mass}"}, "an MJCF file that MuJoCo compiles, found .*bad format in attribute 'mass'"),
    ],
)
def test_numbers_of_an_mjcf_file_that_are_none_are_refused(
    pieces: dict[str, str], sentence: str, tmp_path: Path
) -> None:
    with pytest.raises(ModelError, match=sentence):
        read_mjcf(mjcf(**pieces), tmp_path)


PLACEHOLDERS = {
    "is empty": b"",
    "is a Git LFS pointer": b"version https://git-lfs.github.com/spec/v1\noid sha256:aa\nsize 1234\n",
    "is a git-annex pointer": b"/annex/objects/SHA256E-s1234--aa.stl\n",
    "is a web page": b"\n<!DOCTYPE html>\n<html><body>404</body></html>",
}


@pytest.mark.parametrize("kind", ["stl", "obj", "dae"])
@pytest.mark.parametrize("what", PLACEHOLDERS)
def test_a_mesh_that_is_not_here_is_named_with_what_stands_in_its_place(
    what: str, kind: str, tmp_path: Path
) -> None:
    (tmp_path / f"arm.{kind}").write_bytes(PLACEHOLDERS[what])
    text = changed(('<box size="0.1 0.2 0.3"/>', f'<mesh filename="arm.{kind}"/>'))
    (tmp_path / "small.urdf").write_text(text)
    with pytest.raises(
        InputError, match=rf"link arm: wanted a mesh of triangles, found '.*arm.{kind}', which {what}"
    ):
        with_its_meshes(tmp_path / "small.urdf")


@pytest.mark.parametrize("what", PLACEHOLDERS)
def test_a_mesh_of_an_mjcf_file_that_is_not_here_is_named_too(what: str, tmp_path: Path) -> None:
    (tmp_path / "meshes").mkdir()
    (tmp_path / "meshes/arm.stl").write_bytes(PLACEHOLDERS[what])
    asset = '<compiler meshdir="meshes"/><asset><mesh name="arm" file="arm.stl"/></asset>'
    text = mjcf(head=asset).replace("<site name", '<geom type="mesh" mesh="arm"/><site name', 1)
    with pytest.raises(ModelError, match=rf"asset: wanted meshes, found '.*arm.stl', which {what}"):
        read_mjcf(text, tmp_path)


def test_a_robot_s_file_that_is_not_here_is_named_too(tmp_path: Path) -> None:
    (tmp_path / "small.urdf").write_bytes(PLACEHOLDERS["is a Git LFS pointer"])
    with pytest.raises(
        InputError, match=r"robot.urdf: wanted a file with its content, found .* a Git LFS pointer"
    ):
        read_robot(tmp_path / "small.urdf", "small.urdf", "p.toml", "robot.urdf")


def with_its_meshes(path: Path) -> Tree:
    robot = read_robot(path, path.name, "p.toml", "robot.urdf")
    texts = mesh_texts(RobotTable(urdf=path.name), path, robot, path.parent, "p.toml")
    return with_surfaces(read_urdf(robot.urdf, path.name, InertiaRule.FILE), texts, "p.toml")


@pytest.mark.parametrize(
    ("scale", "sentence"),
    [
        ("", r"links with meshes of more than 10 m, which look like millimetres: arm \(200 m\)"),
        ('scale="0.001 0.001 0.001"', None),
        (
            'scale="1e-6 1e-6 1e-6"',
            r"links of less than 2 mm, which look as if scaled twice: arm \(0.2 mm, 2 kg\)",
        ),
    ],
)
def test_a_mesh_in_millimetres_or_scaled_twice_is_told(
    scale: str, sentence: str | None, tmp_path: Path
) -> None:
    trimesh.creation.box((200.0, 100.0, 50.0)).export(tmp_path / "arm.stl")
    text = changed(('<box size="0.1 0.2 0.3"/>', f'<mesh filename="arm.stl" {scale}/>'))
    (tmp_path / "small.urdf").write_text(text)
    notes = with_its_meshes(tmp_path / "small.urdf").notes
    assert len(notes) == (sentence is not None)
    assert sentence is None or re.search(sentence, notes[0])
