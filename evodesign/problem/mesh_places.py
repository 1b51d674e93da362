"""Where the mesh files lie that a URDF names.

    NAME.stl, ../NAME.stl            from the URDF's folder
    file:///PLACE/NAME.stl           there
    package://PACKAGE/NAME.stl       in a package: a folder called PACKAGE, which is one of, or is in one of,
    model://PACKAGE/NAME.stl         those of `[robot] packages`, ROS_PACKAGE_PATH, share in those of
                                     AMENT_PREFIX_PATH, and the URDF's folder with all above it

The first file that is there is taken.

Source: wiki.ros.org/urdf/XML/link (mesh), REP 122 (layout of an installation).
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import unquote

IN_PACKAGE = ("package", "model")
"""Schemes whose first part is a package's name."""


@dataclass(frozen=True, slots=True)
class MeshPlaces:
    """Where to look.

    Args:
        folder: of the URDF.
        packages: further folders, from where the problem is.
        environment: with ROS_PACKAGE_PATH and AMENT_PREFIX_PATH.
    """

    folder: Path
    packages: Sequence[Path]
    environment: Mapping[str, str]

    def find(self, name: str) -> Path | None:
        """The file of a mesh by its name in the URDF; None where there is none."""
        for path in self._candidates(name):
            try:
                if path.is_file():
                    return path
            except (OSError, ValueError):  # a name that is too long, or no name of a file
                continue
        return None

    def searched(self, name: str) -> str:
        """Where a mesh was looked for, in words."""
        scheme, separator, _ = name.partition("://")
        if not separator or scheme == "file":
            return str(self.folder)
        if scheme not in IN_PACKAGE:
            return "no place, as it is no file"
        given = [*self.packages, *self._in_environment()]
        return ", ".join([*map(str, given), f"{self.folder} and above"])

    def _candidates(self, name: str) -> Iterator[Path]:
        scheme, separator, rest = name.partition("://")
        if not separator:
            yield self.folder / name
        elif scheme == "file":
            yield self.folder / unquote(rest)
        elif scheme in IN_PACKAGE:
            package, _, inside = rest.partition("/")
            for place in (*self.packages, *self._in_environment(), self.folder, *self.folder.parents):
                if place.name == package:
                    yield place / inside
                yield place / package / inside

    def _in_environment(self) -> Iterator[Path]:
        for variable, below in (("ROS_PACKAGE_PATH", ""), ("AMENT_PREFIX_PATH", "share")):
            for place in self.environment.get(variable, "").split(os.pathsep):
                if place:
                    yield Path(place) / below
