"""The grasp: hands on the load, and what they can pass to it.

An agent that has no body in a program is a pair of free hands, which pass what they must.

Source: Sartore et al. 2022, Eq. 14 c and d.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import casadi as ca
import numpy as np

from evodesign.mechanics.agent import Contact
from evodesign.mechanics.payload import Grasp, Payload
from evodesign.mechanics.scene import Scene
from evodesign.posture.limit_groups import LimitGroup
from evodesign.posture.symmetry import Form
from evodesign.posture.terms.base import (
    HAND_UNIT,
    REGULARISATION,
    Body,
    BodyTerm,
    Bound,
    Expression,
    MeasuredBody,
    Residual,
    Row,
    Unknown,
    both_ways,
)
from evodesign.tree.kinematics import vector

STRONGEST = 300.0  # [N] and [N m] of a hand, beyond any holding posture

GRASP_ROWS = {Grasp.POINT: 3, Grasp.RIGID: 6}
"""Numbers of a hand's wrench that are free: a force, or a force and a moment."""


def unknowns(form: Form, scene: Scene) -> Iterator[Unknown]:
    """The free numbers of the form's hands [N, N m]."""
    return hand_unknowns(form.hands, scene.payload)


def hand_unknowns(hands: Sequence[Contact], payload: Payload) -> Iterator[Unknown]:
    """The free numbers of hands [N, N m]: a force, and with rigid grasps a moment."""
    moment = min(STRONGEST, payload.hand_moment)
    limit = ([STRONGEST] * 3 + [moment] * 3)[: GRASP_ROWS[payload.grasp]]
    force = Bound("hand force", STRONGEST, "N", True)
    turning = Bound("hand moment", moment, "N m", True, key="payload.hand_moment_n_m")
    bounds = [both_ways(each) for each in (force, force, force, turning, turning, turning)[: len(limit)]]
    below, above = zip(*bounds, strict=True)
    for hand in hands:
        least, rest = [-x for x in limit], [0.0] * len(limit)
        asked = Unknown(hand.name, least, limit, rest, HAND_UNIT, LimitGroup.CONTACT)
        yield replace(asked, least=below, most=above)


def moment_cost(hands: Mapping[str, Expression], payload: Payload) -> Expression:
    """Moments of free hands, slightly disliked so that rigid ones are unique; zero for point grasps."""
    moments = [wrench[3:] / HAND_UNIT for wrench in hands.values()]
    cost = REGULARISATION * sum(ca.sumsqr(moment) for moment in moments)
    return cost if payload.grasp is Grasp.RIGID else ca.SX(0.0)


def rows(body: Body) -> Iterator[Row]:
    """Hands on their grasp points (Eq. 14 c and d)."""
    lift = ca.vertcat(0.0, 0.0, body.load_height)
    for hand in body.form.hands:
        place = body.poses[hand.frame].position
        distance = place - vector(body.scene.payload.grasp_point(body.agent, hand)) - lift
        yield Row(f"{hand.name}_on_load", distance, 0.0, 0.0, ("hands_on_load",), posture_only=True)


def residuals(body: MeasuredBody) -> Iterator[Residual]:
    """Largest distance of a hand from its grasp point along an axis."""
    found, lift = [], np.array([0.0, 0.0, body.load_height])
    for hand in body.agent.hands:
        grasp = np.array(body.scene.payload.grasp_point(body.agent, hand)) + lift
        found.append(float(np.abs(body.state.pose(hand.frame)[1] - grasp).max()))
    words = "the hands' place on the load"
    yield Residual("hands_on_load", max(found), "m", words, posture_only=True)


GRASP = BodyTerm("grasp", unknowns=unknowns, rows=rows, residuals=residuals)
