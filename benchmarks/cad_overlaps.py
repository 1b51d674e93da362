"""Whether parts of a front's robots pass through each other, on the CAD files that they are exported as.

    python -m benchmarks.cad_overlaps RUN [RUN ...] [--designs N]

`assembly.step` is read by cascadio and trimesh; coal finds how far the hull of each motor's housing is from
those of all other housings and links, all joints at zero. Exempt are a motor and the link that it sits in,
and links that a joint of `robot.urdf` joins to that one; links that fixed joints join are one. Nothing of
`evodesign.collision` is used.

Told for each run: designs, pairs, and the deepest overlap. Parts are convex but for bores and flanges of
seats, which lie within the outer surface of their link. So overlaps with hulls are at least those with parts,
but for the chords of round faces, which lie within by 0.05 mm at most.
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from itertools import combinations
from pathlib import Path
from typing import Any

import cascadio
import coal
import numpy as np
import trimesh
from lxml import etree
from scipy.spatial import ConvexHull

from evodesign.api.run import Run, open_run

MOTOR = "motor_"
CHORD_MM, ANGLE = 0.05, 0.15


def main() -> None:
    """Print the deepest overlap of each run."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("runs", nargs="+", type=Path)
    parser.add_argument("--designs", type=int, help="of the front, evenly spread; without it, all")
    given = parser.parse_args()
    for path in given.runs:
        run = open_run(path)
        numbers = sorted(design.number for design in run.choose())
        count = len(numbers) if given.designs is None else min(given.designs, len(numbers))
        chosen = [numbers[place] for place in np.linspace(0, len(numbers) - 1, count).round().astype(int)]
        found = [(*pair, number) for number in chosen for pair in distances(run, number)]
        if not found:
            raise SystemExit(f"wanted a run whose designs have motors, found {path}")
        apart, first, second, number = min(found)
        print(
            f"{path}: {count} designs, {len(found)} pairs, least distance {1e3 * apart:.2f} mm "
            f"({first} and {second} of design {number}), "
            f"{sum(each[0] < -1e-3 for each in found)} pairs deeper than 1 mm"
        )


def distances(run: Run, number: int) -> Iterator[tuple[float, str, str]]:
    """How far two parts are apart [m], negative where they overlap, and their names."""
    with tempfile.TemporaryDirectory() as place:
        run.design(number).export(Path(place) / "design", cad=True)
        step = Path(place) / "design" / "cad" / "assembly.step"
        glb = Path(place) / "assembly.glb"
        cascadio.step_to_glb(str(step), str(glb), CHORD_MM, ANGLE)
        scene = trimesh.load(glb)
        joints = list(etree.parse(Path(place) / "design" / "robot.urdf").getroot().iter("joint"))
    parts = {name: _hull(scene, name) for name in scene.graph.nodes_geometry if not name.startswith("axis_")}
    ends = [(joint.find("parent").get("link"), joint.find("child").get("link")) for joint in joints]
    fixed = [pair for joint, pair in zip(joints, ends, strict=True) if joint.get("type") == "fixed"]
    body = _rigid(fixed, {link for pair in ends for link in pair})
    holder = {joint.get("name"): body[pair[0]] for joint, pair in zip(joints, ends, strict=True)}
    joined = {frozenset((body[one], body[other])) for one, other in ends}
    same = {frozenset((each,)) for each in body.values()}
    for first, second in combinations(sorted(parts), 2):
        if not first.startswith(MOTOR):
            first, second = second, first
        if not first.startswith(MOTOR):
            continue
        own = holder[first.removeprefix(MOTOR)]
        if not second.startswith(MOTOR) and frozenset((own, body[second])) in joined | same:
            continue
        result = coal.DistanceResult()
        yield coal.distance(*parts[first], *parts[second], coal.DistanceRequest(), result), first, second


def _rigid(fixed: Sequence[tuple[str, str]], links: Iterable[str]) -> dict[str, str]:
    """The first link of the rigid body of each link, by name: links that fixed joints join are one body."""
    first = {link: link for link in links}
    for one, other in fixed:
        kept, gone = first[one], first[other]
        first = {link: kept if body == gone else body for link, body in first.items()}
    return first


def _hull(scene: Any, name: str) -> tuple[Any, Any]:
    """The hull of a part, and its place."""
    place, geometry = scene.graph[name]
    corners = scene.geometry[geometry].vertices
    points = corners[ConvexHull(corners).vertices] @ place[:3, :3].T + place[:3, 3]
    cloud = coal.StdVec_Vec3s()
    cloud.extend(list(points))
    return coal.Convex.convexHull(cloud, True, "Qt"), coal.Transform3s()


if __name__ == "__main__":
    main()
