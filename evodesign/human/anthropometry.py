"""A person measured by published tables: landmarks, and mass, centre and inertia of each segment.

Frame: the pelvis (origin midway between the hip joints; x forward, y to the left, z up) of a person in the
T-pose, arms along y with palms down. Only the middle and the left side are given; the right is its mirror.

    length = fraction * stature                   centre = first + c (second - first)
    mass = fraction / sum of fractions * m        I = mass (r length)^2, about each axis

Sources: the `source` keys of `data/anthropometry.toml` (Drillis and Contini 1966; de Leva 1996, Table 4).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from evodesign.body.inertia import Inertia
from evodesign.body.placement import Vector, add, scale
from evodesign.errors import InputError
from evodesign.human.anthropometry_tables import Sex, ShoulderWidth, tables


@dataclass(frozen=True, slots=True)
class Person:
    """A person to be generated.

    Args:
        stature: height when standing [m].
        mass: body mass [kg].
        sex: column of the tables.
        shoulder_width: what lies between the shoulder joints.
    Raises:
        InputError: a stature or mass outside the accepted range.
    """

    stature: float
    mass: float
    sex: Sex
    shoulder_width: ShoulderWidth = ShoulderWidth.DRILLIS_CONTINI

    def __post_init__(self) -> None:
        accepted = tables().accepted
        for key, value, (lower, upper) in (
            ("stature_m", self.stature, accepted.stature_m),
            ("mass_kg", self.mass, accepted.mass_kg),
        ):
            if not lower <= value <= upper:
                raise InputError("human", key, f"a number from {lower:g} to {upper:g}", f"{value:g}")


def sole_size(person: Person) -> tuple[float, float]:
    """Length and width of a foot [m] (Drillis and Contini 1966)."""
    lengths = tables().lengths
    return (lengths.foot_length * person.stature, lengths.foot_breadth * person.stature)


def landmarks(person: Person) -> Mapping[str, Vector]:
    """Points in the pelvis frame [m]: the origin of each link that moves, and the ends of segments.

    Spine: with u the height of a lumbar and t = 0.75 u that of a lower thoracic segment, xiphion to
    omphalion is T9..T12 and L1..L3, 4 t + 3 u; L4 and L5 lie below the omphalion (joint jL4L3), the xiphion
    is joint jT9T8. A man's joint jL5S1 is where it was measured: two lumbars below the omphalion is too low.
    The frame of a link stands where its joint to the parent is.
    """
    length, foot, trunk = tables().lengths, tables().foot, tables().trunk
    column = tables().de_leva.of(person.sex)
    omphalion = column.lower_trunk_m / column.stature_m
    xiphion = omphalion + column.middle_trunk_m / column.stature_m
    lumbar = (xiphion - omphalion) / (3.0 + 4.0 * trunk.thoracic_to_lumbar)
    lumbosacral = omphalion - 2.0 * lumbar if person.sex is Sex.FEMALE else tables().lumbosacral.male
    vertex = length.trunk + length.neck + length.head
    hip = trunk.hip_joint_separation / 2.0
    shoulder = length.shoulder_width / 2.0
    if person.shoulder_width is ShoulderWidth.JOINT_CENTRES:
        shoulder *= tables().shoulders.joint_centres
    elbow = shoulder + length.upper_arm
    wrist = elbow + length.forearm
    hand = column.segments["hand"].centre / column.hand_centre_to_metacarpal * length.hand
    ankle = -(length.thigh + length.shank)
    floor = ankle - length.ankle_height
    heel = -foot.ankle_from_heel * length.foot_length
    ball = heel + foot.ball_from_heel * length.foot_length
    foot_center = floor + foot.centre_height * length.ankle_height
    fractions: dict[str, Vector] = {
        "Pelvis": (0.0, 0.0, 0.0),
        "L5": (0.0, 0.0, lumbosacral),
        "L3": (0.0, 0.0, omphalion),
        "T12": (0.0, 0.0, omphalion + 3.0 * lumbar),
        "T8": (0.0, 0.0, xiphion),
        "Suprasternale": (0.0, 0.0, xiphion + column.upper_trunk_m / column.stature_m),
        "Neck": (0.0, 0.0, length.trunk),
        "Head": (0.0, 0.0, length.trunk + length.neck),
        "Gonion": (0.0, 0.0, vertex - column.head_m / column.stature_m),
        "Vertex": (0.0, 0.0, vertex),
        "LeftShoulder": (0.0, trunk.clavicle_start * shoulder, length.trunk),
        "LeftUpperArm": (0.0, shoulder, length.trunk),
        "LeftForeArm": (0.0, elbow, length.trunk),
        "LeftHand": (0.0, wrist, length.trunk),
        "LeftPalm": (0.0, wrist + hand, length.trunk),
        "LeftFingertip": (0.0, wrist + length.hand, length.trunk),
        "LeftUpperLeg": (0.0, hip, 0.0),
        "LeftLowerLeg": (0.0, hip, -length.thigh),
        "LeftFoot": (0.0, hip, ankle),
        "LeftToe": (ball, hip, floor + foot.toe_thickness / 2.0),
        "LeftHeel": (heel, hip, foot_center),
        "LeftToeTip": (heel + length.foot_length, hip, foot_center),
        "LeftSole": (heel + length.foot_length / 2.0, hip, floor),
    }
    return {name: scale(person.stature, point) for name, point in fractions.items()}


UPRIGHT = ("sagittal", "transverse", "longitudinal")
RAISED = ("sagittal", "longitudinal", "transverse")
PALM_DOWN = ("transverse", "longitudinal", "sagittal")
FORWARD = ("longitudinal", "transverse", "sagittal")
RADII = ("sagittal", "transverse", "longitudinal")

SEGMENTS: Mapping[str, tuple[str, str, tuple[str, str, str]]] = {
    "head": ("Vertex", "Gonion", UPRIGHT),
    "upper_trunk": ("Suprasternale", "T8", UPRIGHT),
    "middle_trunk": ("T8", "L3", UPRIGHT),
    "lower_trunk": ("L3", "Pelvis", UPRIGHT),
    "upper_arm": ("LeftUpperArm", "LeftForeArm", RAISED),
    "forearm": ("LeftForeArm", "LeftHand", PALM_DOWN),
    "hand": ("LeftHand", "LeftFingertip", PALM_DOWN),
    "thigh": ("LeftUpperLeg", "LeftLowerLeg", UPRIGHT),
    "shank": ("LeftLowerLeg", "LeftFoot", UPRIGHT),
    "foot": ("LeftHeel", "LeftToeTip", FORWARD),
}
"""End points of each of de Leva's segments, and which of its axes lie along x, y and z in the T-pose."""

