"""Which links of a humanoid a design makes longer and how far, and the load that suits it, with heights."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

from evodesign.body.placement import Placement, Vector, add, dot, scale
from evodesign.collision.clearance import PlacedSolids, Places, SolidBodies, places_of
from evodesign.errors import ModelError
from evodesign.guess.body_plan import BodyPlan
from evodesign.guess.limbs import Limb
from evodesign.mechanics.agent import SIDES
from evodesign.mechanics.balance import GRAVITY
from evodesign.mechanics.payload import WRIST_MOMENT
from evodesign.tree.frames import link_frames
from evodesign.tree.model import JointKind, Tree
from evodesign.tree.resize import growth_of, resize
from evodesign.tree.welded import WeldedBody, WeldedTree

SHORTEST = 0.03
"""Length of a segment that is worth changing [m]."""

ALIGNED = 0.7
"""Cosine between a segment and the direction in which its link grows that makes it longer."""


BESIDE = 0.05
"""Lengths of a limb by which its shoulder is beside the other's."""


@dataclass(frozen=True, slots=True)
class Group:
    """Links that share a length multiplier; their length [m], or why there are none."""

    name: str
    links: tuple[str, ...]
    length: float
    why_not: str = ""


@dataclass(frozen=True, slots=True)
class LoadGuess:
    """A load's size [m] and mass [kg], and heights at which to hold it [m]."""

    size: tuple[float, float, float]
    mass: float
    heights: tuple[float, ...]

    @property
    def hand_moment(self) -> float:
        """Largest moment of a hand [N m]: with it either agent may carry three quarters of the load.

            m g (s - 1/2) depth / 4  = m g depth / 16        for a share s = 3/4, by four hands

        More than that would twist the load to hold up forearms, at no cost where wrists stand still.
        """
        sharing = self.mass * GRAVITY * self.size[0] / 16.0
        return min(math.ceil(10.0 * sharing) / 10.0, WRIST_MOMENT)


def groups(plan: BodyPlan) -> tuple[Group, ...]:
    """A group for each segment of the limbs and for the trunk."""
    found = []
    for limbs, names in ((plan.arms, ("upper_arm", "forearm")), (plan.legs, ("thigh", "shank"))):
        if limbs:
            found += [_segment(plan.welded, limbs, name, beyond=i == 1) for i, name in enumerate(names)]
    return (*found, _trunk(plan))


def _segment(welded: WeldedTree, limbs: Mapping[str, Limb], name: str, *, beyond: bool) -> Group:
    """The longest segment on this side of a limb's knee or elbow, or beyond it."""
    links, lengths = [], []
    for side in SIDES:
        limb = limbs[side]
        last = len(limb.bodies) - 1
        places = range(limb.bend, max(last, limb.bend + 1)) if beyond else range(limb.bend)
        ends = [*(body.origin for body in limb.bodies[1:]), limb.end.inertia.center]
        spans = {i: math.dist(limb.bodies[i].origin, ends[i]) for i in places}
        longest = max(spans, key=spans.__getitem__, default=None)
        if longest is None or spans[longest] < SHORTEST:
            return Group(name, (), 0.0, f"no segment of at least {SHORTEST * 100:g} cm")
        body, after = limb.bodies[longest], limb.bodies[longest + 1 :]
        joint = after[0].joint if after else None
        ends_in = welded.heaviest(body.links) if joint is None else joint.parent
        link = _link_of(welded, body, ends_in, ends[longest])
        if link is None:
            return Group(name, (), 0.0, f"no link of '{body.name}' grows towards the next joint")
        links.append(link)
        lengths.append(spans[longest])
    return Group(name, tuple(links), sum(lengths) / len(lengths))


def _link_of(welded: WeldedTree, body: WeldedBody, last: str, end: Vector) -> str | None:
    """The link of a body that makes the way to its end longer, which is in its link `last`."""
    candidates = [*_on_the_way(welded, body, last, end)]
    for link, way in sorted(candidates, key=lambda each: -math.sqrt(dot(each[1], each[1]))):
        if _grows_along(welded, link, way):
            return link
    return None


def _on_the_way(welded: WeldedTree, body: WeldedBody, last: str, end: Vector) -> Iterator[tuple[str, Vector]]:
    """Links with mass from where a joint is back to the body's first, with their ways in the root's axes."""
    link = last
    while True:
        start = welded.places[link].translation
        if welded.tree.link_by_name[link].inertia.mass:
            yield link, add(end, scale(-1.0, start))
        if link == body.name:
            return
        end, link = start, welded.tree.parent_joint[link].parent


def _grows_along(welded: WeldedTree, link: str, way: Vector) -> bool:
    try:
        growth = growth_of(welded.tree, link)
    except ModelError:
        return False
    rotation = welded.places[link].rotation
    axis = tuple(float(dot(row, growth.axis)) for row in rotation)
    length = math.sqrt(dot(way, way))
    return length > 0.0 and sum(a * b for a, b in zip(axis, way, strict=True)) / length > ALIGNED


