"""A recording as a CSV file: places of joints and forces, one row per frame. Columns: docs/trust.md."""

from __future__ import annotations

import csv
import math
from collections.abc import Mapping, Sequence
from pathlib import Path

from evodesign.errors import InputError, nearest_name
from evodesign.human.anthropometry import Person
from evodesign.mechanics.balance import GRAVITY
from evodesign.validation.measured import Frame, Plate
from evodesign.validation.posed import LINK_OF, Places

NEEDED = ("hip", "shoulder", "elbow", "wrist")
"""Joints whose places a recording must have."""

OF_LEGS = ("ankle", "knee")
"""Joints that are needed beside where the plate is to give a moment."""

PLATE = ("plate_force_x_n", "plate_force_z_n", "plate_x_m")
HANDS, L5S1, RECORDING, TIME = "hand_force_n", "l5s1_n_m", "recording", "time_s"
KNOWN = (
    *(f"{name}_{axis}_m" for name in LINK_OF for axis in "xz"),
    *PLATE,
    HANDS,
    L5S1,
    RECORDING,
    TIME,
)
LARGEST = 1e5
"""Beyond which a number is no place [m], force [N] or moment [N m] of a person."""


def read_recording(path: Path, person: Person) -> dict[str, list[Frame]]:
    """Frames of a file, by recording.

    Raises:
        InputError: a file that cannot be read, or is not as wanted.
    """
    try:
        text = path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise InputError(str(path), "", "a CSV file that can be read", f"{error.strerror}") from error
    except UnicodeDecodeError as error:
        raise InputError(str(path), "", "a CSV file in UTF-8", "other bytes") from error
    return read_frames(text, str(path), person)


def read_frames(text: str, source: str, person: Person) -> dict[str, list[Frame]]:
    """The same of a file's text; lines that begin with # are remarks.

    Args:
        text: of the file.
        source: its name, for sentences.
        person: whose weight tells the hands' force where a plate alone was there.
    Raises:
        InputError: a column that is missing or unknown, a cell that is no number, places that are not in
            metres, or no frame at all.
    """
    lines = [(n, line) for n, line in enumerate(text.splitlines(), 1) if line.strip() and line[0] != "#"]
    rows = [*csv.reader(line for _, line in lines)]
    header = [name.strip() for name in rows[0]] if rows else []
    _check_columns(header, source)
    if len(rows) < 2:
        raise InputError(source, "", "a row of numbers for each frame", "no row below the columns' names")
    found: dict[str, list[Frame]] = {}
    for (number, _), cells in zip(lines[1:], rows[1:], strict=False):
        if len(cells) != len(header):
            raise InputError(source, f"line {number}", f"{len(header)} cells", f"{len(cells)}")
        row = dict(zip(header, (cell.strip() for cell in cells), strict=True))
        who = row.pop(RECORDING, "") or "recording"
        frame = _frame(_numbers(row, source, number), person)
        refuse_far_places(frame.places, person, source, f"line {number}")
        found.setdefault(who, []).append(frame)
    return found


def _check_columns(header: Sequence[str], source: str) -> None:
    for name in header:
        if name not in KNOWN:
            raise InputError(
                source, "", f"columns that docs/trust.md lists{nearest_name(name, KNOWN)}", f"'{name}'"
            )
        if header.count(name) > 1:
            raise InputError(source, name, "one column of this name", f"{header.count(name)}")
    needed = [f"{name}_{axis}_m" for name in NEEDED for axis in "xz"]
    if HANDS not in header:
        needed += PLATE
    if set(PLATE) & set(header):
        needed += [*PLATE, *(f"{name}_{axis}_m" for name in OF_LEGS for axis in "xz")]
    needed += [
        f"{name}_{axis}_m" for name in LINK_OF for axis in "xz" if {f"{name}_x_m", f"{name}_z_m"} & {*header}
    ]
    for name in needed:
        if name not in header:
            beside = f" (or '{HANDS}')" if name == PLATE[0] and HANDS not in header else ""
            raise InputError(source, "", f"a column '{name}'{beside}", "none of that name")


def _numbers(row: Mapping[str, str], source: str, line: int) -> dict[str, float]:
    found = {}
    for name, cell in row.items():
        try:
            found[name] = float(cell)
        except ValueError:
            found[name] = math.nan
        if not abs(found[name]) < LARGEST:
            raise InputError(source, f"line {line}, column {name}", "a number", f"'{cell}'")
    return found


def _frame(row: Mapping[str, float], person: Person) -> Frame:
    plate = Plate(*(row[name] for name in PLATE)) if PLATE[0] in row else None
    places = {name: (row[f"{name}_x_m"], row[f"{name}_z_m"]) for name in LINK_OF if f"{name}_x_m" in row}
    return frame_of(places, plate, row.get(HANDS), {"l5s1": row[L5S1]} if L5S1 in row else {}, person)


def frame_of(
    places: Places,
    plate: Plate | None,
    hand_force: float | None,
    moments: Mapping[str, float],
    person: Person,
) -> Frame:
    """A frame of places; a plate tells the weight in the hands [N] where none is given."""
    held = 0.0 if plate is None else plate.up - person.mass * GRAVITY
    force = max(0.0, held if hand_force is None else hand_force)
    return Frame(force, hand_force is not None, places["wrist"][1], moments, plate, places, {})


def refuse_far_places(places: Places, person: Person, source: str, key: str) -> None:
    """Refuse places of another unit.

    Raises:
        InputError: hip and shoulder are farther apart than the person is tall.
    """
    apart = math.dist(places["hip"], places["shoulder"])
    if not apart < person.stature:
        wanted = f"hip and shoulder less than {person.stature:g} m apart, in metres"
        raise InputError(source, key, wanted, f"{apart:g} m")
