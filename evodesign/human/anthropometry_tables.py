"""The published figures behind a generated person, as `data/anthropometry.toml` holds them.

What each key means, its unit and its source are said in that file; here is its form, read strictly.
"""

from __future__ import annotations

import tomllib
from enum import StrEnum
from functools import cache
from importlib import resources
from typing import TypeVar

import msgspec

from evodesign.records import Record

R = TypeVar("R", bound=Record)


class Sex(StrEnum):
    """Which column of the tables is read."""

    MALE = "male"
    FEMALE = "female"


class ShoulderWidth(StrEnum):
    """What lies between a person's shoulder joints."""

    DRILLIS_CONTINI = "drillis_contini"
    """The shoulder width of Drillis and Contini, 0.259 of stature: that of the shoulders' outer points."""
    JOINT_CENTRES = "joint_centres"
    """The distance of the centres of rotation where arms are raised forward, 0.202 of stature."""


class Accepted(Record, frozen=True):
    """Persons for whom the tables are believed."""

    source: str
    stature_m: tuple[float, float]
    mass_kg: tuple[float, float]


class Lengths(Record, frozen=True):
    """Lengths, fractions of stature."""

    source: str
    ankle_height: float
    shank: float
    thigh: float
    trunk: float
    neck: float
    head: float
    shoulder_width: float
    upper_arm: float
    forearm: float
    hand: float
    hip_breadth: float
    foot_length: float
    foot_breadth: float


class Shoulders(Record, frozen=True):
    """How far the joint centres are apart, over the shoulder width."""

    source: str
    joint_centres: float


class Foot(Record, frozen=True):
    """Where ankle, ball and centre of mass lie in the foot."""

    source: str
    ball_from_heel: float
    ankle_from_heel: float
    centre_height: float
    toe_thickness: float


class Trunk(Record, frozen=True):
    """Where the trunk's joints lie and how it is shared out."""

    source: str
    hip_joint_separation: float
    clavicle_start: float
    thoracic_to_lumbar: float
    shoulder_mass_share: float


class Lumbosacral(Record, frozen=True):
    """Height of men's L5/S1 above the hip joints, over stature; women's follows from the trunk's levels."""

    source: str
    male: float


class Looks(Record, frozen=True):
    """Figures of shapes."""

    source: str
    hand_breadth: float
    chest_breadth: float
    density_kg_per_m3: float


class BodySegment(Record, frozen=True):
    """One row of de Leva's Table 4."""

    mass: float
    centre: float
    radii: tuple[float, float, float]


class Column(Record, frozen=True):
    """De Leva's figures for one sex, with the sample's mean stature and lengths of the trunk and head."""

    stature_m: float
    head_m: float
    upper_trunk_m: float
    middle_trunk_m: float
    lower_trunk_m: float
    hand_centre_to_metacarpal: float
    segments: dict[str, BodySegment]


class DeLeva(Record, frozen=True):
    """De Leva's Table 4."""

    source: str
    end_points: dict[str, str]
    male: Column
    female: Column

    def of(self, sex: Sex) -> Column:
        """The column of a sex."""
        return {Sex.MALE: self.male, Sex.FEMALE: self.female}[sex]


class AxisRange(Record, frozen=True):
    """One axis of a joint, its limits [degrees] and what the signs mean on the left side."""

    axis: str
    range_deg: tuple[float, float]
    negative: str
    positive: str


class Articulation(Record, frozen=True):
    """A joint of one to three axes from parent to child."""

    name: str
    parent: str
    child: str
    axes: tuple[AxisRange, ...]


class Articulations(Record, frozen=True):
    """All joints of the middle and the left side."""

    source: str
    joints: tuple[Articulation, ...]


class Tables(Record, frozen=True):
    """The whole data file."""

    accepted: Accepted
    lengths: Lengths
    shoulders: Shoulders
    foot: Foot
    trunk: Trunk
    lumbosacral: Lumbosacral
    looks: Looks
    de_leva: DeLeva
    articulation: Articulations


def figures(file: str, form: type[R]) -> R:
    """The figures of a file of `data/`, read strictly."""
    text = resources.files("evodesign.human").joinpath("data", file).read_text("utf-8")
    return msgspec.convert(tomllib.loads(text), form)


@cache
def tables() -> Tables:
    """The figures of `data/anthropometry.toml`."""
    return figures("anthropometry.toml", Tables)
