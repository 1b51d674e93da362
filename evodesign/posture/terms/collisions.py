"""Bodies that keep clear of each other: no link passes through another, the load, the floor or the partner.

Two convex bodies with centres c_1, c_2 and supports s_1, s_2 (`collision.shapes`) are a margin m apart if and
only if some unit vector n parts them:

    n . (c_2 - c_1) - s_1(n) - s_2(-n) >= m

Any direction makes a row that is safe; the best one makes it exact. It is held in the axes of one of the two
links during a solve, n = A_1 a + A_2 b with one of a and b zero: that which parts the bodies best where the
solve begins (`posture.parting`). If another one does where it ends, the solve goes on from there with that
one, which can only better it. So rows are signed and smooth, cannot be tunnelled, and need no more unknowns.
Where a plane does, nothing is chosen: the floor; the plane half-way between two agents, on whose own side
each stays; and in symmetric postures the middle plane, between a link and its mirror image.

From a poor start such rows lead to poor optima: a head stays on the wrong side of the load. So those with a
direction are off at first, by 10 m added to them; where a solution overlaps, its rows are switched on, and
the solve goes on from there. Where shapes are narrower than the true bodies, their rows ask for more.

Corners of the supports are rounded off outwards, |x| <= sqrt(x^2 + e^2), so a posture that fulfils the rows
is one in which the bodies are apart.

Source: separating hyperplanes: Boyd and Vandenberghe, Convex Optimization, section 2.5.1; which directions
part boxes: Gottschalk, Lin and Manocha, OBBTree (1996). The residual is coal's.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from enum import Enum, auto

import casadi as ca
import numpy as np

from evodesign.body.placement import Placement
from evodesign.collision.rules import FLOOR, LOAD, PLANES, BodyPair, partner_side
from evodesign.collision.supports import ConvexShape, shapes_of
from evodesign.mechanics.scene import Scene
from evodesign.posture.limit_groups import LimitGroup
from evodesign.posture.placed_shape import PlacedShape, Plane, placed_shape
from evodesign.posture.symmetry import Form
from evodesign.posture.terms.base import (
    UNDISTURBED,
    Body,
    BodyTerm,
    Bound,
    Held,
    MeasuredSystem,
    Residual,
    Row,
    SystemTerm,
)
from evodesign.tree.kinematics import Expression, Pose, pose_from
from evodesign.tree.mirror_pairs import Mirror
from evodesign.tree.model import Tree

PARTING, NUMBERS = "parting", 8
"""What an agent holds of the directions that part its bodies: on, a and b of each, and how much more than the
margin [m] its rows ask for, where the true bodies are wider than their shapes in programs."""

CLEAR = "clear"
"""Rows along directions."""

OFF = 10.0
"""What a row that is switched off has added to it [m], or is in its place."""


class MeetingKind(Enum):
    """How two bodies are kept apart."""

    DIRECTION = auto()
    MIDDLE = auto()
    PLANE = auto()


@dataclass(frozen=True, slots=True)
class Meeting:
    """Two bodies of a form that keep clear of each other.

    Args:
        kind: how.
        first: a link of the form.
        second: another one, the load or a plane; for `MIDDLE` the first again.
        mirrored: whether the mirror image of the second is meant.
    """

    kind: MeetingKind
    first: str
    second: str
    mirrored: bool = False

    def label(self, form: Form) -> str:
        """The names of both bodies, a mirror image by its own."""
        twins = form.mirror.links if form.mirror and self.mirrored else {}
        return f"{self.first} and {twins.get(self.second, self.second)}"


def meetings(form: Form) -> tuple[Meeting, ...]:
    """The meetings of a form, once each: of mirror images one stands for both."""
    rules = form.agent.collisions
    if rules is None:
        return ()
    kept = form.part(form.agent.tree)[0].link_by_name
    parted = (pair for pair in rules.parted if rules.margin_of(pair) > -np.inf)
    return tuple(dict.fromkeys(_meeting(form.mirror, kept, pair) for pair in parted))


def _meeting(mirror: Mirror | None, kept: Collection[str], pair: BodyPair) -> Meeting:
    first, second = pair
    if mirror is None:
        return Meeting(MeetingKind.PLANE if second in PLANES else MeetingKind.DIRECTION, first, second)
    if second == LOAD or second in PLANES:
        first = first if first in kept else mirror.links[first]
        return Meeting(MeetingKind.PLANE if second in PLANES else MeetingKind.DIRECTION, first, second)
    if first not in kept:
        first, second = mirror.links[first], mirror.links[second]
    if second in kept:
        return Meeting(MeetingKind.DIRECTION, first, second)
    if mirror.links[first] == first:  # on the middle line
        return Meeting(MeetingKind.DIRECTION, first, mirror.links[second])
    if mirror.links[second] == first:
        return Meeting(MeetingKind.MIDDLE, first, first, True)
    one, other = sorted((first, mirror.links[second]))  # mirror images of this pair are another name of it
    return Meeting(MeetingKind.DIRECTION, one, other, True)


def meeting_of(form: Form, pair: BodyPair) -> Meeting:
    """The meeting of a pair of bodies in a form."""
    return _meeting(form.mirror, form.part(form.agent.tree)[0].link_by_name, pair)


def margin_of(form: Form, meeting: Meeting) -> float:
    """How far the two of a meeting are asked to be apart [m]."""
    rules, images = form.agent.collisions, form.mirror.links if form.mirror else {}
    second = images[meeting.second] if meeting.mirrored else meeting.second
    return 0.0 if rules is None else rules.margin_of((meeting.first, second))


def directed(form: Form) -> tuple[Meeting, ...]:
    """Those that have a direction."""
    return tuple(meeting for meeting in meetings(form) if meeting.kind is MeetingKind.DIRECTION)


def placed_pairs(body: Body, meeting: Meeting) -> list[tuple[PlacedShape, PlacedShape]]:
    """Every shape of the first with every shape of the second.

    Two links are placed in the frame of the nearest one that carries both, so that they move with the joints
    between them alone. Where that one is the root, they are placed in the world, where poses are known.
    """
    if meeting.second == LOAD:
        return [(one, _load(body)) for one in _placed(body, meeting.first)]
    tree, links = body.part, body.form.mirror.links if body.form.mirror and meeting.mirrored else {}
    others = tree.to_root(meeting.second)
    both = [name for name in tree.to_root(meeting.first) if name in others]
    above = next(name for name in both if links.get(name, name) == name)
    first, second = (
        _shapes_at(body, link, _pose_above(body, above, link)) for link in (meeting.first, meeting.second)
    )
    if meeting.mirrored:
        plane = _middle_plane(tree, above)
        second = [each.mirrored(plane) for each in second]
    return [(one, other) for one in first for other in second]


def _pose_above(body: Body, above: str, link: str) -> Pose:
    """Of a link in the frame of one that carries it; in the world where that is the root."""
    if above == body.part.root:
        return body.poses[link]
    positions = {name: body.values["joints"][place] for place, name in enumerate(body.form.joints)}
    return pose_from(body.part, above, link, positions)


def _middle_plane(tree: Tree, link: str) -> Plane:
    """The middle plane of an agent that is its own mirror image, as `_pose_above` places its bodies.

    What carries the link turns about axes across the plane, so that this does not depend on how it stands.
    """
    pose = pose_from(tree, tree.root, link, {})
    return ca.DM(pose.rotation[1, :]).T, pose.position[1]


def _placed(body: Body, link: str) -> list[PlacedShape]:
    return _shapes_at(body, link, body.poses[link])


def _shapes_at(body: Body, link: str, pose: Pose) -> list[PlacedShape]:
    return [placed_shape(shape, pose) for shape in shapes_of(body.part.link_by_name[link])]


def _sides(body: Body, plane: str) -> list[Expression]:
    """Directions towards the other side of the floor, or of the plane before each partner."""
    if plane == FLOOR:
        return [ca.DM([0.0, 0.0, -1.0])]
    agent, size = body.agent, body.scene.payload.faced(body.agent)
    turns = [each.quarters - agent.quarters for each in body.scene.agents if each.name != agent.name]
    return [ca.DM(partner_side(size, turn)) for turn in turns]


def _load(body: Body) -> PlacedShape:
    depth, width, height = body.scene.payload.faced(body.agent)
    box = ConvexShape(Placement(), (depth / 2.0, width / 2.0, height / 2.0))
    return placed_shape(box, Pose(ca.SX.eye(3), ca.vertcat(0.0, 0.0, body.load_height)))


def held(form: Form, scene: Scene) -> Iterator[Held]:
    """What parts the bodies of each meeting that needs a direction."""
    count = len(directed(form))
    if count:
        yield Held(PARTING, NUMBERS * count)


def rows(body: Body) -> Iterator[Row]:
    """Distances [m]."""
    rules = body.agent.collisions
    if rules is None:
        return
    found: dict[MeetingKind, list[tuple[str, Expression, float]]] = {kind: [] for kind in MeetingKind}
    left = ca.DM([0.0, 1.0, 0.0])
    parted = directed(body.form)
    for meeting in meetings(body.form):
        margin = margin_of(body.form, meeting)
        spare = rules.margin - margin
        if meeting.kind is MeetingKind.PLANE:
            for away in _sides(body, meeting.second):
                for shape in _placed(body, meeting.first):
                    found[MeetingKind.PLANE].append(
                        (
                            meeting.label(body.form),
                            -ca.dot(away, shape.centre) - shape.support(away),
                            rules.margin,
                        )
                    )
        elif meeting.kind is MeetingKind.MIDDLE:
            for shape in _placed(body, meeting.first):
                apart = 2.0 * (shape.centre[1] - shape.support(left)) + spare
                found[MeetingKind.MIDDLE].append((meeting.label(body.form), apart, margin))
        elif PARTING in body.values:
            place = NUMBERS * parted.index(meeting)
            numbers, pairs = body.values[PARTING][place : place + NUMBERS], placed_pairs(body, meeting)
            for one, other in pairs:
                apart = one.apart_along(other, numbers) + OFF * (1.0 - numbers[0]) + spare - numbers[7]
                found[MeetingKind.DIRECTION].append((meeting.label(body.form), apart, margin))
    for kind, name, share in (
        (MeetingKind.MIDDLE, "clear_of_mirror_image", 1.0),
        (MeetingKind.PLANE, "clear_of_plane", 0.5),
        (MeetingKind.DIRECTION, CLEAR, 1.0),
    ):
        yield from _column(name, found[kind], share, rules.margin)


def _column(
    name: str, found: Sequence[tuple[str, Expression, float]], share: float, margin: float
) -> Iterator[Row]:
    """Rows of one kind, which keep a share of the margin [m]; each with that of its own pair."""
    if found:
        labels = tuple(label for label, _, _ in found)
        column, least = ca.vertcat(*[expression for _, expression, _ in found]), share * margin
        key, group = "collisions.margin_m", LimitGroup.COLLISIONS
        bounds = tuple(
            Bound("bodies apart", own, "m", False, share, key if own == margin else "", label)
            for label, _, own in found
        )
        row = Row(name, column, least, np.inf, ("overlap",), group=group, posture_only=True)
        yield replace(row, labels=labels, least=bounds)


def residuals(system: MeasuredSystem) -> Iterator[Residual]:
    """How deep the deepest overlap is [m], by coal on the true shapes, of all that must not overlap."""
    if system.solids is None or system.disturbance is not UNDISTURBED:
        return
    poses = {name: (body.agent.turn, body.state.poses) for name, body in system.bodies.items()}
    overlaps = system.solids.near(poses, next(iter(system.bodies.values())).load_height)
    worst = min(overlaps, key=lambda gap: gap.distance, default=None)
    deep, who = (0.0, "bodies") if worst is None else (-worst.distance, f"{worst.first} and {worst.second}")
    yield Residual("overlap", deep, "m", f"{who} apart", LimitGroup.COLLISIONS, posture_only=True)


COLLISIONS = BodyTerm("collisions", LimitGroup.COLLISIONS, held=held, rows=rows)
OVERLAP = SystemTerm("overlap", LimitGroup.COLLISIONS, residuals=residuals)
