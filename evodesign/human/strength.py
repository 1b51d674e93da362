"""How strong a person is about each joint, and how much of that a posture asks for.

    moment = figure                                 of one position, whatever the person's size
           = figure * m          or  figure * m g H where the source gives it so
    effort = max over joints of |torque| / strength of that joint in the torque's direction

A joint's torque is the moment of the muscles on what lies beyond it, about the joint's axis: it has the sign
of the movement that it would make. On the right side the signs about x and z change, as the limits do.

Source: the `sources` of `data/strength.toml`, where each key is explained; docs/people.md says what is rated
by which rule.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import StrEnum
from functools import cache

from evodesign.human.anthropometry import Person
from evodesign.human.anthropometry_tables import Sex, figures
from evodesign.human.body import right_name
from evodesign.records import Record

NEWTONS_PER_KILOGRAM = 9.81
"""Body weight over body mass, where a source divides a moment by body weight."""


class Scale(StrEnum):
    """What a figure of `data/strength.toml` is multiplied by to give a moment [N m]."""

    N_M = "n_m"
    PER_MASS = "per_mass"
    PER_WEIGHT_AND_STATURE = "per_weight_and_stature"


class Source(Record, frozen=True):
    """Where figures come from, what they are multiplied by, and how far they could be checked.

    Those that are from memory, of no document that was read, are nobody's strength.
    """

    citation: str
    scale: Scale
    checked: str
    from_memory: bool = False


class Direction(Record, frozen=True):
    """The muscles' moment of one sign about a joint: what it does, and its figure for each sex."""

    movement: str
    source: str
    male: float
    female: float

    def of(self, sex: Sex) -> float:
        """The figure of a sex."""
        return {Sex.MALE: self.male, Sex.FEMALE: self.female}[sex]


class StrengthRow(Record, frozen=True):
    """Strengths of joints that share them; a direction for which nothing is published is left out."""

    joints: tuple[str, ...]
    negative: Direction | None = None
    positive: Direction | None = None


class StrengthTables(Record, frozen=True):
    """The whole data file."""

    sources: dict[str, Source]
    rows: tuple[StrengthRow, ...]


@cache
def strength_tables() -> StrengthTables:
    """The figures of `data/strength.toml`."""
    return figures("strength.toml", StrengthTables)


@dataclass(frozen=True, slots=True)
class Strength:
    """The largest moment [N m] of one movement."""

    movement: str
    moment: float


@dataclass(frozen=True, slots=True)
class JointStrength:
    """What a joint can exert in each direction; None where nothing is published."""

    negative: Strength | None
    positive: Strength | None


@dataclass(frozen=True, slots=True)
class RelativeTorque:
    """How hard one joint works.

    Args:
        joint: its name.
        movement: what its torque would do.
        torque: [N m].
        share: of the strength in that direction.
    """

    joint: str
    movement: str
    torque: float
    share: float


def joint_strengths(person: Person, *, from_memory: bool = False) -> Mapping[str, JointStrength]:
    """Strengths by joint name, for every joint of the generated person with a published figure.

    Args:
        person: whose they are.
        from_memory: whether figures count that come from no document that was read.
    """
    found: dict[str, JointStrength] = {}
    for row in strength_tables().rows:
        negative, positive = (_strength(way, person, from_memory) for way in (row.negative, row.positive))
        if negative is None and positive is None:
            continue
        for joint in row.joints:
            found[joint] = JointStrength(negative, positive)
            turns_alike = joint.endswith("y")
            right = JointStrength(negative, positive) if turns_alike else JointStrength(positive, negative)
            found.setdefault(right_name(joint), right)
    return found


def _strength(way: Direction | None, person: Person, from_memory: bool) -> Strength | None:
    if way is None or (strength_tables().sources[way.source].from_memory and not from_memory):
        return None
    factor = {
        Scale.N_M: 1.0,
        Scale.PER_MASS: person.mass,
        Scale.PER_WEIGHT_AND_STATURE: person.mass * NEWTONS_PER_KILOGRAM * person.stature,
    }[strength_tables().sources[way.source].scale]
    return Strength(way.movement, factor * way.of(person.sex))


def with_given(
    published: Mapping[str, JointStrength], given: Mapping[str, tuple[float, float]]
) -> Mapping[str, JointStrength]:
    """Published strengths, with those that are given in their place.

    Args:
        published: by joint name.
        given: moments [N m] in the negative and the positive direction, by joint name.
    """
    replaced = dict(published)
    for joint, (backward, forward) in given.items():
        known = published.get(joint, JointStrength(None, None))
        replaced[joint] = JointStrength(
            Strength(known.negative.movement if known.negative else "turning backward", backward),
            Strength(known.positive.movement if known.positive else "turning forward", forward),
        )
    return replaced


def relative_torques(
    torques: Mapping[str, float], strengths: Mapping[str, JointStrength]
) -> Iterator[RelativeTorque]:
    """How hard each joint works whose torque has a strength in its direction.

    Args:
        torques: [N m] by joint name.
        strengths: of the person.
    """
    for joint, torque in torques.items():
        both = strengths.get(joint)
        strength = None if both is None else both.negative if torque < 0.0 else both.positive
        if strength is not None:
            yield RelativeTorque(joint, strength.movement, torque, abs(torque) / strength.moment)


def largest_relative_torque(
    torques: Mapping[str, float], strengths: Mapping[str, JointStrength]
) -> RelativeTorque | None:
    """The joint that works hardest; None when no torque has a strength."""
    return max(relative_torques(torques, strengths), key=lambda joint: joint.share, default=None)
