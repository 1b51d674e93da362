"""The meshes of a problem's robot: read beside the problem, and kept with it.

What a problem keeps of a mesh file is a text in `ProblemSource.files`, its few triangles and its volume
(`tree.surface`), so that a run needs no file outside of its directory. The text's name follows from the
mesh's name in the URDF; a file of that name beside the problem goes before the mesh file itself, so a copy of
a problem has the meshes of the problem.
"""

from __future__ import annotations

import hashlib
import math
import os
import re
from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path, PurePosixPath
from urllib.parse import unquote

import numpy as np

from evodesign.errors import InputError, ModelError
from evodesign.problem.agent_tables import RobotTable
from evodesign.problem.mesh_reading import few_triangles, read_mesh
from evodesign.tree.mesh_write import vertices_of
from evodesign.tree.mjcf_read import TranslatedRobot
from evodesign.tree.model import Link, Mesh, Tree
from evodesign.tree.surface import Surface, read_surface, surface_of, surface_text
from evodesign.tree.unit_doubts import mesh_doubts
from evodesign.tree.urdf_read import InertiaRule, read_urdf

OF_ONE, OF_ALL, FEWEST = 2_000, 80_000, 12
"""Triangles kept of a mesh and, shared equally, of a robot's: 1 MB; and of each of very many."""

MOST_SHOWN = 500_000
"""Triangles of all links together, of which several may show the same mesh: 25 MB of exported files."""

MOST_MESHES = 1_000
"""Mesh files of a robot."""

LONGEST_KEPT = 1_000_000
"""Letters of a kept mesh."""

KEY = "robot.urdf"


def kept_name(mesh: str) -> str:
    """The name under which a problem keeps a mesh, such as `meshes/chest-0123456789ab.json`."""
    stem = re.sub(r"[^A-Za-z0-9_-]+", "_", PurePosixPath(mesh).stem)[:60]
    return f"meshes/{stem}-{hashlib.sha256(mesh.encode(errors='surrogatepass')).hexdigest()[:12]}.json"


def is_kept_name(name: str) -> bool:
    """Whether a file of a problem is a kept mesh."""
    return re.fullmatch(r"meshes/[A-Za-z0-9_-]*-[0-9a-f]{12}\.json", name) is not None


