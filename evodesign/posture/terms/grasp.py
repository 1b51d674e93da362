"""An agent reduced to its hands: forces on the load that it may choose freely, without a body behind them.

The reach problem lets such hands stand in for the person; the split posture problem lets them stand in for
whichever agent is solved separately.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import casadi as ca

from evodesign.mechanics.scene import Grasp, Scene
from evodesign.nlp.program import Variable
from evodesign.posture.symmetry import WRENCH, Form
from evodesign.posture.terms.floating_base import COMFORT
from evodesign.posture.terms.torque import HAND_UNIT, hand_limits, hand_wrench

__all__ = ["Hands", "free_hands"]

Expression = Any


@dataclass(frozen=True, slots=True)
class Hands:
    """Hands without a body.

    Args:
        variables: what they pass, for the sides of the form.
        wrenches: force [N] and moment [N m] on both hands by side, in their agent's frame.
        comfort: small convex cost of their moments, so that rigid hands are unique; zero for point grasps.
    """

    variables: tuple[Variable, ...]
    wrenches: Mapping[str, Expression]
    comfort: Expression


def free_hands(form: Form, scene: Scene, prefix: str = "") -> Hands:
    """Hands that stand in for another agent of the same form (whole or half).

    Args:
        form: of the agent that is there.
        scene: for what a hand can pass.
        prefix: begins the names of variables, where there is more than one thing to bear.
    """
    limit = hand_limits(scene.payload)
    variables = {
        side: Variable.column(
            f"{prefix}partner.{side}_hand", [-x for x in limit], limit, [0.0] * len(limit), HAND_UNIT
        )
        for side in form.sides
    }
    wrenches = {side: hand_wrench(variable.value) for side, variable in variables.items()}
    if form.mirror is not None:
        wrenches["right"] = wrenches["left"] * ca.DM(WRENCH)
    moments = [wrench[3:] / HAND_UNIT for wrench in wrenches.values()]
    comfort = COMFORT * sum(ca.sumsqr(moment) for moment in moments)
    rigid = scene.payload.grasp is Grasp.RIGID
    return Hands(tuple(variables.values()), wrenches, comfort if rigid else ca.SX(0.0))
