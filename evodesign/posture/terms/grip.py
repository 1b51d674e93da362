"""The grip: a forearm comes to the load from a direction in which a hand can hold it.

    a . f >= cos(cone) |f|        f from the elbow to the hand, a the direction's axis

A hand is a frame of which most models do not say where its palm is; the forearm is known, and a wrist bends
by about the cone. A load whose forearms are free (`[payload] grasp_direction`) has no such rows.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

import casadi as ca
import numpy as np

from evodesign.body.placement import Vector
from evodesign.mechanics.agent import Agent, Contact
from evodesign.mechanics.elbow import Elbow, elbow
from evodesign.mechanics.payload import Payload
from evodesign.posture.limit_groups import LimitGroup
from evodesign.posture.terms.base import Body, BodyTerm, Bound, MeasuredBody, Residual, Row
from evodesign.tree.kinematics import vector


def directed(
    agent: Agent, payload: Payload, hands: Iterable[Contact]
) -> Iterator[tuple[Contact, Vector, Elbow]]:
    """Hands whose forearms are not free, with the axis of their cone and the elbow."""
    for hand in hands:
        axis = payload.grasp_direction.axis(hand.side)
        bent = elbow(agent, hand) if axis else None
        if axis and bent:
            yield hand, axis, bent


def rows(body: Body) -> Iterator[Row]:
    """The cosine of each forearm's angle from the direction, above that of the cone."""
    payload, group = body.scene.payload, LimitGroup.STANCE
    for hand, axis, bent in directed(body.agent, payload, body.form.hands):
        forearm = body.poses[hand.frame].position - body.poses[bent.link].point(vector(bent.place))
        within = ca.dot(vector(axis), forearm) / ca.norm_2(forearm) - math.cos(payload.grasp_cone)
        found, cone, key = ("grasp_direction",), payload.grasp_cone, "payload.grasp_cone_deg"
        most = (Bound("grasp cone", cone, "rad", True, -math.sin(cone), key),)
        name = f"{hand.side}_forearm"
        yield Row(name, within, 0.0, np.inf, found, group=group, posture_only=True, least=most)


def residuals(body: MeasuredBody) -> Iterator[Residual]:
    """The largest angle by which a forearm leaves its cone."""
    payload, state = body.scene.payload, body.state
    beyond = []
    for hand, axis, bent in directed(body.agent, payload, body.agent.hands):
        rotation, origin = state.pose(bent.link)
        forearm = state.pose(hand.frame)[1] - origin - rotation @ np.array(bent.place)
        across = float(np.linalg.norm(np.cross(axis, forearm)))
        beyond.append(math.atan2(across, float(np.dot(axis, forearm))) - payload.grasp_cone)
    if beyond:
        size, words = max(0.0, *beyond), "the direction of a forearm"
        yield Residual("grasp_direction", size, "rad", words, LimitGroup.STANCE, posture_only=True)


GRIP = BodyTerm("grip", rows=rows, residuals=residuals)
