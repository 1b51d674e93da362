"""How people stand who hold or lift a load with both hands: features by the height of the hands.

    y ~ N(mean(eta), P(eta)^-1)        mean and P linear in eta between knots, constant beyond

with eta the height of the palms over stature and y the features. P is the inverse of the covariance, with the
arm's features correlated where people hold the same height in several ways.

One of the people of this distribution is drawn by one standard normal number z for each feature, the same at
every height, so that who is more bent than others is so at all heights:

    mean_z(eta) = mean(eta) + L(eta) z        L L^T = P^-1 at the knots, L linear in eta between them

Source: `data/measured_posture.csv`, where each row says where it is from and what supports it.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from functools import cache
from importlib import resources
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

FEATURES = ("trunk_low", "trunk_up", "knee", "shank", "arm", "elbow", "ahead", "sideways")
"""Angles [rad]: lean of lower and upper trunk, knee, lean of the shank, upper arm from hanging, elbow.

Then palms ahead of the ankles over stature, and the sine of the upper arm's angle outwards. All are positive
forward and in flexion.
"""

PURE_NUMBERS = frozenset({"ahead", "sideways"})

MEAN_PERSON = (0.0,) * len(FEATURES)
"""Who is drawn to the mean."""

MARK = 0.111
"""Height above the hip joints, over stature, of the mark on the back where lower and upper trunk meet.

There the measured lengths of both meet in upright standing (source boxlift).
"""

WEIGHT = 30.0
"""Cost of one squared standard deviation, in units of 100 N^2 m^2 (docs/person.md)."""

SIDES: Mapping[str, str] = {"left": "Left", "right": "Right"}
SPINE: Mapping[str, str] = {"jL5S1_roty": "L5", "jL4L3_roty": "L3", "jL1T12_roty": "T12", "jT9T8_roty": "T8"}
"""The trunk's joints of flexion, with the links above them."""

NEEDED_JOINTS = (
    *SPINE,
    *(f"j{s}{name}" for s in SIDES.values() for name in ("Hip_roty", "Knee_roty", "Ankle_roty")),
    *(f"j{s}{name}" for s in SIDES.values() for name in ("Shoulder_rotx", "Shoulder_rotz", "Elbow_rotz")),
)
NEEDED_LINKS = (
    *SPINE.values(),
    "Head",
    *(
        f"{s}{name}"
        for s in SIDES.values()
        for name in ("UpperLeg", "LowerLeg", "Foot", "UpperArm", "ForeArm")
    ),
)
"""What a person from a URDF must have: names, axes and T-pose of the generated one."""

ASSUMPTION = "assumption"
"""Support of a row behind which there is nobody."""


class HumanPosture(StrEnum):
    """What decides how a person stands: least torque, or how measured people stand as well."""

    LEAST_TORQUE = "least_torque"
    MEASURED = "measured"


USUAL_POSTURE = HumanPosture.MEASURED
"""Of a generated person whose table says nothing; that of a URDF is by least torque."""


class PostureRow(NamedTuple):
    """A row of the data file; angles [degrees]."""

    quantity: str
    task: str
    eta: float
    mean: float
    deviation: float
    people: int
    support: str
    source: str


@dataclass(frozen=True, slots=True)
class Gaussians:
    """Means and inverse covariances of the features at heights of the palms.

    Args:
        knots: heights eta over stature, ascending.
        means: at each knot, in the order of `FEATURES`.
        precisions: inverse covariances at each knot, likewise, as rows.
    """

    knots: tuple[float, ...]
    means: tuple[tuple[float, ...], ...]
    precisions: tuple[tuple[tuple[float, ...], ...], ...]

    @property
    def roots(self) -> Array:
        """L at each knot, lower triangular with L L^T the covariance, shape (knots, features, features)."""
        return np.linalg.cholesky(np.linalg.inv(np.array(self.precisions)))

    def mean(self, eta: float, drawn: Sequence[float] = MEAN_PERSON) -> dict[str, float]:
        """Of each feature at a height, of the person of some standard normal numbers."""
        columns = zip(FEATURES, (np.array(self.means) + self.roots @ np.array(drawn)).T, strict=True)
        return {name: float(np.interp(eta, self.knots, column)) for name, column in columns}


