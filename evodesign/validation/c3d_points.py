"""Which points of a c3d file are which joints: by common names, or as a file of the user's says.

    hip = anterior superior iliac spine - 0.22 w forward - 0.30 w up - 0.14 w outwards

with w the distance of both spines, where a file has markers of the pelvis alone; forward is from the
posterior spines to the anterior ones. Markers on the skin beside a joint's axis stand for the joint in the
sagittal plane.

Source: names of Plug-in Gait's bones, whose origins are their distal ends: Vicon, Plug-in Gait bones, and
HAS-Motion, Visual3D tutorial Plug-In Gait Full-Body (both pages were read); the hip: Bell, Brand and Pedersen
1989, Human Movement Science 8: 3-16 (the abstract was read: within 3.3 cm with 95 % certainty).
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator, Mapping, Sequence
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import msgspec
import numpy as np
from numpy.typing import NDArray

from evodesign.errors import InputError, nearest_name
from evodesign.problem.named_files import read_text
from evodesign.problem.source import decode_toml
from evodesign.validation.posed import LINK_OF
from evodesign.validation.recording import NEEDED

Array = NDArray[np.float64]
Tracks = Mapping[str, Mapping[str, Array]]
"""Places [m] of each joint in the file's axes, by side; shape (frames, 3), nan where a point is hidden."""

SIDES = ("left", "right")
MIDDLE = "middle"

NAMES: Mapping[str, tuple[tuple[str, ...], ...]] = {
    "ankle": (("ajc",), ("anklejc",), ("ankle",), ("tio",), ("ank", "med"), ("ank",)),
    "knee": (("kjc",), ("kneejc",), ("knee",), ("feo",), ("kne", "knm"), ("kne",)),
    "hip": (("hjc",), ("hipjc",), ("hip",), ("trochanter",), ("troc",), ("gtr",)),
    "shoulder": (("sjc",), ("shoulderjc",), ("shoulder",), ("clo",), ("sho",)),
    "elbow": (("ejc",), ("elbowjc",), ("elbow",), ("huo",), ("elb", "elbm"), ("elb",)),
    "wrist": (("wjc",), ("wristjc",), ("wrist",), ("rao",), ("wra", "wrb")),
    "l5s1": (("l5s1",), ("lumbosacral",)),
    "t12": (("t12l1",), ("l1t12",)),
}
"""Names without their side: joint centres, then markers. A joint is the mean of the first choice found."""

PELVIS = (("asi", "asis"), ("psi", "psis"))
"""Names of the anterior and the posterior superior iliac spines."""

BELL = (0.22, 0.30, 0.14)
"""Of the hip behind, below and inwards of the anterior spine, over the distance of both."""

VISIBLE = 0.5
"""Share of frames in which a joint must be seen; else the file does not have it."""

LISTED = 12
"""Points that a sentence lists."""

Names = Annotated[tuple[str, ...], msgspec.Meta(min_length=1, max_length=20)]


class LengthUnit(StrEnum):
    """Of places in a c3d file."""

    METRE = "m"
    CENTIMETRE = "cm"
    MILLIMETRE = "mm"

    @property
    def metres(self) -> float:
        """One of it [m]."""
        return {"m": 1.0, "cm": 0.01, "mm": 0.001}[self]


class Axis(StrEnum):
    """A direction of a file's coordinates."""

    X, Y, Z = "x", "y", "z"
    MINUS_X, MINUS_Y, MINUS_Z = "-x", "-y", "-z"

    @property
    def vector(self) -> Array:
        """Of length 1."""
        found = np.zeros(3)
        found["xyz".index(self[-1])] = -1.0 if self.startswith("-") else 1.0
        return found


