"""Feet: flat on the ground, not turned far, and pressing as the ground allows.

"Flat" is two vanishing entries of the sole's rotation rather than one entry equal to one, whose gradient
vanishes at the solution. Foot wrenches live in the sole frame, where the limits of contact are linear.

Source: Sartore et al. 2022, Eq. 14 e to g; contact: `mechanics.contact`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import casadi as ca
import numpy as np

from evodesign.mechanics.agent import Role
from evodesign.mechanics.contact import SoleSize, foot_margins
from evodesign.mechanics.scene import Scene
from evodesign.posture.limit_groups import LimitGroup
from evodesign.posture.symmetry import Form
from evodesign.posture.terms.base import (
    FORCE_UNIT,
    Body,
    BodyTerm,
    Bound,
    Coupled,
    Expression,
    MeasuredBody,
    Residual,
    Row,
    SystemTerm,
    Unknown,
    both_ways,
)

STRONGEST = 5000.0  # [N] and [N m] of a foot
RESTING = [0.0, 0.0, 300.0, 0.0, 0.0, 0.0]
"""A foot's wrench in the program's own start [N, N m]."""

MARGIN_UNIT = 100.0  # [N] and [N m] per unit of a foot's margin


def unknowns(form: Form, scene: Scene) -> Iterator[Unknown]:
    """Wrenches on the form's feet [N, N m], in the sole frames."""
    for foot in form.feet:
        limit = [STRONGEST] * 6
        least = [-x for x in limit]
        yield Unknown(foot.name, least, limit, RESTING, FORCE_UNIT, LimitGroup.CONTACT)


def rows(body: Body) -> Iterator[Row]:
    """Each sole on the ground and flat (Eq. 14 e to g), within the limits of contact, and not turned far."""
    most = body.scene.stance.foot_yaw
    for foot in body.form.feet:
        sole, wrench = body.poses[foot.frame], body.feet[foot.name]
        level = ca.vertcat(sole.position[2], sole.rotation[0, 2], sole.rotation[1, 2])
        margins = ca.vertcat(*foot_margins(wrench, foot.sole, body.scene.ground))
        flat = ("feet_on_ground", "feet_flat")
        yield Row(f"{foot.name}_flat", level, 0.0, 0.0, flat, posture_only=True)
        yield Row(
            f"{foot.name}_contact",
            margins / MARGIN_UNIT,
            0.0,
            np.inf,
            ("foot_contact",),
            MARGIN_UNIT,
            LimitGroup.CONTACT,
            least=_contact_bounds(body, foot.sole, wrench[2]),
        )
        turn, stance = ca.atan2(sole.rotation[1, 0], sole.rotation[0, 0]), LimitGroup.STANCE
        row = Row(f"{foot.name}_yaw", turn, -most, most, ("feet_yaw",), group=stance, posture_only=True)
        right, left = both_ways(Bound("foot yaw", most, "rad", True, key="limits.foot_yaw_rad"))
        yield replace(row, least=(right,), most=(left,))


def _contact_bounds(body: Body, sole: SoleSize, pressing: Expression) -> tuple[Bound, ...]:
    """What bounds each of a foot's margins, which is no less than zero.

    Args:
        body: whose foot it is.
        sole: of the foot.
        pressing: normal force of the foot [N]; a larger friction or sole widens the margins in proportion.
    """
    ground, name = body.scene.ground, "centre of pressure"
    share, key = -pressing / MARGIN_UNIT, ""
    if body.agent.role is Role.ROBOT:
        key = "robot.soles.size_m" if body.agent.on_feet else "robot.base.size_m"
    lifted = Bound(
        "foot force", ground.least_force, "N", False, 1.0 / MARGIN_UNIT, "limits.least_foot_force_n"
    )
    slipping = Bound("friction", ground.friction, "1", True, share / math.sqrt(2.0), "limits.friction")
    turning = "limits.torsional_friction_m"
    twisting = Bound("torsional friction", ground.torsional_friction, "m", True, share, turning)
    pitching = Bound(name, sole.length, "m", True, share / 2.0, key, "length of the sole")
    rolling = Bound(name, sole.width, "m", True, share / 2.0, key, "width of the sole")
    pairs = (slipping, slipping, twisting, pitching, rolling)
    return (lifted, *(bound for bound in pairs for _ in range(2)))


def residuals(body: MeasuredBody) -> Iterator[Residual]:
    """Soles above the ground, slanted or turned, and wrenches that the ground cannot return."""
    heights, slants, yaws, margins = [], [], [], []
    for foot in body.agent.feet:
        rotation, origin = body.state.pose(foot.frame)
        heights.append(abs(float(origin[2])))
        slants.append(float(np.abs(rotation[:, 2] - [0.0, 0.0, 1.0]).max()))
        yaws.append(abs(float(np.arctan2(rotation[1, 0], rotation[0, 0]))))
        margins += foot_margins(body.posture.wrenches[foot.name], foot.sole, body.scene.ground)
    yield Residual("feet_on_ground", max(heights), "m", "the feet's height", posture_only=True)
    yield Residual("feet_flat", max(slants), "1", "the feet's slant", posture_only=True)
    broken = max(0.0, -float(min(margins)))
    words = "the contact of a foot with the ground"
    yield Residual("foot_contact", broken, "N", words, LimitGroup.CONTACT)
    turned = max(0.0, max(yaws) - body.scene.stance.foot_yaw)
    yield Residual("feet_yaw", turned, "rad", "the turn of a foot", LimitGroup.STANCE, posture_only=True)


FEET = BodyTerm("feet", unknowns=unknowns, rows=rows, residuals=residuals)


def upright_rows(coupled: Coupled) -> Iterator[Row]:
    """z_sole . z >= 0: of the two ways of being flat, 1 and -1, the first."""
    soles = [
        body.poses[foot.frame].rotation[2, 2] for body in coupled.bodies.values() for foot in body.form.feet
    ]
    rows, group = ca.vertcat(*soles), LimitGroup.UPRIGHT
    yield Row("feet.upright", rows, 0.0, np.inf, ("feet_flat",), group=group, posture_only=True)


UPRIGHT = SystemTerm("upright", LimitGroup.UPRIGHT, rows=upright_rows)
