"""Whether bodies pass through each other on a run's front, by code that shares nothing with the check.

    python -m benchmarks.independent_overlaps RUN [RUN ...] [--designs N]

Robot and people come from the URDF files that a design is exported as; pinocchio places their solids at the
logged joint positions, and coal says of each pair whether they meet: a mesh by its triangles, never by a hull
(where no triangles cross, the winding number of a vertex says whether one mesh is within the other). Two
simple shapes are as deep in each other as coal finds. A mesh is as deep in another body as it has to be moved
until nothing meets, along the best of 26 directions and the line of centres: never less than the true depth.

Exempt are two links joined by one joint, or fixed to such; pairs that overlap in the unscaled robot at its
zero posture or in more than half of 400 random postures, and likewise in a person; and the load against links
within three joints of the grasp. No list, exemption or tolerance of `evodesign.collision` is used.

Told for each run: postures, the deepest overlap, and the pairs deeper than 3 mm.
Written to benchmarks/results/independent_overlaps.json, printed as a table.
"""

from __future__ import annotations

import argparse
import json
import tempfile
from collections import Counter
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import combinations, product
from pathlib import Path
from typing import Any

import coal
import numpy as np
import pinocchio as pin

from evodesign.analysis.front import front
from evodesign.mechanics.agent import ROBOT, Agent
from evodesign.records import CaseDetail
from evodesign.report.opened_design import RebuiltProblem
from evodesign.runlog.run import read_run
from evodesign.tree.mesh_write import mesh_files
from evodesign.tree.urdf_write import urdf_text

RESULTS = Path(__file__).parent / "results" / "independent_overlaps.json"
DEEP = 0.003  # [m]
RANDOM = 400
TURN = np.pi  # [rad], of a joint without limits
FINGERS = 3  # joints between a hand's frame and what may touch the load

WAYS = np.array([way for way in product((-1.0, 0.0, 1.0), repeat=3) if any(way)])
WAYS /= np.linalg.norm(WAYS, axis=1, keepdims=True)
FARTHEST, FINE, TINY = 0.3, 1e-4, 1e-12  # [m]

Pair = tuple[str, str]
Placed = tuple[Any, Any]


@dataclass
class Body:
    """Solids of a URDF, as pinocchio and coal see them.

    Args:
        text: of the URDF.
        folder: of its meshes.
    """

    text: str
    folder: Path

    def __post_init__(self) -> None:
        path = self.folder / "body.urdf"
        path.write_text(self.text)
        self.model = pin.buildModelFromUrdf(str(path), pin.JointModelFreeFlyer())
        self.data = self.model.createData()
        self.geometry = pin.buildGeomFromUrdf(
            self.model, str(path), pin.GeometryType.VISUAL, str(self.folder)
        )
        self.places = self.geometry.createData()
        frames = self.model.frames
        self.links = [frames[each.parentFrame].name for each in self.geometry.geometryObjects]
        self.moved_by = {f.name: f.parentJoint for f in frames if f.type == pin.FrameType.BODY}
        self.above = {
            f.name: frames[frames[f.parentFrame].parentFrame].name
            for f in frames
            if f.type == pin.FrameType.BODY and f.parentFrame
        }

    def placed(self, joints: Mapping[str, float], base: pin.SE3) -> list[tuple[str, Any, Any]]:
        """Each solid with its link and its place in the world."""
        q = pin.neutral(self.model)
        q[:7] = pin.SE3ToXYZQUAT(base)
        for name, value in joints.items():
            joint = self.model.joints[self.model.getJointId(name)]
            turned = [np.cos(value), np.sin(value)] if joint.nq == 2 else [value]
            q[joint.idx_q : joint.idx_q + joint.nq] = turned
        pin.updateGeometryPlacements(self.model, self.data, self.geometry, self.places, q)
        return [
            (link, each.geometry, coal.Transform3s(where.rotation, where.translation))
            for link, each, where in zip(
                self.links, self.geometry.geometryObjects, self.places.oMg, strict=True
            )
        ]

    def exempt(self, joints: Sequence[str], limits: Mapping[str, tuple[float, float]]) -> frozenset[Pair]:
        """Pairs of its links that may overlap."""
        links = [*dict.fromkeys(self.links)]
        parents, own = self.model.parents, self.moved_by
        joined = {
            pair
            for pair in combinations(links, 2)
            if own[pair[0]] in (own[pair[1]], parents[own[pair[1]]]) or own[pair[1]] == parents[own[pair[0]]]
        }
        zero = self._deep({}, joined)
        rng, counts = np.random.default_rng(1), Counter[Pair]()
        for _ in range(RANDOM):
            drawn = {name: rng.uniform(*limits[name]) for name in joints}
            counts.update(self._deep(drawn, joined))
        return frozenset(joined) | zero | {pair for pair, count in counts.items() if 2 * count > RANDOM}

    def _deep(self, joints: Mapping[str, float], joined: set[Pair]) -> set[Pair]:
        return {*overlaps(self.placed(joints, pin.SE3.Identity()), None, joined, _overlap)}

    def limits(self, joints: Sequence[str]) -> dict[str, tuple[float, float]]:
        """Of joints, where they have any."""
        found = {}
        for name in joints:
            joint = self.model.joints[self.model.getJointId(name)]
            low = self.model.lowerPositionLimit[joint.idx_q] if joint.nq == 1 else -TURN
            high = self.model.upperPositionLimit[joint.idx_q] if joint.nq == 1 else TURN
            found[name] = (max(low, -TURN), min(high, TURN))
        return found


