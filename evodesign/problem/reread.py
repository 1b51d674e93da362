"""Looking again at the files of a problem that a log names, without following it anywhere."""

from __future__ import annotations

import os
from pathlib import Path

import msgspec

from evodesign.errors import InputError
from evodesign.files import is_there
from evodesign.problem.meshes import is_kept_name
from evodesign.problem.named_files import read_text
from evodesign.problem.shipped import SHIPPED
from evodesign.records import ProblemSource
from evodesign.tree.mjcf_read import is_mjcf

COME_WITH_EVODESIGN = (SHIPPED, SHIPPED.parent / "populations")
"""Folders of the problems that come with evodesign, with their robots, and of the designs that they name."""


def reread(source: ProblemSource, folder: Path) -> ProblemSource:
    """The files of a problem as they are now; what it keeps of meshes and of MJCF is not looked at again.

    Args:
        source: from a log, which may come from elsewhere and name any file.
        folder: below which all files lie that are read, beside those that come with evodesign.
    Raises:
        InputError: a file lies elsewhere, is missing or cannot be read.
    """
    path = Path(source.path)
    text = read_text(_within(path, folder, source), source.path, "")
    files = {}
    for name, before in source.files.items():
        if is_kept_name(name):
            files[name] = before
            continue
        named = _within(path.parent / name, folder, source)
        found = named if is_there(named) else _within(SHIPPED / name, folder, source)
        text_now = read_text(found, source.path, name)
        files[name] = before if is_mjcf(text_now) else text_now
    return msgspec.structs.replace(source, text=text, files=files)


def _within(path: Path, folder: Path, source: ProblemSource) -> Path:
    """A path of the folder or of what comes with evodesign, as it stands and with its links followed."""
    wanted = f"a file in '{folder}'"
    plain = Path(os.path.abspath(path))  # noqa: PTH100 - on the disk nothing outside is looked up
    try:
        for place in map(Path.resolve, (folder, *COME_WITH_EVODESIGN)):
            if plain.is_relative_to(place) and plain.resolve().is_relative_to(place):
                return plain
    except (OSError, ValueError, RuntimeError) as error:
        raise InputError(source.path, "", wanted, f"'{path}' ({error})") from error
    raise InputError(source.path, "", wanted, f"'{path}'")
