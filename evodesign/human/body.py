"""The generated person: a 48-joint body from stature, mass and sex.

Structure and names follow the Xsens-style 48-DoF body: root link Pelvis, T-pose at zero, x forward, y to the
left, z up. A joint of several axes is a chain of revolute joints with massless links `Child_f1`, `Child_f2`
between. All frames are parallel at zero, and both sides turn about the same axes +x, +y, +z; on the right
side the limits about x and z are the left ones mirrored, [-upper, -lower]. What each sign means is written
in `data/anthropometry.toml`.

A segment of de Leva's that several links share is split so that, at joint position zero, the links together
have exactly the segment's mass, centre and inertia (`split`).

`human_looks` gives the links their shapes. The right side is the left one mirrored about the plane y = 0: the
mirror image of a turn by q about y is a turn by q, about x and z one by -q. Sources: see `anthropometry`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from evodesign.body.inertia import Inertia, total
from evodesign.body.placement import Matrix, Placement, Vector, add, mirrored_point, scale
from evodesign.human.anthropometry import Person, landmarks, segments
from evodesign.human.anthropometry_tables import Articulation, tables
from evodesign.human.appearance import human_looks
from evodesign.tree.model import Joint, JointKind, Link, Look, Tree

HANDS: Mapping[str, str] = {"left": "LeftPalm", "right": "RightPalm"}
"""Frames that grasp: at the third metacarpal, axes as the hand's."""

SOLES: Mapping[str, str] = {"left": "LeftSole", "right": "RightSole"}
"""Frames on the floor under the middle of each foot's length, x towards the toes."""

TRUNK = ("Pelvis", "T8")
"""Lowest and highest link of the trunk."""

_STILL = ("T1C7", "C1Head", "C7Shoulder", "Wrist", "Knee_rotz", "BallFoot")

LEFT, RIGHT = "Left", "Right"
"""What names of the two sides hold."""

AXES: Mapping[str, Vector] = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}


def human_tree(person: Person) -> Tree:
    """The person as a tree of links and joints.

    Standing in the T-pose with the pelvis at 0.530 of the stature, the soles are at height zero and the
    vertex at the stature. Joints have ranges but neither effort nor velocity limits.
    """
    points = landmarks(person)
    bodies = _bodies(person)
    looks = human_looks(person, points, bodies)
    links = [Link("Pelvis", own_inertia=bodies["Pelvis"], looks=looks["Pelvis"])]
    joints: list[Joint] = []
    for articulation in tables().articulation.joints:
        chain_links, chain_joints = _chain(articulation, points, bodies, looks)
        links += chain_links
        joints += chain_joints
    for parent, frame in (("LeftHand", "LeftPalm"), ("LeftFoot", "LeftSole")):
        links.append(Link(frame))
        place = Placement(translation=_difference(points[frame], points[parent]))
        joints.append(Joint(f"j{frame}_fixed", JointKind.FIXED, parent, frame, place))
    links += [_mirrored_link(link) for link in links if link.name.startswith(LEFT)]
    joints += [_mirrored_joint(joint) for joint in joints if joint.child.startswith(LEFT)]
    return Tree("human", tuple(links), tuple(joints))


def split(whole: Inertia, shares: Sequence[tuple[float, Vector]]) -> tuple[Inertia, ...]:
    """Bodies that together have the mass, centre and inertia of the whole.

        m_i = s_i m,    m c = sum m_i c_i,    I_i = s_i (I - sum m_i (|d_i|^2 1 - d_i d_i^T)),  d_i = c_i - c

    The inertia left over after the parallel-axis terms is shared in proportion to mass (an assumption); so
    all parts are physically consistent if one is.

    Args:
        whole: the body to be split.
        shares: of all parts but the last, the share s_i of the mass and the centre c_i [m] in the whole's
            frame; the last part takes the rest of the mass, at the centre that follows.
    Returns:
        The parts, in the whole's frame.
    """
    rest = 1.0 - math.fsum(share for share, _ in shares)
    moment = whole.center
    for share, center in shares:
        moment = _difference(moment, scale(share, center))
    parts = [*shares, (rest, scale(1.0 / rest, moment))]
    points = total([Inertia(share * whole.mass, center) for share, center in parts])
    left_over = [
        _difference(row, taken) for row, taken in zip(whole.about_center, points.about_center, strict=True)
    ]
    return tuple(
        Inertia(share * whole.mass, center, _matrix([scale(share, row) for row in left_over]))
        for share, center in parts
    )


