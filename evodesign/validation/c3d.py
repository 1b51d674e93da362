"""A recording as a c3d file: places of points and forces of plates, turned to frames in the sagittal plane.

    forward = left x up        x_p = sum_i (x_i F_zi - z_i F_xi) / sum_i F_zi

with left the mean direction from right to left joints, F_i the force of the ground on plate i's feet at
(x_i, z_i), and x_p the centre of pressure of all plates at the height of the floor, z = 0, which is that of
their surfaces. A plate may be stored with what it is pressed by or with its reaction: the ground pushes up.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from evodesign.errors import InputError
from evodesign.human.anthropometry import Person
from evodesign.validation.c3d_points import SIDES, LengthUnit, PointsFile, Tracks, joint_tracks
from evodesign.validation.c3d_reading import C3dContent, ForcePlate, read_content
from evodesign.validation.measured import Frame, Plate
from evodesign.validation.recording import OF_LEGS, frame_of, refuse_far_places

Array = NDArray[np.float64]

FRAMES_PER_SECOND = 5.0
"""Frames that are used; a person moves little in between."""

LOADED = 5.0
"""Force [N] below which a plate tells no centre of pressure."""

BEYOND = 0.1
"""How far [m] a centre of pressure may lie outside of its plate."""

UPRIGHT = 0.8
"""Cosine between an axis and the line from ankles to shoulders from which the axis is up."""


def is_c3d(path: Path) -> bool:
    """Whether a file is one, by its name."""
    return path.suffix.lower() == ".c3d"


def read_c3d(path: Path, person: Person, given: PointsFile, given_source: str) -> dict[str, list[Frame]]:
    """Frames of a file, as one recording.

    Args:
        path: of the file.
        person: whose weight tells the hands' force where a plate alone was there.
        given: what the user says of the file.
        given_source: where, for messages.
    Raises:
        InputError: ezc3d is not installed, or a file that cannot be read or lacks what is needed.
    """
    source, content = str(path), read_content(path)
    if not any(content.places):
        raise InputError(source, "", "points in at least one frame", "none")
    unit = _unit(content, given, source)
    tracks = joint_tracks(_points(content, unit), given, source, given_source)
    tracks, seen = _seen(tracks, source)
    axes = _axes(tracks, given, source)
    ground = _ground(content, given, unit, axes, source)
    if ground is None and given.hand_force_n is None:
        wanted = "force plates, or hand_force_n in --points FILE"
        raise InputError(source, "FORCE_PLATFORM", wanted, "no plate")
    if ground is not None and not set(OF_LEGS) <= tracks.keys():
        wanted = "points of knee and ankle beside plates, or plates = [] and hand_force_n in --points FILE"
        raise InputError(source, "knee, ankle", wanted, "none of a common name")
    floor = 0.0 if ground is None else ground.floor
    places = {name: _middle(sides) @ axes.sagittal.T - [0.0, floor] for name, sides in tracks.items()}
    step, frames = max(1, math.ceil(content.rate / FRAMES_PER_SECOND)), list[Frame]()
    for place, number in enumerate(seen):
        plate = None if ground is None else ground.at(number)
        if (number - seen[0]) % step or (plate is not None and not math.isfinite(plate.x)):
            continue
        at = {name: (float(track[place, 0]), float(track[place, 1])) for name, track in places.items()}
        refuse_far_places(at, person, source, f"frame {number + 1}")
        frames.append(frame_of(at, plate, given.hand_force_n, {}, person))
    if not frames:
        raise InputError(source, "FORCE_PLATFORM", "feet on a plate in a frame that shows all joints", "none")
    return {path.stem: frames}


def _seen(tracks: Tracks, source: str) -> tuple[Tracks, list[int]]:
    """The tracks in frames that show all joints, and the numbers of these frames, from 0."""
    every = [np.all(np.isfinite(track), axis=1) for sides in tracks.values() for track in sides.values()]
    seen = np.flatnonzero(np.all(every, axis=0))
    if not len(seen):
        raise InputError(source, "", "a frame that shows all joints", f"none of {len(every[0])}")
    found = {name: {side: track[seen] for side, track in sides.items()} for name, sides in tracks.items()}
    return found, seen.tolist()


def _unit(content: C3dContent, given: PointsFile, source: str) -> LengthUnit:
    if given.unit is not None:
        return given.unit
    if content.unit not in [*LengthUnit]:
        wanted = f"{', '.join(LengthUnit)} or unit in --points FILE"
        raise InputError(source, "POINT:UNITS", wanted, f"'{content.unit}'" if content.unit else "nothing")
    return LengthUnit(content.unit)


def _points(content: C3dContent, unit: LengthUnit) -> dict[str, Array]:
    """Places [m] by name, nan where a point is hidden: c3d files have no number or zeros there."""
    places = unit.metres * np.array(content.places, float).reshape(len(content.places), -1, 3)
    places[np.all(places == 0.0, axis=2)] = np.nan
    return dict(zip(content.names, places, strict=False))


@dataclass(frozen=True, slots=True)
class _Axes:
    """Directions in the axes of the file, of length 1."""

    forward: Array
    up: Array

    @property
    def sagittal(self) -> Array:
        """Rows that give x and z."""
        return np.array([self.forward, self.up])


def _axes(tracks: Tracks, given: PointsFile, source: str) -> _Axes:
    """Up and forward, as the user says or as the person stands."""
    up = _up(tracks, source) if given.up is None else given.up.vector
    if given.forward is not None:
        forward = given.forward.vector
        if abs(forward @ up) > 0.5:
            raise InputError(
                source, "forward", "a direction across up in --points FILE", f"'{given.forward}'"
            )
        return _Axes(forward, up)
    across = [sides["left"] - sides["right"] for sides in tracks.values() if set(SIDES) <= sides.keys()]
    if not across:
        wanted = "points of both sides of a joint, or forward in --points FILE"
        raise InputError(source, "forward", wanted, "points of one side or of the middle")
    left = np.mean(np.concatenate(across), axis=0)
    forward = np.cross(left, up)
    length = float(np.linalg.norm(forward))
    if not length > 0.5 * float(np.linalg.norm(left)):
        raise InputError(source, "forward", "a left side beside the right one", "sides above each other")
    return _Axes(forward / length, up)


def _up(tracks: Tracks, source: str) -> Array:
    low = next(name for name in ("ankle", "knee", "hip") if name in tracks)
    line = np.mean(_middle(tracks["shoulder"]) - _middle(tracks[low]), axis=0)
    largest = int(np.argmax(np.abs(line)))
    if not abs(line[largest]) > UPRIGHT * float(np.linalg.norm(line)):
        wanted = f"an axis along the line from {low}s to shoulders, or up in --points FILE"
        raise InputError(source, "up", wanted, f"the direction {np.round(line, 2).tolist()}")
    return np.asarray(np.eye(3)[largest] * np.sign(line[largest]), float)


def _middle(sides: Mapping[str, Array]) -> Array:
    return np.asarray(np.mean([*sides.values()], axis=0), float)


@dataclass(frozen=True, slots=True)
class _Ground:
    """Force of the ground on the feet by frame [N], its centre of pressure and the floor's height [m]."""

    forward: Array
    up: Array
    x: Array
    floor: float

    def at(self, frame: int) -> Plate:
        """In a frame, as of one plate."""
        return Plate(float(self.forward[frame]), float(self.up[frame]), float(self.x[frame]))


