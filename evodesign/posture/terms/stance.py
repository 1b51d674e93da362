"""The stance: feet neither too near nor too far apart, and the trunk clear of the load.

These bounds keep a posture one that a robot or person would take: without them the optimum stands under the
load.
"""

from __future__ import annotations

from collections.abc import Iterator

import casadi as ca
import numpy as np

from evodesign.mechanics.scene import SIDES, Scene
from evodesign.posture.limit_groups import LimitGroup
from evodesign.posture.terms.base import Body, BodyTerm, MeasuredBody, Residual, Row

__all__ = ["STANCE"]


def rows(body: Body) -> Iterator[Row]:
    """Trunk frames behind the load's edge, and the soles' distances."""
    form, stance = body.form, body.scene.stance
    soles = [body.poses[form.agent.soles[side]].position for side in form.sides]
    if form.trunk:
        trunk = ca.vertcat(*[body.poses[frame].position[0] for frame in form.trunk])
        yield _row("trunk_clear", trunk, -np.inf, _nearest(body.scene), form.trunk)
    if form.sides != SIDES:  # the right sole is the left one's mirror image
        yield _row("feet_apart", 2.0 * soles[0][1], *stance.feet_apart)
        return
    yield _row("feet_apart", soles[0][1] - soles[1][1], *stance.feet_apart)
    yield _row("feet_stagger", soles[0][0] - soles[1][0], -stance.feet_stagger, stance.feet_stagger)


def _row(name: str, expression: object, lower: float, upper: float, labels: tuple[str, ...] = ()) -> Row:
    group = LimitGroup.STANCE
    return Row(name, expression, lower, upper, (name,), group=group, posture_only=True, labels=labels)


def _nearest(scene: Scene) -> float:
    """Largest x of a trunk frame, in the agent's frame [m]."""
    return float(-scene.payload.size[0] / 2.0 - scene.stance.trunk_clearance)


def residuals(body: MeasuredBody) -> Iterator[Residual]:
    """Distances [m] by which feet and trunk are where they should not be."""
    state, stance = body.state, body.scene.stance
    left, right = (state.pose(body.agent.soles[side])[1] for side in SIDES)
    ahead, apart, _ = (left - right).tolist()
    least, most = stance.feet_apart
    trunk = [float(state.pose(name)[1][0]) - _nearest(body.scene) for name in body.agent.trunk]
    for name, size, words in (
        ("feet_apart", max(0.0, least - apart, apart - most), "the feet's distance"),
        ("feet_stagger", max(0.0, abs(ahead) - stance.feet_stagger), "the feet's stagger"),
        ("trunk_clear", max(0.0, *trunk, 0.0), "the trunk's distance from the load"),
    ):
        yield Residual(name, size, "m", words, LimitGroup.STANCE, posture_only=True)


STANCE = BodyTerm("stance", rows=rows, residuals=residuals)
