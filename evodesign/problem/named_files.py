"""The files that a problem names, as text: an MJCF robot as the URDF that it is translated into."""

from __future__ import annotations

from pathlib import Path

from evodesign.errors import InputError
from evodesign.tree.mjcf_read import TranslatedRobot, is_mjcf, translated
from evodesign.tree.placeholder import placeholder

LONGEST_FILE = 10_000_000
"""Letters of a file that a problem names: a robot of 100 links has 100 kB."""


def read_robot(path: Path, name: str, source: str, key: str) -> TranslatedRobot:
    """The model of a robot or person.

    Args:
        path: of its URDF or MJCF.
        name: of the file, for messages on what is in it.
        source: who names it, for messages.
        key: where in the source, empty for the whole.
    Raises:
        InputError: as `read_text`; or an MJCF without MuJoCo, or one that is no usable robot.
    """
    text = read_text(path, source, key)
    if not is_mjcf(text):
        return TranslatedRobot(text)
    try:
        return translated(path, name)
    except ImportError as error:
        wanted = "a URDF, or MuJoCo, which reads MJCF: pip install 'evodesign[mjcf]'"
        raise InputError(source, key, wanted, f"the MJCF file '{path}' and no MuJoCo") from error


def read_text(path: Path, source: str, key: str) -> str:
    """A UTF-8 text file, without the mark of the byte order that some editors begin it with.

    Args:
        path: of the file.
        source: who names it, for messages.
        key: where in the source, empty for the whole.
    Raises:
        InputError: it cannot be read, is longer than `LONGEST_FILE`, or stands for a file that is not here.
    """
    try:
        if path.exists() and not path.is_file():  # reading a device or a pipe might never end
            raise InputError(source, key, "a file", f"'{path}', which is none")
        with path.open(encoding="utf-8-sig") as file:
            text = file.read(LONGEST_FILE + 1)
    except FileNotFoundError as error:
        raise InputError(source, key, "an existing file", f"no file '{path}'") from error
    except UnicodeDecodeError as error:
        raise InputError(source, key, "UTF-8 text", f"other bytes in '{path}'") from error
    except (OSError, ValueError) as error:
        raise InputError(source, key, "a readable file", f"'{path}' ({error})") from error
    if len(text) > LONGEST_FILE:
        raise InputError(source, key, f"a file of at most {LONGEST_FILE} letters", f"a longer '{path}'")
    if text.strip() and (missing := placeholder(text[:1000].encode(errors="replace"))):
        raise InputError(source, key, "a file with its content", f"'{path}', which {missing}")
    return text