def _ground(
    content: C3dContent, given: PointsFile, unit: LengthUnit, axes: _Axes, source: str
) -> _Ground | None:
    """What the plates under the feet tell; None where there is none."""
    every = (*range(1, content.used + 1),)
    numbers = every if given.plates is None else (*dict.fromkeys(given.plates),)
    if not numbers:
        return None
    if content.failure:
        raise InputError(source, "FORCE_PLATFORM", "force plates that ezc3d can read", content.failure)
    for number in numbers:
        if number > len(content.platforms):
            raise InputError(
                source, "plates", f"numbers up to {len(content.platforms)}, the last plate's", f"{number}"
            )
    plates = [content.platforms[number - 1] for number in numbers]
    corners = [unit.metres * np.array(plate.corners, float) for plate in plates]
    floor = float(np.mean([each @ axes.up for each in corners]))
    total = np.zeros((3, len(content.places[0])))
    for number, plate, own in zip(numbers, plates, corners, strict=True):
        where = f"FORCE_PLATFORM {number}"
        _refuse_units(plate, unit, source, where)
        force, place = np.array(plate.force, float), unit.metres * np.array(plate.place, float)
        loaded = (np.abs(force @ axes.up) > LOADED) & np.all(np.isfinite(place), axis=1)
        _refuse_outside(place[loaded], own, source, where)
        force, place = (np.where(loaded[:, None], each, 0.0) for each in (force, place))
        (x, z), (f_x, f_z) = (axes.sagittal @ each.T for each in (place, force))
        samples = np.array([f_x, f_z, x * f_z - (z - floor) * f_x])
        total += samples.reshape(*total.shape, -1).mean(axis=2)
    total *= math.copysign(1.0, float(np.sum(total[1])))
    forward, up, moment = total
    x = np.divide(moment, up, out=np.full(len(up), np.nan), where=up > LOADED)
    return _Ground(forward, up, x, floor)


def _refuse_units(plate: ForcePlate, unit: LengthUnit, source: str, key: str) -> None:
    """Refuse forces or moments of other units; a file may leave units out, or name the raw signal's."""
    for number, found in enumerate(plate.units):
        wanted = "N" if number < len(plate.units) // 2 else f"N{unit}"
        if found and re.sub(r"[^A-Za-z]", "", found) not in (wanted, "V"):
            what = f"forces in N and moments in N{unit}, as its places"
            raise InputError(source, key, what, f"'{found}'")


def _refuse_outside(places: Array, corners: Array, source: str, key: str) -> None:
    """Refuse a centre of pressure that lies far from the plate on average."""
    if not len(places):
        return
    low, high = corners.min(axis=0), corners.max(axis=0)
    away = float(np.mean(np.linalg.norm(places - np.clip(places, low, high), axis=1)))
    if away > BEYOND:
        wanted = "a centre of pressure within the plate's corners (ORIGIN, CAL_MATRIX, unit of moments)"
        raise InputError(source, key, wanted, f"{away:.2g} m outside on average")