def _trunk(plan: BodyPlan) -> Group:
    """The part of the trunk that carries the next one, or the shoulders, highest above its own joint."""
    if not plan.arms:
        return Group("trunk", (), 0.0, "no two arms")
    shoulders = [plan.arms[side].bodies[0] for side in SIDES]
    top = scale(0.5, add(shoulders[0].origin, shoulders[1].origin))
    ends = [*(body.origin for body in plan.trunk[1:]), top]
    nexts = [*plan.trunk[1:], shoulders[0]]
    hips = max(leg.bodies[0].origin[2] for leg in plan.legs.values())
    lows = [max(plan.trunk[0].origin[2], hips), *(body.origin[2] for body in plan.trunk[1:])]
    rises = [end[2] - low for low, end in zip(lows, ends, strict=True)]
    for i in sorted(range(len(rises)), key=lambda i: -rises[i]):
        if rises[i] < SHORTEST:
            break
        way: Vector = (0.0, 0.0, rises[i])
        joint = nexts[i].joint
        if joint is None or joint.parent not in plan.trunk[i].links:
            continue  # it hangs on the next one, where the root is the chest
        for link, own in _on_the_way(plan.welded, plan.trunk[i], joint.parent, ends[i]):
            rises_itself = link == plan.welded.tree.root or own[2] >= SHORTEST  # a root grows both ways
            if rises_itself and _grows_along(plan.welded, link, way):
                return Group("trunk", (link,), rises[i])
    return Group("trunk", (), 0.0, "no link of the trunk grows upwards")


def load_guess(plan: BodyPlan, ground: float) -> LoadGuess:
    """A box wider than the shoulders, of a tenth of the robot's mass, from the hips to the shoulders.

    Args:
        plan: without arms, hips stand for shoulders.
        ground: height of the soles in the root's frame [m].
    """
    arms = plan.arms or plan.legs
    shoulders = _beginnings(arms)
    hips = plan.legs["left"].bodies[0].origin[2] - ground
    top = shoulders[0][2] - ground
    arm = sum(math.dist(a.origin, b.origin) for a, b in itertools.pairwise(arms["left"].bodies))
    width = min(max(_rounded(1.4 * math.dist(*shoulders), 0.05), 0.2), 0.6)
    depth = 0.4 if arm > 0.5 else 0.25
    mass = sum(float(body.inertia.mass) for body in plan.welded.bodies.values())
    heights = tuple(dict.fromkeys(_rounded(hips + share * (top - hips), 0.05) for share in (0.0, 0.5, 1.0)))
    return LoadGuess((depth, width, 0.05), min(max(_rounded(0.1 * mass, 0.5), 1.0), 15.0), heights)


def _beginnings(limbs: Mapping[str, Limb]) -> tuple[Vector, Vector]:
    """The first joints of two limbs that are not both on the plane between them."""
    pairs = [*zip(*(limbs[side].points for side in SIDES), strict=False)]
    apart = BESIDE * min(limb.length for limb in limbs.values())
    return next((pair for pair in pairs if math.dist(*pair) > apart), pairs[-1])


def _rounded(value: float, step: float) -> float:
    return round(round(value / step) * step, 6)


LOWER, UPPER, STEP = 0.6, 1.6, 0.05
"""Bounds of length multipliers where nothing is in the way, and how finely others are found."""

NEAR = (2, 3)
"""Joints between two bodies that their build keeps clear of each other."""

DEEPEST = 0.003
"""Overlap of two bodies [m] that is a matter of their accuracy."""


@dataclass(frozen=True, slots=True)
class LengthBound:
    """A bound of a multiplier, and the two bodies that would overlap beyond it; none if none would."""

    multiplier: float
    overlap: tuple[str, str] | None = None


def length_bounds(tree: Tree, links: Sequence[str]) -> tuple[LengthBound, LengthBound]:
    """The lower and the upper bound of a length multiplier: no body comes into another that was clear of it.

        from 0.6 to 1.6, and nearer to 1 where in steps of 0.05 with all joints at zero two bodies overlap by
        more than 3 mm that are clear of each other in the robot as it is

    Counted are bodies with two or three joints between them: one joint joins its bodies, and what is farther
    away, as a hand from a thigh, is kept clear by the posture.

    Args:
        tree: the robot, unscaled.
        links: that share the multiplier; without any, or without shapes, both bounds are the farthest.
    """
    if not links or not SolidBodies.of_tree(tree).names:
        return LengthBound(LOWER), LengthBound(UPPER)
    clear = _clear(tree)
    return _bound(tree, links, clear, LOWER, -STEP), _bound(tree, links, clear, UPPER, STEP)


def _bound(tree: Tree, links: Sequence[str], clear: Places, farthest: float, step: float) -> LengthBound:
    """The last multiplier on the way from 1 with which nothing overlaps."""
    for number in range(1, round((farthest - 1.0) / step) + 1):
        resized = resize(tree, dict.fromkeys(links, 1.0 + number * step), {})
        if overlaps := _placed(resized).overlapping(clear, within=-DEEPEST):
            deepest = min(overlaps, key=lambda gap: gap.distance)
            return LengthBound(round(1.0 + (number - 1) * step, 2), (deepest.first, deepest.second))
    return LengthBound(farthest)


def _placed(tree: Tree) -> PlacedSolids:
    """The solids of a tree with all joints at zero."""
    return SolidBodies.of_tree(tree).placed(link_frames(tree, Placement(), {}))


def _clear(tree: Tree) -> Places:
    """Pairs of bodies that are near each other in the tree, and clear of each other."""
    placed = _placed(tree)
    names = tuple(dict.fromkeys(placed.names))
    near = [pair for pair in combinations(names, 2) if _joints_between(tree, *pair) in NEAR]
    touching = {(gap.first, gap.second) for gap in placed.overlapping(places_of(placed.names, near))}
    return places_of(placed.names, [pair for pair in near if pair not in touching])


def _joints_between(tree: Tree, first: str, second: str) -> int:
    """Joints, fixed ones aside, on the way from one link to another."""
    ways = [{link for link in tree.to_root(name) if link != tree.root} for name in (first, second)]
    return sum(tree.parent_joint[link].kind is not JointKind.FIXED for link in ways[0] ^ ways[1])