class Joints(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Points whose mean is a joint, of one side or the middle."""

    ankle: Names | None = None
    knee: Names | None = None
    hip: Names | None = None
    l5s1: Names | None = None
    t12: Names | None = None
    shoulder: Names | None = None
    elbow: Names | None = None
    wrist: Names | None = None


class PointsFile(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What a user says of a c3d file; what is left out is found in it.

    Args:
        unit: of places.
        up, forward: the directions; forward is where the person faces.
        plates: numbers of the force plates under the feet, from 1; empty for none.
        hand_force_n: weight in the hands in all frames [N].
        left, right, middle: points of joints.
    """

    unit: LengthUnit | None = None
    up: Axis | None = None
    forward: Axis | None = None
    plates: tuple[Annotated[int, msgspec.Meta(ge=1)], ...] | None = None
    hand_force_n: Annotated[float, msgspec.Meta(ge=0.0, le=1e4)] | None = None
    left: Joints = Joints()
    right: Joints = Joints()
    middle: Joints = Joints()

    def named(self) -> dict[str, dict[str, tuple[str, ...]]]:
        """Points by joint and side, of the joints that the file names."""
        found: dict[str, dict[str, tuple[str, ...]]] = {}
        for side in (*SIDES, MIDDLE):
            for joint, names in msgspec.structs.asdict(getattr(self, side)).items():
                if names is not None:
                    found.setdefault(joint, {})[side] = names
        return found


def read_points(path: Path) -> PointsFile:
    """A file of names and axes.

    Raises:
        InputError: it cannot be read, or holds an unknown key or value.
    """
    return decode_toml(read_text(path, str(path), ""), str(path), PointsFile)


def joint_tracks(points: Mapping[str, Array], given: PointsFile, source: str, given_source: str) -> Tracks:
    """The joints of a file.

    Args:
        points: places [m] by name, each of shape (frames, 3).
        given: what the user says.
        source: the c3d file, for messages.
        given_source: the user's file, likewise.
    Raises:
        InputError: a named point that is not there or hardly seen, or a joint that is needed and not found.
    """
    bare = {_bare(name): name for name in points}
    found: dict[str, dict[str, Array]] = {}
    for joint, by_side in given.named().items():
        for side, names in by_side.items():
            exact = [_point(name, points, f"{side}.{joint}", given_source) for name in names]
            found.setdefault(joint, {})[side] = _mean(points, exact)
    for joint in LINK_OF:
        if joint not in found:
            found[joint] = dict(_common(joint, points, bare))
    if not found["hip"]:
        found["hip"] = dict(_hips(points, bare))
    visible = {
        joint: {side: track for side, track in sides.items() if np.isfinite(track).all(1).mean() >= VISIBLE}
        for joint, sides in found.items()
    }
    seen = {joint: sides for joint, sides in visible.items() if sides}
    for joint in (*NEEDED, *given.named()):
        if joint not in seen:
            _refuse(joint, points, source, named=joint in given.named())
    return seen


def _refuse(joint: str, points: Mapping[str, Array], source: str, *, named: bool) -> None:
    if named:
        raise InputError(source, joint, "points that at least half of all frames show", "hidden ones")
    listed = ", ".join([*points][:LISTED]) + (", .." if len(points) > LISTED else "")
    example = {"hip": "LHJC or LASI, RASI, LPSI, RPSI"}.get(joint, f"L{NAMES[joint][0][0].upper()}")
    wanted = f"points of the {joint} by a common name, such as {example}, or named in --points FILE"
    raise InputError(source, joint, wanted, listed or "no point")


def _point(name: str, points: Mapping[str, Array], key: str, source: str) -> str:
    if name not in points:
        wanted = f"a point of the c3d file{nearest_name(name, points)}"
        raise InputError(source, key, wanted, f"'{name}'")
    return name


def _bare(name: str) -> str:
    """Without the subject's name, signs and case."""
    return re.sub(r"[^a-z0-9]", "", name.rpartition(":")[2].lower())


def _sided(name: str, side: str, bare: Mapping[str, str]) -> str | None:
    """The file's point of a name on a side: before or behind it, as a letter or a word."""
    letter = side[0]
    forms = (letter + name, side + name, name + letter, name + side)
    return next((bare[form] for form in forms if form in bare), None)


def _common(joint: str, points: Mapping[str, Array], bare: Mapping[str, str]) -> Iterator[tuple[str, Array]]:
    for choice in NAMES[joint]:
        middle = [bare.get(name) for name in choice] if joint in ("l5s1", "t12") else [None]
        by_side = {side: [_sided(name, side, bare) for name in choice] for side in SIDES}
        for side, names in {MIDDLE: middle, **by_side}.items():
            known = [name for name in names if name is not None]
            if len(known) == len(names):
                yield side, _mean(points, known)
        if any(None not in names for names in (middle, *by_side.values())):
            return


def _mean(points: Mapping[str, Array], names: Sequence[str]) -> Array:
    return np.asarray(np.mean([points[name] for name in names], axis=0), float)


def _hips(points: Mapping[str, Array], bare: Mapping[str, str]) -> Iterator[tuple[str, Array]]:
    """Both hips from markers of the pelvis, if all four are there."""
    spines = [
        [next((p for name in of if (p := _sided(name, side, bare))), None) for side in SIDES] for of in PELVIS
    ]
    known = [points[name] for name in itertools.chain(*spines) if name is not None]
    if len(known) < len(SIDES) * len(PELVIS):
        return
    left, right, back_left, back_right = known
    lateral, width = _unit(left - right)
    ahead = (left + right - back_left - back_right) / 2.0
    forward, _ = _unit(ahead - np.sum(ahead * lateral, axis=1, keepdims=True) * lateral)
    up = np.cross(forward, lateral)
    behind, below, inwards = BELL
    moved = -width * (behind * forward + below * up)
    yield "left", left + moved - inwards * width * lateral
    yield "right", right + moved + inwards * width * lateral


def _unit(of: Array) -> tuple[Array, Array]:
    """Directions and lengths, by frame."""
    length = np.linalg.norm(of, axis=1, keepdims=True)
    return of / np.where(length > 0.0, length, np.nan), length
