"""Copying a problem, with what it names, into a folder of one's own."""

from __future__ import annotations

from pathlib import Path

from evodesign.errors import InputError
from evodesign.files import write_folder
from evodesign.problem.schema import SCHEMA_FILE, schema_file, with_schema_line
from evodesign.records import ProblemSource


def copy_source(source: ProblemSource, folder: Path) -> tuple[Path, ...]:
    """Write a problem and the files that it names into a new folder, and the schema of problem files.

    Returns:
        The files, that of the problem first; its keys name the others where they are now.
    Raises:
        InputError: the folder cannot be made, or is there already.
    """
    text, files = with_schema_line(source.text), dict[str, str]()
    for name, content in source.files.items():
        inside = Path(*(part for part in Path(name).parts if part not in ("..", Path(name).anchor)))
        files[inside.as_posix()] = content
        text = text.replace(f'"{name}"', f'"{inside.as_posix()}"')
    files = {Path(source.path).name: text, **files, SCHEMA_FILE: schema_file()}
    try:
        write_folder(folder, {name: content.encode() for name, content in files.items()}, new=True)
    except OSError as error:
        raise InputError("--to", "", "a new folder", f"'{folder}' ({error.strerror})") from error
    return tuple(folder / name for name in files)