def overlaps(
    one: Sequence[tuple[str, Any, Any]],
    other: Sequence[tuple[str, Any, Any]] | None,
    exempt: Collection[Pair] = (),
    measure: Callable[[Placed, Placed], float] | None = None,
) -> dict[Pair, float]:
    """Depth [m] of overlaps among solids, or of one with another set, by links.

    Args:
        one: solids.
        other: solids as well; None for the pairs among the one's.
        exempt: pairs of links that may overlap.
        measure: how deep two solids are in each other; `_depth` if left out.
    """
    found: dict[Pair, float] = {}
    pairs = combinations(one, 2) if other is None else ((a, b) for a in one for b in other)
    boxes = {id(each): _box(each) for each in [*one, *(other or ())]}
    for first, second in pairs:
        (low, high), (low_2, high_2) = boxes[id(first)], boxes[id(second)]
        key = (first[0], second[0])
        if (first[0] == second[0] and other is None) or np.any(low > high_2) or np.any(low_2 > high):
            continue
        depth = 0.0 if key in exempt else (measure or _depth)(first[1:], second[1:])
        if depth > 0.0:
            found[key] = max(depth, found.get(key, 0.0))
    return found


def _depth(one: Placed, other: Placed) -> float:
    """How deep two solids are in each other [m]; nothing where they are apart."""
    if not (_is_mesh(one) or _is_mesh(other)):
        return max(-float(coal.distance(*one, *other, coal.DistanceRequest(), coal.DistanceResult())), 0.0)
    if not _overlap(one, other):
        return 0.0
    centres = [geometry.aabb_center for geometry, _ in (one, other)]
    between = other[1].transform(centres[1]) - one[1].transform(centres[0])
    ways = np.array([*WAYS, between / max(float(np.linalg.norm(between)), TINY)])
    return min(_shift(one, other, way) for way in (*ways, -ways[-1]))


def _shift(one: Placed, other: Placed, way: Any) -> float:
    """How far the other one has to be moved along a unit vector until it is outside of the one [m]."""
    low, high = 0.0, FARTHEST
    while high - low > FINE:
        half = 0.5 * (low + high)
        moved = other[0], coal.Transform3s(other[1].getRotation(), other[1].getTranslation() + half * way)
        low, high = (half, high) if _overlap(one, moved) else (low, half)
    return high


def _overlap(one: Placed, other: Placed) -> bool:
    return _meet(one, other) or _is_within(one, other) or _is_within(other, one)


