"""The meshes of a problem's robot: read beside the problem, and kept with it.

What a problem keeps of a mesh file is a text in `ProblemSource.files`, its few triangles and its volume
(`tree.surface`), so that a run needs no file outside of its directory. The text's name follows from the
mesh's name in the URDF; a file of that name beside the problem goes before the mesh file itself, so a copy of
a problem has the meshes of the problem.
"""

from __future__ import annotations

import hashlib
import os
import re
from collections import Counter
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path, PurePosixPath

from evodesign.errors import InputError, ModelError
from evodesign.problem.agent_tables import RobotTable
from evodesign.problem.mesh_places import MeshPlaces
from evodesign.problem.mesh_reading import few_triangles, read_mesh
from evodesign.problem.mesh_upright import says_y_up, stood_upright
from evodesign.tree.mjcf_read import TranslatedRobot
from evodesign.tree.model import Mesh, Tree
from evodesign.tree.surface import Surface, read_surface, surface_text
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
