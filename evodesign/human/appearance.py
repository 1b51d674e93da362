"""What a generated person looks like: one shape for each link of the middle and the left side.

Shapes are seen, and kept apart where a problem asks for it. Their lengths follow from the landmarks; what the
tables do not give (a limb's radius, the trunk's depth, the hand's thickness) follows from the link's mass
over one density:

    trunk          boxes       as broad as the hips, the chest as between the arms, and of one depth,
                               m / (density * hip breadth * height), all figures the whole trunk's
    hand           box         thickness = m / (density * length * breadth)
    limb, neck     cylinder    radius = sqrt(m / (density * pi * length))
    head           sphere      as high as the head
    foot, toes     boxes       by the tables alone

Source: the keys `lengths`, `foot` and `looks` of `data/anthropometry.toml`.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping

from evodesign.body.inertia import Inertia
from evodesign.body.placement import Matrix, Placement, Vector, add, scale
from evodesign.body.shape import Box, Cylinder, Sphere
from evodesign.human.anthropometry import Person
from evodesign.human.anthropometry_tables import tables
from evodesign.tree.model import Look

ALONG_Y: Matrix = ((1.0, 0.0, 0.0), (0.0, 0.0, -1.0), (0.0, 1.0, 0.0))
"""Rotation that lays a cylinder's axis along y."""


def human_looks(
    person: Person, points: Mapping[str, Vector], bodies: Mapping[str, Inertia]
) -> Mapping[str, tuple[Look, ...]]:
    """The looks of each link that has one.

    Args:
        person: whose breadths and heights follow from the stature.
        points: `anthropometry.landmarks` of the person, in the pelvis frame [m].
        bodies: inertia of the middle and left links, of which the masses [kg] are used.
    Returns:
        One shape for each middle and left link, in the link's frame [m].
    """
    lengths, figures = tables().lengths, tables().looks
    h, density = person.stature, figures.density_kg_per_m3
    shapes: dict[str, Look] = {}

    trunk = ["Pelvis", "L5", "L3", "T12", "T8", "Neck"]
    breadth = lengths.hip_breadth * h
    trunk_mass = sum(bodies[link].mass for link in trunk[:-1])
    depth = trunk_mass / (density * breadth * lengths.trunk * h)
    for link, above in itertools.pairwise(trunk):
        height = points[above][2] - points[link][2]
        box = Box(depth, figures.chest_breadth * h if link == "T8" else breadth, height)
        shapes[link] = Look(box, Placement(translation=(0.0, 0.0, height / 2.0)))

    limbs = ["LeftShoulder", "LeftUpperArm", "LeftForeArm", "LeftUpperLeg", "LeftLowerLeg", "Neck"]
    ends = ["LeftUpperArm", "LeftForeArm", "LeftHand", "LeftLowerLeg", "LeftFoot", "Head"]
    for link, end in zip(limbs, ends, strict=True):
        reach = add(points[end], scale(-1.0, points[link]))
        length = math.hypot(*reach)
        radius = math.sqrt(bodies[link].mass / (density * math.pi * length))
        rotation = ALONG_Y if reach[1] else Placement().rotation
        shapes[link] = Look(Cylinder(radius, length), Placement(rotation, scale(0.5, reach)))

    radius = lengths.head * h / 2.0
    shapes["Head"] = Look(Sphere(radius), Placement(translation=(0.0, 0.0, radius)))
    hand, hand_breadth = lengths.hand * h, figures.hand_breadth * h
    thickness = bodies["LeftHand"].mass / (density * hand * hand_breadth)
    in_hand = Placement(translation=(0.0, hand / 2.0, 0.0))
    shapes["LeftHand"] = Look(Box(hand_breadth, hand, thickness), in_hand)

    foot_breadth, ankle, toe = (
        x * h for x in (lengths.foot_breadth, lengths.ankle_height, tables().foot.toe_thickness)
    )
    heel, ball, tip = (points[name][0] for name in ("LeftHeel", "LeftToe", "LeftToeTip"))
    in_foot = Placement(translation=((heel + ball) / 2.0, 0.0, -ankle / 2.0))
    shapes["LeftFoot"] = Look(Box(ball - heel, foot_breadth, ankle), in_foot)
    in_toe = Placement(translation=((tip - ball) / 2.0, 0.0, 0.0))
    shapes["LeftToe"] = Look(Box(tip - ball, foot_breadth, toe), in_toe)
    return {link: (look,) for link, look in shapes.items()}
