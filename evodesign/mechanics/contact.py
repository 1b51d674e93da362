"""Contacts: who touches whom, and what a foot may pass to the ground.

One wrench acts on body A and, negated, on B or the ground, so the third law holds by structure. A foot's
wrench lives in the sole frame (x forward, y left, z up, origin at the middle of the sole), where its
limits are linear with constant coefficients. All rows are non-negative when the contact holds:

    unilateral            f_z - f_min
    friction (pyramid)    mu/sqrt(2) f_z -+ f_x,  mu/sqrt(2) f_z -+ f_y    (inside the cone)
    torsional friction    gamma f_z -+ m_z
    centre of pressure    l/2 f_z -+ m_y,  w/2 f_z -+ m_x       (CoP = (-m_y, m_x)/f_z)

Source: Sartore et al. 2022, Section III-D (centre of pressure); Caron, Pham and Nakamura 2015 (wrench
cones of rectangular soles).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

Expression = Any


@dataclass(frozen=True, slots=True)
class SoleSize:
    """A rectangular sole: length along x and width along y of the sole frame [m]."""

    length: float
    width: float


@dataclass(frozen=True, slots=True)
class Ground:
    """Limits of the contact between foot and ground.

    Args:
        friction: Coulomb coefficient mu [-].
        torsional_friction: largest |m_z| / f_z [m].
        least_force: smallest normal force of a foot [N].
    """

    friction: float = 0.5
    torsional_friction: float = 0.02
    least_force: float = 0.0


def foot_margins(wrench: Expression, sole: SoleSize, ground: Ground) -> list[Expression]:
    """Margins of a foot's wrench, each to be non-negative.

    Args:
        wrench: six numbers or expressions, force [N] then moment [N m] on the foot, in the sole frame.
        sole: its size.
        ground: what it stands on.
    Returns:
        Eleven margins [N] and [N m], in the order of the module's formulas.
    """
    force_x, force_y, force_z, moment_x, moment_y, moment_z = (wrench[i] for i in range(6))
    pyramid = ground.friction / math.sqrt(2.0) * force_z
    twist = ground.torsional_friction * force_z
    pitch, roll = sole.length / 2.0 * force_z, sole.width / 2.0 * force_z
    margins = [force_z - ground.least_force]
    for bound, value in (
        (pyramid, force_x),
        (pyramid, force_y),
        (twist, moment_z),
        (pitch, moment_y),
        (roll, moment_x),
    ):
        margins += [bound - value, bound + value]
    return margins
