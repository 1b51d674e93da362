"""Robots whose right side is, up to small known differences, the mirror image of the left one.

They are described in the root's frame and then written as a file would have them: frames turned at random,
axes of either sign, joints in any order, and names that say neither left nor right.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np

from evodesign.body.inertia import Inertia
from evodesign.body.placement import Placement
from evodesign.body.shape import Box, Cylinder, Solid
from evodesign.tree.model import Joint, JointKind, Link, Tree

FLIP = np.array([1.0, -1.0, 1.0])
AXES = {"x": np.array([1.0, 0.0, 0.0]), "y": np.array([0.0, 1.0, 0.0]), "z": np.array([0.0, 0.0, 1.0])}


@dataclass
class Part:
    """A link and the joint above it, in the root's frame at zero positions."""

    key: str
    parent: str
    place: np.ndarray
    axis: np.ndarray | None
    limits: tuple[float, float]
    mass: float
    center: np.ndarray
    tensor: np.ndarray
    solids: list[Solid] = field(default_factory=list)


@dataclass(frozen=True)
class Slack:
    """How far the right side may be from the left one's image: [m], [rad], [-]."""

    place: float = 0.0
    axis: float = 0.0
    limits: float = 0.0
    mass: float = 0.0
    center: float = 0.0
    inertia: float = 0.0


SMALL = Slack(
    place=8e-4, axis=math.radians(0.4), limits=math.radians(0.8), mass=0.015, center=8e-4, inertia=0.03
)


@dataclass(frozen=True)
class Robot:
    """A tree, the name of each part's joint (links are called the same), and each pair's own differences."""

    tree: Tree
    names: dict[str, str]
    partners: dict[str, str]
    placed: dict[str, float]
    weighed: dict[str, float]


LIMB = (("yaw", "z"), ("roll", "x"), ("pitch", "y"), ("bend", "y"), ("turn", "z"))


def matrix(rows: np.ndarray) -> tuple:
    return tuple(tuple(float(x) for x in row) for row in rows)


def random_rotation(rng: np.random.Generator) -> np.ndarray:
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return turn * np.sign(np.linalg.det(turn))


def tilted(rng: np.random.Generator, axis: np.ndarray, angle: float) -> np.ndarray:
    across = np.cross(axis, rng.normal(size=3))
    return math.cos(angle) * axis + math.sin(angle) * across / np.linalg.norm(across)


def parts_of(rng: np.random.Generator, *, solid: bool) -> list[Part]:
    """The root, a torso, a head, and the left limbs, whose first joints lie on the middle line."""
    parts = [part(rng, "root", "", np.zeros(3), None, middle=True, solid=solid)]
    parts.append(part(rng, "torso", "root", np.array([0.0, 0.0, 0.15]), AXES["z"], middle=True, solid=solid))
    parts.append(part(rng, "head", "torso", np.array([0.02, 0.0, 0.6]), AXES["y"], middle=True, solid=solid))
    for limb, parent, height, step in (("arm", "torso", 0.5, -0.11), ("leg", "root", -0.05, -0.16)):
        place, above = np.array([0.0, 0.0, height]), parent
        for number, (joint, axis) in enumerate(LIMB):
            key = f"{limb}_{joint}"
            parts.append(
                part(rng, key, above, place.copy(), AXES[axis], middle=False, solid=solid and number > 1)
            )
            if number == 0:  # a link without mass on the middle line, of which there are two
                parts[-1] = replace(parts[-1], mass=0.0, solids=[])
            place += np.array([rng.uniform(-0.02, 0.02), 0.08 if number < 3 else 0.01, step * (number > 0)])
            above = key
        parts.append(Part(f"{limb}_end", above, place, None, (0.0, 0.0), 0.0, place, np.zeros((3, 3))))
    return parts


def part(
    rng: np.random.Generator,
    key: str,
    parent: str,
    place: np.ndarray,
    axis: np.ndarray | None,
    *,
    middle: bool,
    solid: bool,
) -> Part:
    mass = rng.uniform(1.0, 4.0)
    center = place + rng.uniform(-0.05, 0.05, 3) + (0.0, 0.0, -0.05)
    points = rng.normal(size=(6, 3)) * (0.05, 0.04, 0.09)
    if middle:
        center[1] = 0.0
        points = np.concatenate([points, points * FLIP]) / math.sqrt(2.0)
    points = points - points.mean(axis=0)
    tensor = mass / len(points) * sum((d @ d) * np.eye(3) - np.outer(d, d) for d in points)
    low, high = -rng.uniform(0.5, 1.0), rng.uniform(1.0, 2.0)
    if middle and key == "torso":
        low = -high
    made = Part(key, parent, place, axis, (low, high), mass, center, tensor)
    if solid:
        turn = np.eye(3) if middle else tilted_frame(rng)
        box = Box(*(float(x) for x in rng.uniform(0.04, 0.07, 2)), 0.16)
        rod = Cylinder(0.02, 0.15)
        beside = np.array([0.0, 0.0, -0.01])
        made.solids = [
            Solid(box, Placement(matrix(turn), tuple(center.tolist())), mass / (box.volume + rod.volume))
        ]
        density = made.solids[0].density
        made.solids.append(
            Solid(rod, Placement(matrix(turn), tuple((center + turn @ beside).tolist())), density)
        )
    return made


def tilted_frame(rng: np.random.Generator) -> np.ndarray:
    """A rotation by up to 15 degrees."""
    angle, axis = rng.uniform(0.0, 0.25), rng.normal(size=3)
    x, y, z = axis / np.linalg.norm(axis)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + math.sin(angle) * cross + (1.0 - math.cos(angle)) * cross @ cross