PAIRED_SEGMENTS = ("upper_arm", "forearm", "hand", "thigh", "shank", "foot")
"""Segments of which a person has two."""


def segments(person: Person) -> Mapping[str, Inertia]:
    """Mass, centre and inertia of each segment (of a pair: the left one), in the pelvis frame.

    De Leva's axes are those of the anatomical position (standing, arms hanging, palms forward): sagittal =
    fore-aft, transverse = left-right, longitudinal = along the segment. They go with the segment:

        trunk, head, leg        stay: x sagittal, y transverse, z longitudinal
        upper arm               raised sideways about x: x sagittal, y longitudinal, z transverse
        forearm, hand           raised, then pronated until the palm, whose normal is the sagittal axis,
                                looks down: x transverse, y longitudinal, z sagittal
        foot                    its long axis points forward and its sagittal axis (the one across the
                                sole) up: x longitudinal, y transverse, z sagittal

    The foot's assignment is our reading: the table does not say how the foot was held. It makes the larger
    of two close radii the vertical one, as a foot that is broader than high must have it.
    """
    column = tables().de_leva.of(person.sex)
    whole = math.fsum(
        row.mass * (2 if name in PAIRED_SEGMENTS else 1) for name, row in column.segments.items()
    )
    points = landmarks(person)
    result = {}
    for name, (first, second, axes) in SEGMENTS.items():
        row = column.segments[name]
        mass = row.mass / whole * person.mass
        length = math.dist(points[first], points[second])
        x, y, z = (mass * (row.radii[RADII.index(axis)] * length) ** 2 for axis in axes)
        center = add(scale(1.0 - row.centre, points[first]), scale(row.centre, points[second]))
        result[name] = Inertia(mass, center, ((x, 0.0, 0.0), (0.0, y, 0.0), (0.0, 0.0, z)))
    return result
