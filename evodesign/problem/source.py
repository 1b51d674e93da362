"""Reading a problem and the files that it names."""

from __future__ import annotations

from pathlib import Path

from evodesign.errors import InputError
from evodesign.problem.decode import decode_toml
from evodesign.problem.file import ProblemFile
from evodesign.records import ProblemSource

__all__ = ["read_source", "read_text"]


def read_source(path: Path, symmetry: str | None = None) -> ProblemSource:
    """A problem file and every file it names, as text.

    Args:
        path: of the problem file.
        symmetry: of postures, in place of the file's; None leaves it to the file.
    Raises:
        InputError: a file is missing or is not UTF-8 text, or the problem file does not decode.
    """
    text = read_text(path, str(path), "")
    tables = decode_toml(text, str(path), ProblemFile)
    named = {
        "robot.urdf": tables.robot.urdf,
        **{f"{key}.urdf": table.urdf for key, table in tables.people.items()},
        "search.start": tables.search.start,
    }
    files = {
        name: read_text(path.parent / name, str(path), key) for key, name in named.items() if name is not None
    }
    return ProblemSource(path=str(path), text=text, files=files, symmetry=symmetry)


def read_text(path: Path, source: str, key: str) -> str:
    """A UTF-8 text file.

    Args:
        path: of the file.
        source: who names it, for messages.
        key: where in the source, empty for the whole.
    Raises:
        InputError: it cannot be read.
    """
    try:
        if path.exists() and not path.is_file():  # reading a device or a pipe might never end
            raise InputError(source, key, "a file", f"'{path}', which is none")
        return path.read_text(encoding="utf-8")
    except FileNotFoundError as error:
        raise InputError(source, key, "an existing file", f"no file '{path}'") from error
    except UnicodeDecodeError as error:
        raise InputError(source, key, "UTF-8 text", f"other bytes in '{path}'") from error
    except (OSError, ValueError) as error:
        raise InputError(source, key, "a readable file", f"'{path}' ({error})") from error
