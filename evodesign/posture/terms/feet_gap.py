"""Feet that do not stand on each other: the inner corners of both soles are a gap apart, sideways.

The sole is a rectangle about its frame, flat on the ground and turned by less than a right angle, so that its
two inner corners are the ones nearest to the other foot.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

import casadi as ca
import numpy as np

from evodesign.mechanics.agent import TO_THE_LEFT, Contact
from evodesign.mechanics.contact import SoleSize
from evodesign.posture.limit_groups import LimitGroup
from evodesign.posture.terms.base import Body, BodyTerm, Bound, MeasuredBody, Residual, Row
from evodesign.tree.kinematics import Expression

NAME = "feet_gap"


def rows(body: Body) -> Iterator[Row]:
    """Sideways distances of inner corners [m]; in a symmetric posture from those of the mirror image."""
    gap = body.scene.stance.feet_gap
    if gap is None or not body.agent.on_feet:
        return
    inner = [_inner_corners(body, foot) for foot in body.form.feet]
    if body.form.mirror is None:
        apart = [left - right for left, right in product(*inner)]
    else:
        apart = [2.0 * left for left in inner[0]]
    group, least = LimitGroup.STANCE, Bound("gap between the feet", gap, "m", False, key="limits.feet_gap_m")
    column = ca.vertcat(*apart)
    yield Row(NAME, column, gap, np.inf, (NAME,), group=group, posture_only=True, least=(least,))


def _inner_corners(body: Body, foot: Contact) -> list[Expression]:
    """How far to the left the corners are."""
    sole, inwards = body.poses[foot.frame], -TO_THE_LEFT[foot.side]
    return [sole.point(ca.DM([x, y, 0.0]))[1] for x, y in _corners(foot.sole) if y * inwards > 0.0]


def _corners(size: SoleSize) -> list[tuple[float, float]]:
    return [(x * size.length / 2.0, y * size.width / 2.0) for x, y in product((-1.0, 1.0), (-1.0, 1.0))]


def residuals(body: MeasuredBody) -> Iterator[Residual]:
    """By how much the soles come too near [m]."""
    gap = body.scene.stance.feet_gap
    if gap is None or not body.agent.on_feet:
        return
    (left, half_left), (right, half_right) = (_sideways(body, foot) for foot in body.agent.feet)
    missing = max(0.0, gap - (left - half_left - right - half_right))
    yield Residual(NAME, missing, "m", "the gap between the feet", LimitGroup.STANCE, posture_only=True)


def _sideways(body: MeasuredBody, foot: Contact) -> tuple[float, float]:
    """Where the middle of a sole is, and how far its corners reach from there [m], along y."""
    size = foot.sole
    rotation, origin = body.state.pose(foot.frame)
    reach = abs(rotation[1, 0]) * size.length / 2.0 + abs(rotation[1, 1]) * size.width / 2.0
    return float(origin[1]), float(reach)


FEET_GAP = BodyTerm("feet_gap", rows=rows, residuals=residuals)
