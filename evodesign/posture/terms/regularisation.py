"""Small convex costs that make postures and wrenches unique where torques do not."""

from __future__ import annotations

from itertools import pairwise

import casadi as ca

from evodesign.posture.limit_groups import LimitGroup
from evodesign.posture.terms.base import FORCE_UNIT, HAND_UNIT, REGULARISATION, Body, BodyTerm, Expression
from evodesign.posture.terms.floating_base import joint_ranges


def posture_cost(body: Body) -> Expression:
    """Bent joints and a tilted base, slightly disliked."""
    ranges = [upper - lower for lower, upper in joint_ranges(body.form)]
    joints = (body.values["joints"] / ca.DM(ranges)) ** 2
    bent = ca.dot(ca.DM(list(body.form.counts)), joints)
    return REGULARISATION * (bent + ca.sumsqr(body.values["base_angles"]))


def wrench_cost(body: Body) -> Expression:
    """Sideways and twisting hands and unequal feet, slightly disliked."""
    hands, feet = body.hands.values(), [*body.feet.values()]
    lateral = sum(ca.sumsqr(wrench[:2]) + ca.sumsqr(wrench[3:]) for wrench in hands) / HAND_UNIT**2
    unequal = sum(ca.sumsqr(one - other) for one, other in pairwise(feet)) / FORCE_UNIT**2
    return REGULARISATION * (lateral + unequal)


POSTURE_REGULARISATION = BodyTerm("posture_regularisation", posture_cost=posture_cost)
WRENCH_REGULARISATION = BodyTerm("wrench_regularisation", LimitGroup.CONTACT, cost=wrench_cost)
"""Left out where the limits of contact are: then torques are exactly those of the paper's Eq. 12."""