def mesh_texts(
    table: RobotTable, file: Path, robot: TranslatedRobot, folder: Path, source: str, key: str = KEY
) -> dict[str, str]:
    """The meshes that a robot shows, as texts by the names under which the problem keeps them.

    Args:
        table: the robot's, of the problem.
        file: path of the robot's file.
        robot: its content. Nothing is read if it is no usable URDF, of which building the problem tells.
        folder: of the problem.
        source: the problem's name, for messages.
        key: of the robot's file, likewise.
    Raises:
        InputError: a mesh is nowhere, cannot be read, or there are too many.
    """
    if not table.meshes or "<mesh" not in robot.urdf:
        return {}
    try:
        tree = read_urdf(robot.urdf, table.urdf, InertiaRule.FILE)
    except ModelError:
        return {}
    links = {
        mesh.file: link.name for link in reversed(tree.links) for mesh in link.meshes if not mesh.surface
    }
    if len(links) > MOST_MESHES:
        wanted = f"at most {MOST_MESHES} mesh files; [robot] meshes = false leaves them out"
        raise InputError(source, key, wanted, f"{len(links)} in '{table.urdf}'")
    packages = [folder / place for place in table.packages]
    places = MeshPlaces(file.absolute().parent, packages, os.environ)
    uses = sum(len(link.meshes) for link in tree.links)
    most = max(FEWEST, min(OF_ONE, OF_ALL // max(len(links), 1), MOST_SHOWN // max(uses, 1)))
    kept = {mesh: _kept(folder / kept_name(mesh)) for mesh in sorted(links)}
    missing = [mesh for mesh in kept if kept[mesh] is None]
    keys = {mesh: f"{key}, link {links[mesh]}" for mesh in missing}
    own = [mesh for mesh in missing if mesh in robot.meshes]
    paths = {
        mesh: _found(mesh, links[mesh], places, source, key) for mesh in missing if mesh not in robot.meshes
    }
    read = {mesh: read_mesh(path, most, source, keys[mesh]) for mesh, path in paths.items()}
    read = stood_upright(tree, read, [mesh for mesh, path in paths.items() if says_y_up(path)])
    read |= {mesh: few_triangles(robot.meshes[mesh], mesh, most, source, keys[mesh]) for mesh in own}
    return {
        kept_name(mesh): surface_text(read[mesh]) if text is None else text for mesh, text in kept.items()
    }


def _kept(path: Path) -> str | None:
    """What a copied problem has of a mesh."""
    try:
        if path.is_file() and path.stat().st_size <= LONGEST_KEPT:
            return path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError):
        pass
    return None


def _found(mesh: str, link: str, places: MeshPlaces, source: str, key: str) -> Path:
    path = places.find(mesh)
    if path is None:
        wanted = (
            f"the mesh '{mesh}' of link {link}; [robot] packages = [..] names folders of packages, "
            f"meshes = false leaves meshes out"
        )
        raise InputError(source, key, wanted, f"no such file, looked for in {places.searched(mesh)}")
    return path


def with_surfaces(tree: Tree, files: Mapping[str, str], source: str) -> Tree:
    """The tree with the triangles of its meshes, as far as a problem keeps them.

    Args:
        tree: of the robot's URDF.
        files: of the problem, by name.
        source: the problem's name, for messages.
    Raises:
        InputError: a kept text is not that of a mesh, or links show more than `MOST_SHOWN` triangles.
    """
    surfaces: dict[str, Surface] = {}
    for name in {mesh.file for link in tree.links for mesh in link.meshes}:
        kept = kept_name(name)
        if kept in files:
            surfaces[name] = read_surface(files[kept], source, kept)

    def seen(mesh: Mesh) -> Mesh:
        return mesh if mesh.surface else replace(mesh, surface=surfaces.get(mesh.file))

    links = tuple(replace(link, meshes=tuple(map(seen, link.meshes))) for link in tree.links)
    shown = Counter(mesh.surface for link in links for mesh in link.shown)
    triangles = sum(len(surface.faces) * count for surface, count in shown.items() if surface)
    if triangles > MOST_SHOWN:
        wanted = (
            f"meshes of at most {MOST_SHOWN} triangles in all links; [robot] meshes = false leaves them out"
        )
        raise InputError(source, KEY, wanted, f"{triangles}")
    return replace(tree, links=links, notes=(*tree.notes, *mesh_doubts(links)))


def with_meshes_beside(tree: Tree, file: Path, robot: TranslatedRobot) -> Tree:
    """The tree of a robot that no problem names yet with its meshes; with a note if one cannot be had.

    Args:
        tree: of the robot.
        file: path of its file.
        robot: its content.
    """
    try:
        texts = mesh_texts(RobotTable(urdf=str(file)), file, robot, file.parent, str(file))
    except InputError as error:
        return replace(tree, notes=(*tree.notes, str(error)))
    return with_surfaces(tree, texts, str(file))


IN_PACKAGE = ("package", "model")
"""Schemes whose first part is a package's name."""


@dataclass(frozen=True, slots=True)
class MeshPlaces:
    """Where the mesh files lie that a URDF names.

        NAME.stl, ../NAME.stl            from the URDF's folder
        file:///PLACE/NAME.stl           there
        package://PACKAGE/NAME.stl       in a package: a folder called PACKAGE, which is one of, or is in one
        model://PACKAGE/NAME.stl         of, those of `[robot] packages`, ROS_PACKAGE_PATH, share in those of
                                         AMENT_PREFIX_PATH, and the URDF's folder with all above it

    The first file that is there is taken.

    Args:
        folder: of the URDF.
        packages: further folders, from where the problem is.
        environment: with ROS_PACKAGE_PATH and AMENT_PREFIX_PATH.
    Source: wiki.ros.org/urdf/XML/link (mesh), REP 122 (layout of an installation).
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


HEAD = 100_000
"""Bytes in which a file says what is up."""


def says_y_up(path: Path) -> bool:
    """Whether a mesh file says that y is up."""
    if path.suffix.lower() != ".dae":
        return False
    with path.open("rb") as file:
        return b"Y_UP" in file.read(HEAD)


def stood_upright(tree: Tree, surfaces: Mapping[str, Surface], y_up: Collection[str]) -> dict[str, Surface]:
    """The surfaces of a robot's meshes, turned as far as its files ask for it and its masses agree.

    ROS and its viewers take coordinates as they stand, so that COLLADA's `<up_axis>` means nothing to most
    robots. To some it does: their meshes lie beside their links unless they are turned, v' = (x, -z, y).
    Which one holds for a robot is told by its centres of mass: those files are turned, all of them, if that
    halves the distances from the middles of the meshes.

    Args:
        tree: of the robot's URDF, with the file's inertias.
        surfaces: by the mesh's name in the URDF, in the coordinates of the files.
        y_up: names of those whose files say that y is up.
    Source: COLLADA 1.4.1, <up_axis>; pull request 24 of ros/robot_model and issue 1305 of gazebo-classic
        (what programs make of it).
    """
    turned = {name: _turned(surfaces[name]) for name in y_up}
    before, after = (sum(_distances(tree, found)) for found in ({n: surfaces[n] for n in y_up}, turned))
    return {**surfaces, **turned} if after < before / 2.0 else dict(surfaces)


def _turned(surface: Surface) -> Surface:
    x, y, z = surface.vertices.T
    return surface_of(np.stack([x, -z, y], axis=1), surface.faces, surface.volume)


def _distances(tree: Tree, surfaces: Mapping[str, Surface]) -> Iterator[float]:
    """From the centre of mass of each link to the middle of each of its meshes [m]."""
    for link in tree.links:
        for middle in _middles(link, surfaces) if link.inertia.mass > 0.0 else ():
            yield math.dist(middle, link.inertia.center)


def _middles(link: Link, surfaces: Mapping[str, Surface]) -> Iterator[list[float]]:
    for mesh in link.meshes:
        if mesh.file in surfaces:
            vertices = vertices_of(replace(mesh, surface=surfaces[mesh.file]))
            yield ((vertices.min(axis=0) + vertices.max(axis=0)) / 2.0).tolist()
