"""The paper's formulas for torques and wrenches: a reference implementation beside the posture solver.

    Lambda^-1 = Q M^-1 Q^T                         S = M^1/2, A = Q S^-1, so that Lambda^-1 = A A^T
    N = 1 - Q^T (Q M^-1 Q^T)^+ Q M^-1              projector, Eq. 11         = 1 - S A^+ A S^-1
    tau = (N B)^+ N h                              torques at rest, Eq. 12
    f = (Q M^-1 Q^T)^+ (Q M^-1 (h - B tau) - dQ/dt nu)     wrenches, Eq. 13 (at rest dQ/dt nu = 0)
    CoP = (-m_y / f_z, m_x / f_z)                  centre of pressure, Section III-D, task t3

The pseudo-inverse of the semi-definite Q M^-1 Q^T is taken through the singular values of A, whose square
they are: (A A^T)^+ = (A^+)^T A^+, at half the digits lost.

What is unique. N x = 0 exactly when x lies in the range of Q^T, whatever the positive definite M; so Eq. 12
is the least-norm tau (all joints of both agents weighted alike) for which wrenches with B tau + Q^T f = h
exist, and does not depend on M. Given that tau, f is unique when the rows of Q are independent, as they are
when legs and arms can move feet and hands independently. When they are not, wrenches in the null space of Q^T
may be added freely (an internal force that needs no joint torque), and Eq. 13 gives the f of least Euclidean
norm over the rows of Q, newtons beside newton metres, again whatever M. When no wrenches hold the system, B
tau + Q^T f misses h by the least amount in the norm of M^-1 (Gauss).

Source: Sartore et al. 2022, Eq. 9 to 13; Rapetti et al. 2021 (minimum-torque wrenches).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from evodesign.mechanics.coupled import CoupledSystem
from evodesign.mechanics.floating_base import Array

RANK_CUTOFF = 1e-8
"""Singular values of A and N B below this share of the largest count as zero.

It is the square root of the rounding of doubles: a direction kept just above it loses eight of sixteen
digits, one dropped just below it takes 1e-8 of the wrench along it. Real systems are far from both: over 400
random ones (random designs, persons, postures and grasps; free and stiff legs) and 80 solved postures, what
counts is above 1e-3 (A) and 1e-4 (N B) of the largest, and what does not is below 1e-14.
"""

MASS_FLOOR = 1e-9
"""Eigenvalues of M below this share of the largest are lifted to it.

In gimbal lock (a person's shoulder with its middle axis at 90 degrees, which optimal postures do seek) the
massless links between the axes of a joint turn without moving any mass: M is singular and the printed
formulas do not exist. Torques and wrenches at rest do not depend on M, so the lift makes them exist and
changes nothing. Accelerations along the direction that moves nothing are not to be trusted; they would not
exist without it. Away from the lock the smallest share is about 1e-5.
"""


@dataclass(frozen=True, slots=True, eq=False)
class _Constraint:
    """Q in the coordinates S dnu/dt, in which the mass matrix is one: A = Q S^-1 = left diag(gains) right.

    Args:
        root, unroot: S = M^1/2 and its inverse, shape (v, v).
        left, gains, right: the r singular triples of A that count; shapes (c, r), (r,), (r, v).
    """

    root: Array
    unroot: Array
    left: Array
    gains: Array
    right: Array

    @classmethod
    def of(cls, mass: Array, coupling: Array) -> _Constraint:
        eigenvalues, vectors = np.linalg.eigh(mass)
        roots = np.sqrt(np.maximum(eigenvalues, MASS_FLOOR * eigenvalues[-1]))
        unroot = vectors / roots @ vectors.T
        left, gains, right = np.linalg.svd(coupling @ unroot, full_matrices=False)
        rank = int(np.count_nonzero(gains > RANK_CUTOFF * gains[0]))
        return cls(vectors * roots @ vectors.T, unroot, left[:, :rank], gains[:rank], right[:rank])

    def wrenches(self, missing: Array, drift: Array) -> Array:
        """(Q M^-1 Q^T)^+ (Q M^-1 missing - drift)."""
        return self.left @ (
            (self.right @ (self.unroot @ missing) - self.left.T @ drift / self.gains) / self.gains
        )


def constraint_projector(mass: Array, coupling: Array) -> Array:
    """N, which removes from generalised forces what the contacts can carry.

    Args:
        mass: M, shape (v, v), symmetric.
        coupling: Q, shape (c, v), of any rank.
    Returns:
        Shape (v, v); N Q^T = 0 and N N = N.
    Source: Sartore et al. 2022, Eq. 7 and 11.
    """
    constraint = _Constraint.of(mass, coupling)
    carried = constraint.right.T @ constraint.right
    return np.asarray(np.eye(len(mass)) - constraint.root @ carried @ constraint.unroot)


def projected_torques(system: CoupledSystem) -> Array:
    """Least-norm joint torques that hold the system without acceleration, in the order of `system.joints`.

    Returns:
        tau [N m] (force [N] for a prismatic joint), shape (j,).
    Source: Sartore et al. 2022, Eq. 12.
    """
    projector = constraint_projector(system.mass, system.coupling)
    inverse = np.linalg.pinv(projector @ system.selector, rcond=RANK_CUTOFF)
    return np.asarray(inverse @ (projector @ system.bias))


def contact_wrenches(system: CoupledSystem, torques: Array) -> Array:
    """Wrenches of all contacts under given torques, in the order of the rows of Q.

    Args:
        system: at rest or moving.
        torques: tau, shape (j,).
    Returns:
        f, shape (c,); forces [N] and moments [N m] on feet and hands (`CoupledSystem.wrenches_of`).
    Source: Sartore et al. 2022, Eq. 13, with the drift of Eq. 9 for a moving system.
    """
    constraint = _Constraint.of(system.mass, system.coupling)
    return constraint.wrenches(system.bias - system.selector @ torques, system.drift)


def constrained_accelerations(system: CoupledSystem, torques: Array) -> Array:
    """How the system accelerates under given torques while all contacts hold.

        dnu/dt = M^-1 (B tau + Q^T f - h)

    Args:
        system: at rest or moving.
        torques: tau, shape (j,).
    Returns:
        dnu/dt, shape (v,), with dQ/dt nu + Q dnu/dt = 0 as far as the rows of Q agree.
    Source: Sartore et al. 2022, Eq. 9.
    """
    constraint = _Constraint.of(system.mass, system.coupling)
    missing = system.bias - system.selector @ torques
    pushed = system.coupling.T @ constraint.wrenches(missing, system.drift) - missing
    return constraint.unroot @ (constraint.unroot @ pushed)


def center_of_pressure(wrench: Array) -> tuple[float, float]:
    """Where a foot's force meets the sole: x and y in the sole frame [m].

    Args:
        wrench: force [N] and moment [N m] on the foot, in the sole frame, shape (6,).
    Raises:
        ZeroDivisionError: the foot does not press on the ground.
    Source: Sartore et al. 2022, Section III-D, task t3.
    """
    _, _, press, moment_x, moment_y, _ = wrench.tolist()
    return -moment_y / press, moment_x / press
