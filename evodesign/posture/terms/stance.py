"""The stance: feet neither too near nor too far apart, and the trunk clear of the load.

These bounds keep a posture one that a robot or person would take: without them the optimum stands under the
load.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import casadi as ca
import numpy as np

from evodesign.posture.limit_groups import LimitGroup
from evodesign.posture.terms.base import Body, BodyTerm, Bound, MeasuredBody, Residual, Row, both_ways


def rows(body: Body) -> Iterator[Row]:
    """Trunk frames behind the load's edge, and the soles' distances."""
    form, stance = body.form, body.scene.stance_of(body.agent)
    soles = [body.poses[foot.frame].position for foot in form.feet]
    if form.trunk:
        trunk = ca.vertcat(*[body.poses[frame].position[0] for frame in form.trunk])
        key, clear = "limits.trunk_clearance_m", stance.trunk_clearance
        bounds = [Bound("trunk clearance", clear, "m", False, -1.0, key, frame) for frame in form.trunk]
        row = _row("trunk_clear", trunk, -np.inf, _nearest(body), most=tuple(bounds))
        yield replace(row, labels=form.trunk)
    if not body.agent.on_feet:
        return
    (least, most), name, key = stance.feet_apart, "feet apart", "limits.feet_apart_m"
    ends = Bound(name, least, "m", False, key=key), Bound(name, most, "m", True, key=key)
    if form.mirror is not None:  # the right sole is the left one's mirror image
        yield _row("feet_apart", 2.0 * soles[0][1], least, most, ends[:1], ends[1:])
        return
    yield _row("feet_apart", soles[0][1] - soles[1][1], least, most, ends[:1], ends[1:])
    most = stance.feet_stagger
    back, forth = both_ways(Bound("feet stagger", most, "m", True, key="limits.feet_stagger_m"))
    yield _row("feet_stagger", soles[0][0] - soles[1][0], -most, most, (back,), (forth,))


def _row(
    name: str,
    expression: object,
    lower: float,
    upper: float,
    least: tuple[Bound, ...] = (),
    most: tuple[Bound, ...] = (),
) -> Row:
    group, found = LimitGroup.STANCE, (name,)
    return Row(name, expression, lower, upper, found, group=group, posture_only=True, least=least, most=most)


def _nearest(body: Body | MeasuredBody) -> float:
    """Largest x of a trunk frame, in the agent's frame [m]."""
    return float(
        -body.scene.payload.faced(body.agent)[0] / 2.0 - body.scene.stance_of(body.agent).trunk_clearance
    )


def residuals(body: MeasuredBody) -> Iterator[Residual]:
    """Distances [m] by which feet and trunk are where they should not be."""
    state, stance = body.state, body.scene.stance_of(body.agent)
    trunk = [float(state.pose(name)[1][0]) - _nearest(body) for name in body.agent.trunk]
    found = [("trunk_clear", max(0.0, *trunk, 0.0), "the trunk's distance from the load")]
    if body.agent.on_feet:
        left, right = (state.pose(foot.frame)[1] for foot in body.agent.feet)
        ahead, apart, _ = (left - right).tolist()
        least, most = stance.feet_apart
        found = [
            ("feet_apart", max(0.0, least - apart, apart - most), "the feet's distance"),
            ("feet_stagger", max(0.0, abs(ahead) - stance.feet_stagger), "the feet's stagger"),
            *found,
        ]
    for name, size, words in found:
        yield Residual(name, size, "m", words, LimitGroup.STANCE, posture_only=True)


STANCE = BodyTerm("stance", rows=rows, residuals=residuals)