def _bodies(person: Person) -> Mapping[str, Inertia]:
    """Inertia of the middle and left links, each in its own frame."""
    points, whole = landmarks(person), segments(person)
    trunk = tables().trunk
    clavicle = _middle(points["LeftShoulder"], points["LeftUpperArm"])
    shoulders = [(trunk.shoulder_mass_share, clavicle), (trunk.shoulder_mass_share, mirrored_point(clavicle))]
    left_shoulder, _, chest = split(whole["upper_trunk"], shoulders)
    middles = {
        lower: _middle(points[lower], points[upper])
        for lower, upper in (("Pelvis", "L5"), ("L5", "L3"), ("L3", "T12"), ("T12", "T8"), ("Neck", "Head"))
    }
    middles["Head"] = _middle(points["Head"], points["Vertex"])
    pelvis, l5 = _two_slabs(whole["lower_trunk"], middles["Pelvis"], middles["L5"])
    l3, t12 = _two_slabs(whole["middle_trunk"], middles["L3"], middles["T12"])
    neck, head = _two_slabs(whole["head"], middles["Neck"], middles["Head"])
    toe, foot = _toe_and_foot(whole["foot"], points)
    in_pelvis = {
        "Pelvis": pelvis,
        "L5": l5,
        "L3": l3,
        "T12": t12,
        "T8": chest,
        "Neck": neck,
        "Head": head,
        "LeftShoulder": left_shoulder,
        "LeftUpperArm": whole["upper_arm"],
        "LeftForeArm": whole["forearm"],
        "LeftHand": whole["hand"],
        "LeftUpperLeg": whole["thigh"],
        "LeftLowerLeg": whole["shank"],
        "LeftFoot": foot,
        "LeftToe": toe,
    }
    return {
        link: body.moved(Placement(translation=scale(-1.0, points[link]))) for link, body in in_pelvis.items()
    }


def _two_slabs(whole: Inertia, lower: Vector, upper: Vector) -> tuple[Inertia, ...]:
    """Two parts whose centres lie at the given middles of their slabs, one above the other."""
    z = whole.center[2]
    return split(whole, [((upper[2] - z) / (upper[2] - lower[2]), lower)])


def _toe_and_foot(whole: Inertia, points: Mapping[str, Vector]) -> tuple[Inertia, ...]:
    """Toes, with their centre midway from ball to tip at the toe joint's height, and the rest of the foot.

    The share of the toes puts the rest's centre midway from heel to ball; its height follows.
    """
    heel, ball, tip = points["LeftHeel"], points["LeftToe"], points["LeftToeTip"]
    toe_x, foot_x = (ball[0] + tip[0]) / 2.0, (heel[0] + ball[0]) / 2.0
    share = (whole.center[0] - foot_x) / (toe_x - foot_x)
    return split(whole, [(share, (toe_x, ball[1], ball[2]))])


def _chain(
    articulation: Articulation,
    points: Mapping[str, Vector],
    bodies: Mapping[str, Inertia],
    looks: Mapping[str, tuple[Look, ...]],
) -> tuple[list[Link], list[Joint]]:
    """Links and joints of one articulation: massless links between its axes, the child at the end."""
    child, parent = articulation.child, articulation.parent
    between = [f"{child}_f{number}" for number in range(1, len(articulation.axes))]
    names = [parent, *between, child]
    offset = _difference(points[child], points[parent])
    joints = []
    for index, axis in enumerate(articulation.axes):
        lower, upper = (math.radians(limit) for limit in axis.range_deg)
        place = Placement(translation=offset) if index == 0 else Placement()
        joints.append(
            Joint(
                f"{articulation.name}_rot{axis.axis}",
                JointKind.REVOLUTE,
                names[index],
                names[index + 1],
                place,
                axis=AXES[axis.axis],
                lower=lower,
                upper=upper,
            )
        )
    links = [Link(name) for name in between]
    return [*links, Link(child, own_inertia=bodies[child], looks=looks[child])], joints


def _mirrored_link(link: Link) -> Link:
    """The right side's link: a person's, with an inertia of its own and looks but no solids."""
    looks = tuple(Look(look.shape, look.link_from_look.mirrored()) for look in link.looks)
    return Link(right_name(link.name), own_inertia=link.own_inertia.mirrored(), looks=looks)


def _mirrored_joint(joint: Joint) -> Joint:
    """The right side's joint: same axis, limits about x and z mirrored.

    A person's joint: fixed or revolute about one axis of its frame, without effort or velocity limits.
    """
    turns_alike = joint.axis[1] == 1.0 or joint.kind is JointKind.FIXED
    lower, upper = (joint.lower, joint.upper) if turns_alike else (-joint.upper, -joint.lower)
    return Joint(
        right_name(joint.name),
        joint.kind,
        right_name(joint.parent),
        right_name(joint.child),
        joint.parent_from_child.mirrored(),
        axis=joint.axis,
        lower=lower,
        upper=upper,
    )


def right_name(name: str) -> str:
    """The right side's name; that of the middle is its own."""
    return name.replace(LEFT, RIGHT)


def _default_joints() -> tuple[str, ...]:
    """Names of the joints that move by default, as in the paper's code: 33 of 48."""
    names = []
    for articulation in tables().articulation.joints:
        left = [f"{articulation.name}_rot{axis.axis}" for axis in articulation.axes]
        right = [right_name(name) for name in left]
        names += left if right == left else left + right
    return tuple(name for name in names if not any(part in name for part in _STILL))


DEFAULT_JOINTS: tuple[str, ...] = _default_joints()
"""All joints but those of neck, head, clavicles, wrists and toes, and the knees' rotation."""


def _middle(a: Vector, b: Vector) -> Vector:
    return scale(0.5, add(a, b))


def _difference(a: Vector, b: Vector) -> Vector:
    return add(a, scale(-1.0, b))


def _matrix(rows: Sequence[Vector]) -> Matrix:
    return (rows[0], rows[1], rows[2])
