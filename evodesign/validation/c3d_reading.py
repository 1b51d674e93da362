"""What a c3d file holds, read by ezc3d in a process of its own: a damaged file can crash or stall it.

Source: ezc3d gives each plate's force and centre of pressure by its type, corners and origin (Michaud and
Begon 2021, Journal of Open Source Software 6(58): 2911).
"""

from __future__ import annotations

import resource
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from evodesign.errors import InputError

Array = NDArray[np.float64]

SECONDS, BYTES = 120.0, 8 << 30
"""What reading may take."""

OF_FORCES_AND_MOMENTS = 2
"""Type of a plate whose channels are three forces and three moments."""

FAILURES = (OSError, RuntimeError, ValueError, LookupError, MemoryError, TypeError, ArithmeticError)
"""What ezc3d raises for a file that it cannot read."""


class ForcePlate(msgspec.Struct, frozen=True):
    """A force plate, in the units and axes of the file.

    Args:
        corners, force, place: the last of the centre of pressure; rows of three numbers, of force and place
            as many in each frame.
        units: of its six channels, if they are forces and moments.
    """

    corners: list[list[float]]
    force: list[list[float]]
    place: list[list[float]]
    units: list[str]


class C3dContent(msgspec.Struct, frozen=True):
    """A file, in its own units and axes.

    Args:
        names: of points.
        places: of each point in each frame; not a number where it is hidden.
        unit: of places, as it is written.
        rate: frames a second; 0 where the file does not say.
        used: how many plates it has.
        platforms: the plates; none if they cannot be read.
        failure: why.
    """

    names: list[str]
    places: list[list[list[float]]]
    unit: str
    rate: float
    used: int
    platforms: list[ForcePlate]
    failure: str


def read_content(path: Path) -> C3dContent:
    """A file, read in another process.

    Raises:
        InputError: ezc3d is not installed, or cannot read the file.
    """
    source = str(path)
    if find_spec("ezc3d") is None:
        wanted = "ezc3d installed (pip install 'evodesign[measured]')"
        raise InputError(source, "", wanted, "no package 'ezc3d'")
    if not path.is_file():  # reading a device or a pipe might never end
        raise InputError(source, "", "an existing file", "none")
    with TemporaryDirectory() as folder:
        read = Path(folder) / "read"
        command = [sys.executable, "-m", __name__, str(path.resolve()), str(read)]
        try:
            done = subprocess.run(  # noqa: S603
                command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, timeout=SECONDS, check=False
            )
        except subprocess.TimeoutExpired as error:
            found = f"one that takes longer than {SECONDS:.0f} s"
            raise InputError(source, "", "a c3d file that ezc3d can read", found) from error
        if done.returncode or not read.is_file():
            lines = done.stderr.decode(errors="replace").strip().splitlines() if done.returncode > 0 else []
            found = lines[-1] if lines else "one that ends ezc3d's process"
            raise InputError(source, "", "a c3d file that ezc3d can read", found)
        return msgspec.msgpack.decode(read.read_bytes(), type=C3dContent)


def _content(path: str) -> C3dContent:
    import ezc3d

    opened = ezc3d.c3d(path)
    names, more = _parameter(opened, "POINT", "LABELS"), 2
    while own := _parameter(opened, "POINT", f"LABELS{more}"):
        names, more = [*names, *own], more + 1
    used = int((_parameter(opened, "FORCE_PLATFORM", "USED") or [0])[0])
    platforms, failure = list[ForcePlate](), ""
    if used:
        try:
            platforms = _platforms(opened, ezc3d.c3d(path, extract_forceplat_data=True)["data"]["platform"])
        except FAILURES as error:
            failure = str(error) or type(error).__name__
    return C3dContent(
        [str(name).strip() for name in names],
        np.asarray(opened["data"]["points"][:3], float).transpose(1, 2, 0).tolist(),
        str((_parameter(opened, "POINT", "UNITS") or [""])[0]).strip(),
        float((_parameter(opened, "POINT", "RATE") or [0.0])[0]),
        used,
        platforms,
        failure,
    )


def _platforms(opened: Any, given: list[Any]) -> list[ForcePlate]:
    kinds, units = _parameter(opened, "FORCE_PLATFORM", "TYPE"), _parameter(opened, "ANALOG", "UNITS")
    channels = np.array(_parameter(opened, "FORCE_PLATFORM", "CHANNEL"), int).reshape(len(kinds), -1)
    found = []
    for plate, kind, own in zip(given, kinds, channels.tolist(), strict=False):
        known = own[:6] if int(kind) == OF_FORCES_AND_MOMENTS else []
        corners, force, place = (
            np.asarray(plate[name], float).T.tolist() for name in ("corners", "force", "center_of_pressure")
        )
        named = [str(units[i - 1]).strip() if 0 < i <= len(units) else "" for i in known]
        found.append(ForcePlate(corners, force, place, named))
    return found


def _parameter(opened: Any, group: str, name: str) -> list[Any]:
    groups = opened["parameters"]
    values = groups[group][name]["value"] if group in groups and name in groups[group] else ()
    found: list[Any] = np.asarray(values).ravel(order="F").tolist()
    return found


def main() -> None:
    """Read one file and write what it holds to another; what is wrong goes to the error output."""
    resource.setrlimit(resource.RLIMIT_AS, (BYTES, BYTES))
    path, target = sys.argv[1:]
    try:
        Path(target).write_bytes(msgspec.msgpack.encode(_content(path)))
    except FAILURES as error:
        sys.exit(str(error).partition("\n")[0] or type(error).__name__)


if __name__ == "__main__":
    main()