def _meet(one: Placed, other: Placed) -> bool:
    """Whether surfaces, or a surface and a simple shape, have a point in common."""
    return bool(coal.collide(*one, *other, coal.CollisionRequest(), coal.CollisionResult()))


def _is_mesh(solid: Placed) -> bool:
    return isinstance(solid[0], coal.BVHModelBase)


def _is_within(one: Placed, other: Placed) -> bool:
    """Whether a vertex or the centre of one solid is within another, a mesh: by its winding number.

    Source: the solid angle of a triangle: van Oosterom and Strackee (1983).
    """
    if not _is_mesh(other):
        return False  # simple shapes are solid for coal
    geometry, place = one
    point = np.array(geometry.vertex(0) if _is_mesh(one) else geometry.aabb_center)
    local = other[1].getRotation().T @ (place.transform(point) - other[1].getTranslation())
    corners = _corners(other[0])
    if np.any(local < corners.min(axis=(0, 1))) or np.any(local > corners.max(axis=(0, 1))):
        return False
    a, b, c = np.moveaxis(corners - local, 1, 0)
    lengths = [np.linalg.norm(each, axis=1) for each in (a, b, c)]
    above = np.einsum("ij,ij->i", a, np.cross(b, c))
    below = np.prod(lengths, axis=0) + sum(
        np.einsum("ij,ij->i", u, v) * length
        for u, v, length in ((a, b, lengths[2]), (b, c, lengths[0]), (c, a, lengths[1]))
    )
    return bool(abs(np.arctan2(above, below).sum()) > np.pi)  # half of 4 pi, of half angles


@cache
def _corners(mesh: Any) -> Any:
    """Those of a mesh's triangles, shape (n, 3, 3)."""
    vertices = np.array(mesh.vertices())
    faces = [mesh.tri_indices(place) for place in range(mesh.num_tris)]
    return vertices[np.array([[face[k] for k in range(3)] for face in faces])]


def _box(solid: tuple[str, Any, Any]) -> tuple[Any, Any]:
    """Corners of an axis-aligned box about the turned box of a solid's own axes."""
    _, geometry, where = solid
    geometry.computeLocalAABB()
    low, high = geometry.aabb_local.min_, geometry.aabb_local.max_
    turn = where.getRotation()
    centre = turn @ (low + high) / 2.0 + where.getTranslation()
    half = np.abs(turn) @ (high - low) / 2.0
    return centre - half, centre + half