@dataclass(frozen=True, slots=True)
class MeasuredPosture:
    """What a person's posture is drawn to.

    Args:
        stature: of the person [m].
        hold, lift: of the features, of a person who stands still or lifts.
        joints: standard deviation about zero [rad] of joints that no feature has, by name without the side.
        weight: cost of one squared standard deviation, in units of 100 N^2 m^2.
        drawn: by which standard normal numbers the person differs from the mean, by feature.
    """

    stature: float
    hold: Gaussians
    lift: Gaussians
    joints: Mapping[str, float]
    weight: float = WEIGHT
    drawn: tuple[float, ...] = MEAN_PERSON


def drawn_person(sample: int) -> tuple[float, ...]:
    """The standard normal numbers z of a sample, by feature; 0 is the mean person."""
    if sample == 0:
        return MEAN_PERSON
    return tuple(np.random.default_rng(sample).standard_normal(len(FEATURES)).tolist())


def unmeasured_heights() -> tuple[float, float]:
    """Heights of the palms over stature between which nobody was measured who held a load."""
    low = max(row.eta for row in posture_rows() if row.task == "both" and not math.isnan(row.eta))
    return low, min(row.eta for row in posture_rows() if row.task == "hold")


@cache
def posture_rows() -> tuple[PostureRow, ...]:
    """The rows of the data file."""
    text = resources.files("evodesign.human").joinpath("data", "measured_posture.csv").read_text("utf-8")
    lines = (line for line in text.splitlines() if not line.startswith("#"))
    return tuple(
        PostureRow(
            row["quantity"],
            row["task"],
            float(row["eta"] or math.nan),
            float(row["mean"]),
            float(row["deviation"] or math.nan),
            int(row["people"]),
            row["support"],
            row["source"],
        )
        for row in csv.DictReader(lines)
    )


def measured_posture(stature: float, rows: Sequence[PostureRow] | None = None) -> MeasuredPosture:
    """Of a person of a stature [m], from the data file or from other rows."""
    given = posture_rows() if rows is None else rows
    joints = {row.quantity: math.radians(row.deviation) for row in given if math.isnan(row.eta)}
    return MeasuredPosture(stature, gaussians(given, "hold"), gaussians(given, "lift"), joints)


def gaussians(rows: Iterable[PostureRow], task: str) -> Gaussians:
    """The rows of a task, as means and inverse covariances by height."""
    own = [row for row in rows if row.task in (task, "both") and not math.isnan(row.eta)]
    knots = tuple(sorted({row.eta for row in own}))
    pairs = [_at_knot([row for row in own if row.eta == knot]) for knot in knots]
    means, precisions = zip(*pairs, strict=True)
    return Gaussians(
        knots,
        tuple(tuple(mean.tolist()) for mean in means),
        tuple(tuple(map(tuple, precision.tolist())) for precision in precisions),
    )


def _at_knot(rows: Iterable[PostureRow]) -> tuple[Array, Array]:
    """Mean and inverse covariance of the features, from rows of one height; covariance_ij = r_ij s_i s_j."""
    by_name = {row.quantity: row for row in rows}
    units = np.array([1.0 if name in PURE_NUMBERS else math.radians(1.0) for name in FEATURES])
    mean = units * [by_name[name].mean for name in FEATURES]
    deviation = units * [by_name[name].deviation for name in FEATURES]
    correlation = np.eye(len(FEATURES))
    for pair in by_name.keys() - set(FEATURES):
        i, j = (FEATURES.index(name) for name in pair.split())
        correlation[i, j] = correlation[j, i] = by_name[pair].mean
    return mean, np.asarray(np.linalg.inv(correlation * np.outer(deviation, deviation)), float)
