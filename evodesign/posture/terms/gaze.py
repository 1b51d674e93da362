"""The gaze: a person looks at the load, as far as neck and eyes turn.

    a . v >= cos(cone) |v|        v from the head's middle to the load's centre, a the head's forward axis

The neck of the generated person is stiff, so the cone stands for what neck and eyes turn together. A person
who may look anywhere (no `[human] gaze_cone_deg`) has no such row.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import casadi as ca
import numpy as np

from evodesign.posture.limit_groups import LimitGroup
from evodesign.posture.terms.base import Body, BodyTerm, Bound, MeasuredBody, Residual, Row
from evodesign.tree.kinematics import vector

NAME = "gaze"


def rows(body: Body) -> Iterator[Row]:
    """The cosine of the load's angle from straight ahead, above that of the cone."""
    gaze = body.agent.gaze
    if gaze is not None:
        head = body.poses[gaze.link]
        away = ca.vertcat(0.0, 0.0, body.load_height) - head.point(vector(gaze.place))
        within = ca.dot(head.rotation[:, 0], away) / ca.norm_2(away) - math.cos(gaze.cone)
        group, key = LimitGroup.STANCE, "human.gaze_cone_deg"
        most = Bound("gaze cone", gaze.cone, "rad", True, -math.sin(gaze.cone), key)
        yield Row(NAME, within, 0.0, np.inf, (NAME,), group=group, posture_only=True, least=(most,))


def residuals(body: MeasuredBody) -> Iterator[Residual]:
    """The angle by which the load is outside the cone."""
    gaze = body.agent.gaze
    if gaze is not None:
        rotation, origin = body.state.pose(gaze.link)
        away = np.array([0.0, 0.0, body.load_height]) - origin - rotation @ np.array(gaze.place)
        ahead, across = rotation[:, 0] @ away, np.linalg.norm(np.cross(rotation[:, 0], away))
        beyond = max(0.0, math.atan2(across, ahead) - gaze.cone)
        yield Residual(NAME, beyond, "rad", "sight of the load", LimitGroup.STANCE, posture_only=True)


GAZE = BodyTerm("gaze", rows=rows, residuals=residuals)
