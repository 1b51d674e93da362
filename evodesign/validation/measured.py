"""People who were measured: lifts as cases of one range of height each, from data files and from a user's.

Sources and licences: the first lines of each file in `data/`.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from importlib import resources

from evodesign.human.anthropometry import Person
from evodesign.human.anthropometry_tables import Sex, ShoulderWidth
from evodesign.mechanics.balance import GRAVITY

BIN = 0.15
"""Range of wrist heights that one case covers [m]."""

LEAN = 2.5
"""Of trunk and shank in quiet standing [degrees], from which the box lifts' changes were measured."""

HOLDS = 0.5
"""Share of the largest hand force from which hands hold the load."""

HANGING, HOLDING, EMPTY = "hanging", "box", "empty"
"""What hands do: of a person who stands still, who holds the load, who reaches down for it."""

BOX, STOOP = "box lift", "stoop lift"
CHANGES = frozenset({"trunk_low", "trunk_up", "shank"})
STOOPER = Person(1.73, 81.68, Sex.MALE, ShoulderWidth.JOINT_CENTRES)


@dataclass(frozen=True, slots=True)
class Plate:
    """Force of the ground on both feet.

    Args:
        forward: its component along x [N].
        up: along z [N].
        x: of the centre of pressure [m].
    """

    forward: float
    up: float
    x: float


@dataclass(frozen=True, slots=True)
class Frame:
    """An instant, or a mean of several.

    Args:
        hand_force: weight that both hands hold [N].
        hand_measured: whether it was measured by itself, not as the rest of the plate's force.
        wrist: height of the wrists [m].
        moments: that are given [N m], by name as in `posed.MOMENTS`.
        plate: force under the feet, if it was measured.
        places: of joints [m], by name as in `posed.LINK_OF`; empty where angles are given.
        features: angles [rad] as in `human.measured_posture`; empty where places are given.
    """

    hand_force: float
    hand_measured: bool
    wrist: float
    moments: Mapping[str, float]
    plate: Plate | None
    places: Mapping[str, tuple[float, float]]
    features: Mapping[str, float]


@dataclass(frozen=True, slots=True)
class MeasuredCase:
    """A person whose wrists were in one range of height.

    Args:
        lift: what was measured.
        who: of the people, or of the recordings.
        person: stature, mass and sex.
        hands: what they hold.
        bin: number of the range, from bin times `BIN`.
        frames: measured there.
    """

    lift: str
    who: str
    person: Person
    hands: str
    bin: int
    frames: tuple[Frame, ...]

    @property
    def has_legs(self) -> bool:
        """Whether the posture of the legs was measured."""
        return not self.frames[0].places or {"ankle", "knee"} <= self.frames[0].places.keys()

    @property
    def range(self) -> str:
        """Of the wrists [m]."""
        if self.hands == HANGING:
            return "standing"
        return f"{self.bin * BIN:.2f}-{(self.bin + 1) * BIN:.2f}"


def data_rows(name: str) -> Iterator[dict[str, str]]:
    """Rows of a data file of the package, without its remarks."""
    text = resources.files("evodesign.validation").joinpath("data", name).read_text("utf-8")
    yield from csv.DictReader(line for line in text.splitlines() if not line.startswith("#"))


def shipped_cases() -> tuple[MeasuredCase, ...]:
    """All lifts that come with the package."""
    from evodesign.validation.recording import read_frames

    text = resources.files("evodesign.validation").joinpath("data", "stoop_lifts.csv").read_text("utf-8")
    stoops = read_frames(text, "stoop_lifts.csv", STOOPER)
    return (*box_lifts(), *cases_of(STOOP, STOOPER, stoops))


def box_lifts() -> tuple[MeasuredCase, ...]:
    """Five men who lift a box, one case per row."""
    return tuple(_box_case(row) for row in data_rows("box_lifts.csv"))


def _box_case(row: Mapping[str, str]) -> MeasuredCase:
    stature, wrist = float(row["stature_m"]), float(row["wrist_z_m"])
    person = Person(stature, float(row["mass_kg"]), Sex.MALE, ShoulderWidth.JOINT_CENTRES)
    names = ("trunk_low", "trunk_up", "knee", "shank", "arm", "elbow")
    features = {
        name: math.radians(float(row[f"{name}_deg"]) + (LEAN if name in CHANGES else 0.0)) for name in names
    }
    features["ahead"] = float(row["wrist_x_m"]) / stature
    moments = {name: float(row[f"{name}_n_m"]) for name in ("l5s1", "hips", "knees", "ankles")}
    frame = Frame(float(row["load_kg"]) * GRAVITY, True, wrist, moments, None, {}, features)
    return MeasuredCase(BOX, f"man {row['man']}", person, row["hands"], int(wrist / BIN), (frame,))


def cases_of(lift: str, person: Person, recordings: Mapping[str, Iterable[Frame]]) -> Iterator[MeasuredCase]:
    """Frames of a person's recordings, by range of height, with the load in the hands and without.

    Args:
        lift: what was measured.
        person: who it was.
        recordings: by name.
    """
    largest = max((frame.hand_force for frames in recordings.values() for frame in frames), default=0.0)
    for who, frames in recordings.items():
        found: dict[tuple[str, int], list[Frame]] = {}
        for frame in frames:
            hands = HOLDING if frame.hand_force > HOLDS * largest else EMPTY
            found.setdefault((hands, int(frame.wrist / BIN)), []).append(frame)
        for (hands, number), own in sorted(found.items()):
            yield MeasuredCase(lift, who, person, hands, number, tuple(own))
