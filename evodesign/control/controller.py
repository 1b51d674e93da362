"""A whole-body controller: the torques of one agent at one moment, from its state and its part of a plan.

Unknown are the accelerations a of the body and the wrenches f of its feet; torques follow from both,

    tau = M_j a + h_j - J_feet,j' f - J_hands,j' F

Strict are the motion of the root link (the same rows of the equation of motion without a torque), soles that
stay where they are, friction, centres of pressure (`mechanics.contact`), torque limits, and the ranges of
joints and their speeds as limits of their accelerations,

    a >= -w^2 (q - q_min) - 2 z w v,     a >= -2 z w (v + v_max),     and likewise above,

so that a joint nears the end of its range like a critically damped oscillator. Within these, least squares
of what is wanted, in the masses and inertias that it moves:

    balance   of the centre of mass c, with capture point c + v / w0 and w0 = sqrt(g / height):
              horizontally  a_plan + w w0 (c_plan - c) + (w + w0) (v_plan - v),  upwards as all below
    hands     each of n hands carries m/n of the load: a_plan + w^2 (x_plan - x) + 2 z w (v_plan - v), and the
              wrench F = F_plan - m/n (what the feedback adds), which is an impedance of the load
    trunk     its turn, likewise
    posture   joints, likewise
    wrenches  of the feet, as planned

The order is that of importance: what stands lower counts by `LEVEL` less, but hands count as much as balance.
One bandwidth w and one damping z set all gains.

Source: Wensing and Orin 2013 (task-space control by quadratic programs); Englsberger, Ott and Albu-Schäffer
2015 (capture point tracking); Xu, Tabuada, Grizzle and Ames 2015 (exponential barriers).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pinocchio as pin
import scipy
from numpy.typing import NDArray

from evodesign.control.feedback import Feedback
from evodesign.control.limits import JointLimits
from evodesign.control.moving_body import BodyMotion, MovingBody
from evodesign.control.quadratic import least_squares
from evodesign.control.target import Course, Target
from evodesign.mechanics.balance import GRAVITY
from evodesign.mechanics.contact import Ground, foot_margins
from evodesign.mechanics.floating_base import ROOT

Array = NDArray[np.float64]

LEVEL = 0.01
"""By how much less the next level of importance counts."""

DEPENDENT = 1e-8
"""Rows of strict equations that are dependent to this share are one."""


@dataclass(frozen=True, slots=True, eq=False)
class Command:
    """What a controller answers; v velocities in pinocchio's order, j joints in the agent's.

    Args:
        torques: of the joints [N m], shape (j,).
        acceleration: that it expects, shape (v,).
        feet: wrenches on the feet that it expects, in their sole frames, shape (feet, 6).
        hands: wrenches on the hands that it expects, in world axes, shape (hands, 6).
        reason: why there is no command; empty where there is one, else all above are zero.
    """

    torques: Array
    acceleration: Array
    feet: Array
    hands: Array
    reason: str = ""


@dataclass(frozen=True, slots=True)
class HandShare:
    """What each hand moves of the load: mass [kg], and moment of inertia [kg m^2], zero in a point grasp."""

    mass: float
    inertia: float


class WholeBodyController:
    """Of one agent on feet.

    Args:
        body: of the agent.
        ground: under its feet.
        limits: of its joints, in its order.
        share: what each of its hands moves; None: its hands hold nothing.
        feedback: that sets all gains.
    """

    def __init__(
        self,
        body: MovingBody,
        ground: Ground,
        limits: JointLimits,
        share: HandShare | None,
        feedback: Feedback,
    ) -> None:
        self.body, self._limits, self._share, self._gains = body, limits, share, feedback
        units = [*np.eye(6), np.zeros(6)]
        cones = []
        for foot in body.agent.feet:
            margins = np.array([foot_margins(unit, foot.sole, ground) for unit in units])
            cones.append((margins[:-1] - margins[-1]).T)
            least = margins[-1]
        self._cones = scipy.linalg.block_diag(*cones)
        self._least = np.tile(-least, len(cones))
        self._limited = np.isfinite(limits.torque)
        self._bounded = np.isfinite(limits.lower) | np.isfinite(limits.upper) | np.isfinite(limits.speed)

    def command(self, q: Array, v: Array, target: Target) -> Command:
        """The torques at a state.

        Args:
            q: pinocchio's configuration in the world.
            v: its velocities.
            target: at this moment.
        """
        body, count = self.body.at(q, v), len(v)
        hands, added = self._hands(body, target)
        pulled = sum(
            (hand.jacobian.T @ wrench for hand, wrench in zip(body.hands, hands, strict=True)),
            np.zeros(count),
        )
        soles = np.vstack([foot.jacobian for foot in body.feet])
        mass = self.body.total
        strict = np.block(
            [
                [body.mass[:ROOT] / mass, -soles[:, :ROOT].T],
                [soles, np.zeros((len(soles), len(soles)))],
            ]
        )
        still = np.concatenate([-foot.drift - self._gains.rate * foot.velocity for foot in body.feet])
        sought = np.concatenate([(pulled - body.bias)[:ROOT] / mass, still])
        origin, free = _solutions(strict, sought)
        rows, wanted = self._wanted(body, q, target, added)
        moved = np.hstack([body.mass, -mass * soles.T])[self.body.rates]
        torque_bias = (body.bias - pulled)[self.body.rates]
        bounds, lower, upper = self._bounds(q, v, moved, torque_bias, count)
        rows_free, bounds_free, reached = rows @ free, bounds @ free, bounds @ origin
        found = least_squares(rows_free, wanted - rows @ origin, bounds_free, lower - reached, upper - reached)
        if found.reason:
            nothing = np.zeros(len(self.body.rates)), np.zeros(count), np.zeros((len(body.feet), 6))
            return Command(*nothing, hands, f"no torques keep {self.body.agent.name}'s limits: {found.reason}")
        x = origin + free @ found.x
        feet = (mass * x[count:]).reshape(-1, 6)
        return Command(moved @ x + torque_bias, x[:count], feet, hands)

    def _hands(self, body: BodyMotion, target: Target) -> tuple[Array, list[Array]]:
        """Wrenches on the hands, and what the feedback adds to each one's planned acceleration."""
        if self._share is None:
            return np.zeros((len(body.hands), 6)), []
        masses = np.repeat([self._share.mass, self._share.inertia], 3)
        added = [
            self._gains.acceleration(_off(course, hand.turn, hand.place), course.velocity - hand.velocity)
            for hand, course in zip(body.hands, target.hands, strict=True)
        ]
        return target.hand_wrenches - masses * np.array(added).reshape(-1, 6), added

    def _wanted(self, body: BodyMotion, q: Array, target: Target, added: list[Array]) -> tuple[Array, Array]:
        """Rows A and numbers b of the least squares over accelerations and wrenches per mass."""
        parts = list(self._tasks(body, q, target, added))
        mass, spin = self.body.total, body.spin
        size = 6 * len(body.feet)
        of_accelerations = np.vstack([rows for rows, _ in parts])
        wanted = np.concatenate([numbers for _, numbers in parts])
        scale = LEVEL**1.5 * np.tile(np.repeat([np.sqrt(mass), mass / np.sqrt(spin)], 3), len(body.feet))
        rows = scipy.linalg.block_diag(of_accelerations, np.diag(scale))
        return rows, np.concatenate([wanted, scale * target.feet_wrenches.reshape(size) / mass])

    def _tasks(
        self, body: BodyMotion, q: Array, target: Target, added: list[Array]
    ) -> Iterator[tuple[Array, Array]]:
        gains, center, share = self._gains, body.center, self._share
        height = max(center.place[2] - np.mean([foot.place[2] for foot in body.feet]), 1e-2)
        own = np.sqrt(GRAVITY / height)
        off, slow = target.center.place - center.place, target.center.velocity - center.velocity
        change = gains.acceleration(off, slow)
        change[:2] = gains.frequency * own * off[:2] + (gains.frequency + own) * slow[:2]
        weight = np.sqrt(self.body.total)
        yield weight * center.jacobian, weight * (target.center.acceleration + change - center.drift)
        if share is not None:
            rows = 6 if share.inertia > 0.0 else 3
            scale = np.sqrt(np.repeat([share.mass, share.inertia], 3))[:rows]
            for hand, course, more in zip(body.hands, target.hands, added, strict=True):
                wanted = (course.acceleration + more - hand.drift)[:rows]
                yield scale[:, None] * hand.jacobian[:rows], scale * wanted
        trunk, course, weight = body.trunk, target.trunk, np.sqrt(LEVEL * body.spin)
        turned = _off(course, trunk.turn, trunk.place)[3:]
        turning = gains.acceleration(turned, (course.velocity - trunk.velocity)[3:])
        turning += (course.acceleration - trunk.drift)[3:]
        yield weight * trunk.jacobian[3:], weight * turning
        places, rates = self.body.places, self.body.rates
        wanted = gains.acceleration((target.coordinates - q)[places], (target.velocity - body.velocity)[rates])
        scale = LEVEL * np.sqrt(body.mass[rates, rates])
        posture = np.zeros((len(rates), len(body.velocity)))
        posture[np.arange(len(rates)), rates] = scale
        yield posture, scale * (target.acceleration[rates] + wanted)

    def _bounds(
        self, q: Array, v: Array, moved: Array, torque_bias: Array, count: int
    ) -> tuple[Array, Array, Array]:
        """Rows C with their limits: cones, torques, and accelerations of joints."""
        limits, rates, mass = self._limits, self.body.rates, self.body.total
        cones = np.hstack([np.zeros((len(self._cones), count)), self._cones])
        torque, bias = limits.torque[self._limited], torque_bias[self._limited]
        least, most = limits.accelerations(q[self.body.places], v[rates], self._gains)
        bounded = np.flatnonzero(self._bounded)
        joints = np.zeros((len(bounded), count + self._cones.shape[1]))
        joints[np.arange(len(bounded)), rates[bounded]] = 1.0
        rows = np.vstack([cones, moved[self._limited], joints])
        lower = np.concatenate([self._least / mass, -torque - bias, least[bounded]])
        upper = np.concatenate([np.full(len(cones), np.inf), torque - bias, most[bounded]])
        return rows, lower, upper


def _off(course: Course, turn: Array, place: Array) -> Array:
    """Place [m] and turn [rad] that are missing to a frame's course, in world axes, shape (6,)."""
    return np.concatenate([course.place - place, pin.log3(course.turn @ turn.T)])


def _solutions(rows: Array, numbers: Array) -> tuple[Array, Array]:
    """One solution of independent equations, and an orthonormal basis of what may be added to it."""
    q, r, order = scipy.linalg.qr(rows.T, pivoting=True, check_finite=False)
    sizes = np.abs(np.diagonal(r))
    rank = int(np.count_nonzero(sizes > DEPENDENT * sizes[0]))
    part = scipy.linalg.solve_triangular(r[:rank, :rank], numbers[order[:rank]], trans="T", check_finite=False)
    return q[:, :rank] @ part, q[:, rank:]