def image(rng: np.random.Generator, part: Part, slack: Slack, moved: np.ndarray) -> Part:
    """The mirror image of a left part, with differences within the slack; a rotation's axis becomes -M a."""
    axis = None if part.axis is None else tilted(rng, -FLIP * part.axis, rng.uniform(0.3, 1.0) * slack.axis)
    low, high = (x + rng.uniform(-1.0, 1.0) * slack.limits for x in part.limits)
    shift = rng.normal(size=3)
    shift *= rng.uniform(0.3, 1.0) * slack.center / np.linalg.norm(shift)
    return Part(
        f"{part.key}'",
        part.parent if part.parent in {"root", "torso"} else f"{part.parent}'",
        FLIP * part.place + moved,
        axis,
        (low, high),
        part.mass * (1.0 + rng.uniform(-1.0, 1.0) * slack.mass),
        FLIP * part.center + shift,
        np.outer(FLIP, FLIP) * part.tensor * (1.0 + rng.uniform(0.0, 1.0) * slack.inertia),
        [turned_over(rng, solid) for solid in part.solids],
    )


def turned_over(rng: np.random.Generator, solid: Solid) -> Solid:
    """The mirror image of a solid as another drawing would have it: a box's sides in another order."""
    place, shape = solid.link_from_solid.mirrored(), solid.shape
    rows = np.array(place.rotation)
    if isinstance(shape, Box):
        rows, shape = rows[:, [1, 2, 0]], Box(shape.y, shape.z, shape.x)
    else:
        angle = rng.uniform(0.0, 6.0)
        spin = np.array(
            [[math.cos(angle), -math.sin(angle), 0], [math.sin(angle), math.cos(angle), 0], [0, 0, 1]]
        )
        rows = rows @ spin @ np.diag([1.0, -1.0, -1.0])
    return Solid(shape, Placement(matrix(rows), place.translation), solid.density)


def robot(seed: int, slack: Slack = SMALL, *, solid: bool = False, slid: bool = False) -> Robot:
    """A robot of its own for every seed."""
    rng = np.random.default_rng(seed)
    left = parts_of(rng, solid=solid)
    everything, placed, weighed = list(left), {}, {}
    for one in left:
        if one.key in {"root", "torso", "head"}:
            continue
        moved = rng.normal(size=3)
        moved *= rng.uniform(0.3, 1.0) * slack.place / np.linalg.norm(moved)
        other = image(rng, one, slack, moved)
        everything.append(other)
        direction = other.axis if other.axis is not None else np.zeros(3)
        placed[one.key] = float(np.linalg.norm(moved - (moved @ direction) * direction))
        if one.mass > 0.0:
            weighed[one.key] = abs(other.mass - one.mass) / ((other.mass + one.mass) / 2.0)
        if slid and other.axis is not None:
            other.place = other.place + rng.uniform(-0.03, 0.03) * other.axis
    partners = {one.key: f"{one.key}'" for one in left}
    partners |= dict.fromkeys(["root", "torso", "head"], "")
    partners = {one: other or one for one, other in partners.items()}
    names = {
        one.key: f"p{number}"
        for number, one in enumerate(rng.permutation(np.array(everything, dtype=object)))
    }
    return Robot(written(rng, everything, names), names, partners, placed, weighed)


def written(rng: np.random.Generator, parts: list[Part], names: dict[str, str]) -> Tree:
    """The parts as a file's tree: turned frames, axes of either sign, in any order."""
    frames = {}
    for one in parts:
        turn = (
            np.eye(3)
            if one.key == "root" or one.key.startswith(("arm_end", "leg_end"))
            else random_rotation(rng)
        )
        frames[one.key] = Placement(matrix(turn), tuple(one.place.tolist()))
    links, joints = [], []
    for one in parts:
        back = inverse(frames[one.key])
        inertia = Inertia(one.mass, tuple(one.center.tolist()), matrix(one.tensor)).moved(back)
        solids = tuple(replace(s, link_from_solid=back @ s.link_from_solid) for s in one.solids)
        if one.solids:
            share = one.mass / sum(s.mass for s in one.solids)
            solids = tuple(replace(s, density=s.density * share) for s in solids)
            links.append(Link(names[one.key], solids=solids))
        else:
            links.append(Link(names[one.key], own_inertia=inertia if one.mass else Inertia()))
        if one.key == "root":
            continue
        place = inverse(frames[one.parent]) @ frames[one.key]
        kind, axis, limits = JointKind.FIXED, np.array([1.0, 0.0, 0.0]), (0.0, 0.0)
        if one.axis is not None:
            kind, turn = JointKind.REVOLUTE, rng.choice([1.0, -1.0])
            axis = turn * np.array(frames[one.key].rotation).T @ one.axis
            limits = one.limits if turn > 0 else (-one.limits[1], -one.limits[0])
        joints.append(
            Joint(
                names[one.key],
                kind,
                names[one.parent],
                names[one.key],
                place,
                tuple(axis.tolist()),
                *limits,
                effort=float(rng.choice([50.0, 60.0])),
            )
        )
    order, others = rng.permutation(len(joints)), rng.permutation(len(links))
    return Tree("generated", tuple(links[k] for k in others), tuple(joints[k] for k in order))


def inverse(frame: Placement) -> Placement:
    turn = np.array(frame.rotation).T
    return Placement(matrix(turn), tuple((-turn @ np.array(frame.translation)).tolist()))