class Judge:
    """All postures of a run's front."""

    def __init__(self, run: Path, folder: Path) -> None:
        self.log = read_run(run)
        self.problem = RebuiltProblem(self.log.header).problem
        self.folder = folder
        self.built: dict[str, Body] = {}
        self.exempt: dict[str, Collection[Pair]] = {}
        for agent in (agent for scene in self.problem.scenes for agent in scene.agents):
            label = _label(agent)
            if label not in self.exempt:
                names, meshes = mesh_files(agent.tree, "meshes")
                self._write(meshes)
                self.built[label] = Body(urdf_text(agent.tree, names), folder)
                limits = self.built[label].limits(agent.joints)
                self.exempt[label] = self.built[label].exempt(agent.joints, limits)

    def _write(self, files: Mapping[str, bytes]) -> None:
        for name, content in files.items():
            (self.folder / name).parent.mkdir(parents=True, exist_ok=True)
            (self.folder / name).write_bytes(content)

    def designs(self, most: int | None) -> Iterator[tuple[int, Any, Sequence[CaseDetail]]]:
        """Number, robot and postures of designs of the front."""
        logged = {detail.evaluation: detail.cases for detail in self.log.details}
        found = front(self.log.header.objectives, self.log.evaluations)
        for evaluation in found[:: max(1, len(found) // most)] if most else found:
            assessment, space = evaluation.assessment, self.problem.space
            values = space.given(
                [assessment.design[p.name] for p in space.parameters], assessment.rated_torques
            )
            tree = space.resized(self.problem.scene.designed_tree, values)
            names, meshes = mesh_files(tree, "meshes")
            self._write(meshes)
            yield evaluation.number, Body(urdf_text(tree, names), self.folder), logged[evaluation.number]

    def deep(self, robot: Body, case: CaseDetail) -> dict[Pair, float]:
        """Overlaps in a posture, by names."""
        scene = self.problem.scene_of(case.case)
        placed, found = {}, dict[Pair, float]()
        box = coal.Box(*scene.payload.size)
        load = [("load", box, coal.Transform3s(np.eye(3), np.array([0.0, 0.0, case.height_m])))]
        for agent in scene.agents:
            posture, label = case.agents[agent.name], _label(agent)
            body = robot if agent.designed else self.built[label]
            own = pin.SE3(pin.rpy.rpyToMatrix(*posture.base_rpy_rad), np.array(posture.base_position_m))
            world = pin.SE3(pin.rpy.rpyToMatrix(0.0, 0.0, agent.quarters * np.pi / 2.0), np.zeros(3)) * own
            solids = placed[agent.name] = body.placed(posture.joints_rad, world)
            for pair, depth in overlaps(solids, None, self.exempt[label]).items():
                found[f"{agent.name} {pair[0]}", pair[1]] = depth
            hands = {link for hand in agent.hand_frames for link in _up(body.above, hand)}
            for (link, _), depth in overlaps(solids, load).items():
                if not any(near in hands for near in _up(body.above, link)):
                    found[f"{agent.name} {link}", "load"] = depth
        for one, other in combinations(placed, 2):
            for pair, depth in overlaps(placed[one], placed[other]).items():
                found[f"{one} {pair[0]}", f"{other} {pair[1]}"] = depth
        return found


def _label(agent: Agent) -> str:
    """Whose body it is: robots of the design have one."""
    return ROBOT if agent.designed else agent.label or agent.name


def _up(above: Mapping[str, str], link: str) -> list[str]:
    found = [link]
    while len(found) <= FINGERS and found[-1] in above:
        found.append(above[found[-1]])
    return found


def judged(run: Path, most: int | None) -> dict[str, Any]:
    """What is found on a run's front."""
    with tempfile.TemporaryDirectory() as folder:
        judge = Judge(run, Path(folder))
        postures, deepest, pairs, robots = 0, 0.0, dict[str, float](), set[int]()
        designs = [*judge.designs(most)]
        for number, robot, cases in designs:
            for case in cases:
                for moment in case.few_moments:
                    postures += 1
                    for pair, depth in judge.deep(robot, moment).items():
                        deepest = max(deepest, depth)
                        if depth > DEEP:
                            robots.add(number)
                            name = " / ".join(pair)
                            pairs[name] = max(pairs.get(name, 0.0), depth)
    return {
        "problem": judge.log.header.problem_name,
        "seed": judge.log.header.search.seed,
        "evaluations": len(judge.log.evaluations),
        "designs": len(designs),
        "postures": postures,
        "deepest_mm": 1e3 * deepest,
        "designs_deeper_than_3_mm": len(robots),
        "pairs_mm": {name: 1e3 * depth for name, depth in sorted(pairs.items(), key=lambda each: -each[1])},
    }


def main() -> None:
    """Judge runs."""
    parser = argparse.ArgumentParser(description="overlaps on the fronts of runs, by independent code")
    parser.add_argument("runs", nargs="+", type=Path)
    parser.add_argument("--designs", type=int, default=None)
    options = parser.parse_args()
    found = [judged(run, options.designs) for run in options.runs]
    RESULTS.write_text(json.dumps(found, indent=1) + "\n")
    for each in found:
        front = f"{each['postures']} postures of {each['designs']} designs"
        deep = f"deepest {each['deepest_mm']:.2f} mm, {each['designs_deeper_than_3_mm']} deeper than 3 mm"
        print(f"{each['problem']}, seed {each['seed']}: {front}, {deep}")
        for name, depth in each["pairs_mm"].items():
            print(f"  {depth:6.1f} mm  {name}")


if __name__ == "__main__":
    main()
