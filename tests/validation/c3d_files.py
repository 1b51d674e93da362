"""c3d files of a known motion, written by ezc3d."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
RATE = 5.0
SUBFRAMES = 4


def plate_channels(force: Array, place: Array, corners: Array, origin: Array) -> Array:
    """Three forces and three moments about the sensor, in the axes of a plate of type 2, by frame.

    Args:
        force: what is stored, in the axes of the laboratory [N], shape (frames, 3).
        place: its centre of pressure [m], likewise.
        corners: of the plate [m], shape (4, 3).
        origin: from the sensor to the middle of the surface, in the plate's axes [m].
    Returns:
        shape (6, frames), moments in N m.
    """
    x, y = corners[0] - corners[1], corners[0] - corners[3]
    x, y = x / np.linalg.norm(x), y / np.linalg.norm(y)
    axes = np.array([x, y, np.cross(x, y)])
    own, arm = force @ axes.T, (place - corners.mean(axis=0)) @ axes.T + origin
    return np.vstack([own.T, np.cross(arm, own).T])


def write_c3d(
    path: Path,
    points: Mapping[str, Array],
    plates: Sequence[tuple[Array, Array, Array]] = (),
    unit: str = "mm",
    rate: float = RATE,
    moment_unit: str | None = None,
) -> Path:
    """A file of points [m] by name, shape (frames, 3), and plates as (channels, corners, origin)."""
    import ezc3d

    scale = {"mm": 1000.0, "cm": 100.0, "m": 1.0}.get(unit, 1.0)
    file = ezc3d.c3d()
    file["parameters"]["POINT"]["RATE"]["value"] = [rate]
    file["parameters"]["POINT"]["LABELS"]["value"] = [*points]
    file["parameters"]["POINT"]["UNITS"]["value"] = [unit]
    places = scale * np.array([*points.values()]).transpose(2, 0, 1)
    file["data"]["points"] = np.concatenate([places, np.ones((1, *places.shape[1:]))])
    if plates:
        channels = np.vstack([np.vstack([each[:3], scale * each[3:]]) for each, _, _ in plates])
        file["parameters"]["ANALOG"]["RATE"]["value"] = [rate * SUBFRAMES]
        file["parameters"]["ANALOG"]["LABELS"]["value"] = [f"channel {i}" for i in range(len(channels))]
        units = ["N"] * 3 + [moment_unit or f"N{unit}"] * 3
        file["parameters"]["ANALOG"]["UNITS"]["value"] = units * len(plates)
        file["data"]["analogs"] = np.repeat(channels, SUBFRAMES, axis=1)[None]
        numbers = np.arange(1, len(channels) + 1).reshape(len(plates), 6).T
        for name, value in {
            "USED": np.array([len(plates)]),
            "TYPE": np.array([2] * len(plates)),
            "CORNERS": scale * np.stack([corners.T for _, corners, _ in plates], axis=2),
            "ORIGIN": scale * np.stack([origin for _, _, origin in plates], axis=1),
            "CHANNEL": numbers,
        }.items():
            kind = ezc3d.ezc3d.FLOAT if value.dtype.kind == "f" else ezc3d.ezc3d.INT
            file["parameters"]["FORCE_PLATFORM"][name] |= {"value": value, "type": kind}
    file.write(str(path))
    return path
