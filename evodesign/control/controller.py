"""A whole-body controller: the torques of one agent at one moment, from its state and its part of a plan.

Unknown are the accelerations a of the body and the wrenches f of its feet; torques follow from both,

    tau = M_j a + h_j - J_feet,j' f - J_hands,j' F

Strict are the motion of the root link (the same rows of the equation of motion without a torque), soles of
feet that stand, which stay where they are, friction, centres of pressure (`mechanics.contact`), limits of
torques, and the ranges of joints and their speeds as limits of their accelerations,

    a >= -w^2 (q - q_min) - 2 z w v,     a >= -2 z w (v + v_max),     and likewise above,

so that a joint nears the end of its range like a critically damped oscillator; where no accelerations keep
all of these, ranges and speeds give way as little as can be. A sole that moves or tilts is brought to rest
flat on the floor. Within these, least squares of what is wanted, in the masses and inertias that it moves:

    soles     of feet that swing, along their courses, as much faster as soles come to rest
    balance   of the centre of mass c, with capture point c + v / w0 and w0 = sqrt(g / height):
              horizontally  a_plan + w w0 (c_plan - c) + (w + w0) (v_plan - v),  upwards as all below
    hands     each of n hands carries m/n of the load: a_plan + w^2 (x_plan - x) + 2 z w (v_plan - v), and the
              wrench F = F_plan - m/n (what the feedback adds), which is an impedance of the load
    trunk     its turn, likewise
    posture   joints, likewise
    wrenches  of the feet, as planned; internal ones, with which feet work against each other and which move
              nothing, count as much as balance: a controller that is at its limits would else turn feet
              against each other to their limits of friction for the least gain, and change its mind in
              every answer

The order is that of importance: what stands lower counts by `LEVEL` less, but hands count as much as balance.
One bandwidth w and one damping z set all gains.

Source: Wensing and Orin 2013 (task-space control by quadratic programs); Englsberger, Ott and Albu-Schäffer
2015 (capture point tracking); Xu, Tabuada, Grizzle and Ames 2015 (exponential barriers).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray
from scipy.linalg import lapack

from evodesign.control.gains import Feedback
from evodesign.control.limits import JointLimits
from evodesign.control.moving_body import BodyMotion, FrameMotion, MovingBody
from evodesign.control.quadratic import least_squares
from evodesign.control.support import supports_of
from evodesign.control.target import Course, Target
from evodesign.mechanics.balance import GRAVITY
from evodesign.mechanics.contact import Ground
from evodesign.mechanics.floating_base import ROOT

Array = NDArray[np.float64]

LEVEL = 0.01
"""By how much less the next level of importance counts."""

SOLES_FIRST = 3.0
"""Soles come to rest as much faster than all else: an inner loop is three times as fast as the outer one."""

LOW = 0.01
"""Height of the centre of mass above the soles [m] that is the least of those who stand or fall."""

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
        capture: horizontal distance of the capture point from the planned one [m], shape (2,).
        reason: why there is no command; empty where there is one, else all above are zero.
    """

    torques: Array
    acceleration: Array
    feet: Array
    hands: Array
    capture: Array
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
        self.body, self.limits, self._share, self._gains = body, limits, share, feedback
        self._soles = replace(feedback, frequency=SOLES_FIRST * feedback.frequency)
        self._limited = np.flatnonzero(np.isfinite(limits.torque))
        self._bounded = np.flatnonzero(
            np.isfinite(limits.lower) | np.isfinite(limits.upper) | np.isfinite(limits.speed)
        )
        self._count = body.size
        self._supports = supports_of(body, ground, self._limited, self._bounded)

    def command(self, q: Array, v: Array, target: Target) -> Command:
        """The torques at a state.

        Args:
            q: pinocchio's configuration in the world.
            v: its velocities.
            target: at this moment.
        """
        body, count, rates = self.body.at(q, v), self._count, self.body.rates
        support = self._supports[target.stance]
        standing = [body.feet[foot] for foot in support.feet]
        hands, added = self._hands(body, target)
        capture = _capture(body, target)
        force = body.bias.copy()
        for hand, wrench in zip(body.hands, hands, strict=True):
            force -= hand.jacobian.T @ wrench
        total = self.body.total
        wrenches = 6 * len(standing)
        motion = np.empty((count, count + wrenches))
        motion[:, :count] = body.mass
        strict, sought = np.zeros((ROOT + wrenches, motion.shape[1])), np.empty(ROOT + wrenches)
        for place, foot in zip(range(0, wrenches, 6), standing, strict=True):
            motion[:, count + place : count + place + 6] = -total * foot.jacobian.T
            strict[ROOT + place : ROOT + place + 6, :count] = foot.jacobian
            sought[ROOT + place : ROOT + place + 6] = self._flattening(foot) - foot.drift
        strict[:ROOT], sought[:ROOT] = motion[:ROOT] / total, -force[:ROOT] / total
        origin, free = _solutions(strict, sought)
        rows, wanted = self._wanted(body, q, target, added)
        bounds = support.bounds.copy()
        bounds[support.torques] = motion[rates[self._limited]]
        lower, upper = self._ends(q, v, force[rates], support.least)
        reached = bounds @ origin
        program = rows @ free, wanted - rows @ origin
        limits = bounds @ free, lower - reached, upper - reached
        found = least_squares(*program, *limits)
        if found.reason:
            found = least_squares(*program, *limits, yielding=len(self._bounded))
        if found.reason:
            nothing = np.zeros(len(rates)), np.zeros(count), np.zeros((len(body.feet), 6))
            return Command(
                *nothing, hands, capture, f"no torques keep {self.body.agent.name}'s limits: {found.reason}"
            )
        x = origin + free @ found.x
        feet = np.zeros((len(body.feet), 6))
        feet[list(support.feet)] = (total * x[count:]).reshape(-1, 6)
        return Command(motion[rates] @ x + force[rates], x[:count], feet, hands, capture)

    def _flattening(self, sole: FrameMotion) -> Array:
        """Acceleration that brings a sole to rest, flat on the floor, in its own axes, shape (6,)."""
        up = sole.turn[2]
        return self._soles.acceleration(
            np.array([*(-sole.place[2] * up), -up[1], up[0], 0.0]), -sole.velocity
        )

    def _swinging(self, sole: FrameMotion, course: Course) -> Array:
        """Acceleration that brings a sole to its course, in its own axes, shape (6,)."""
        axes = np.kron(np.eye(2), sole.turn.T)
        off = axes @ _off(course, sole), axes @ course.velocity - sole.velocity
        wanted = axes @ course.acceleration + self._soles.acceleration(*off)
        wanted[:3] -= np.cross(sole.velocity[3:], sole.velocity[:3])  # its axes turn
        return wanted

    def _hands(self, body: BodyMotion, target: Target) -> tuple[Array, list[Array]]:
        """Wrenches on the hands, and what the feedback adds to each one's planned acceleration."""
        if self._share is None:
            return np.zeros((len(body.hands), 6)), []
        masses = np.repeat([self._share.mass, self._share.inertia], 3)
        added = [
            self._gains.acceleration(_off(course, hand), course.velocity - hand.velocity)
            for hand, course in zip(body.hands, target.hands, strict=True)
        ]
        return target.hand_wrenches - masses * np.array(added).reshape(-1, 6), added

    def _wanted(self, body: BodyMotion, q: Array, target: Target, added: list[Array]) -> tuple[Array, Array]:
        """Rows A and numbers b of the least squares over accelerations and wrenches per mass."""
        rates, count, mass = self.body.rates, self._count, self.body.total
        tasks = list(self._tasks(body, target, added))
        size = sum(len(numbers) for _, numbers in tasks)
        wanted, places, stance = [numbers for _, numbers in tasks], self.body.places, list(target.stance)
        standing = [body.feet[foot] for foot in stance]
        rows = np.zeros((size + len(rates) + 6 * len(standing), count + 6 * len(standing)))
        np.concatenate([task for task, _ in tasks], out=rows[:size, :count])
        scale = LEVEL * np.sqrt(body.mass[rates, rates])
        rows[range(size, size + len(rates)), rates] = scale
        posture = self._gains.acceleration(
            (target.coordinates - q)[places], (target.velocity - body.velocity)[rates]
        )
        wanted.append(scale * (target.acceleration[rates] + posture))
        scale = np.tile(np.repeat([mass**0.5, mass / body.spin**0.5], 3), len(standing))
        wrenches = wrench_weights(standing, scale) * scale
        rows[size + len(rates) :, count:] = wrenches
        wanted.append(wrenches @ target.feet_wrenches[stance].ravel() / mass)
        return rows, np.concatenate(wanted)

    def _tasks(self, body: BodyMotion, target: Target, added: list[Array]) -> Iterator[tuple[Array, Array]]:
        """Of swing feet, centre of mass, hands and trunk: rows over accelerations, and numbers."""
        gains, center, share = self._gains, body.center, self._share
        scale = np.sqrt(np.repeat([self.body.total, body.spin], 3) / LEVEL)
        for foot, swing in target.swings.items():
            sole = body.feet[foot]
            yield scale[:, None] * sole.jacobian, scale * (self._swinging(sole, swing) - sole.drift)
        own = _pendulum(body, target.stance)
        off, slow = target.center.place - center.place, target.center.velocity - center.velocity
        change = gains.acceleration(off, slow)
        change[:2] = gains.frequency * own * off[:2] + (gains.frequency + own) * slow[:2]
        weight = math.sqrt(self.body.total)
        yield weight * center.jacobian, weight * (target.center.acceleration + change - center.drift)
        if share is not None:
            rows = 6 if share.inertia > 0.0 else 3
            scale = np.sqrt(np.repeat([share.mass, share.inertia], 3))[:rows]
            for hand, course, more in zip(body.hands, target.hands, added, strict=True):
                wanted = (course.acceleration + more - hand.drift)[:rows]
                yield scale[:, None] * hand.jacobian[:rows], scale * wanted
        trunk, course, weight = body.trunk, target.trunk, math.sqrt(LEVEL * body.spin)
        turning = gains.acceleration(_off(course, trunk), course.velocity - trunk.velocity)
        turning += course.acceleration - trunk.drift
        yield weight * trunk.jacobian[3:], weight * turning[3:]

    def _ends(self, q: Array, v: Array, bias: Array, cones: Array) -> tuple[Array, Array]:
        """Lower and upper limits of cones, torques, and accelerations of joints."""
        limits = self.limits
        torque, bias = limits.torque[self._limited], bias[self._limited]
        least, most = limits.accelerations(q[self.body.places], v[self.body.rates], self._gains)
        lower = np.concatenate([cones, -torque - bias, least[self._bounded]])
        upper = np.concatenate([np.full(len(cones), np.inf), torque - bias, most[self._bounded]])
        return lower, upper


def wrench_weights(feet: Sequence[FrameMotion], scale: Array) -> Array:
    """Weights of the feet's wrenches: one of internal ones, which move nothing, and little of the others.

    Args:
        feet: that stand.
        scale: of each number of the wrenches, shape (w,).
    Returns:
        A symmetric matrix, shape (w, w).
    """
    moving = np.hstack([foot.jacobian[:, :ROOT].T for foot in feet]) / scale
    share = moving.T @ np.linalg.solve(moving @ moving.T, moving)
    return np.asarray(np.eye(len(scale)) - (1.0 - LEVEL**1.5) * share)


def _pendulum(body: BodyMotion, stance: tuple[int, ...]) -> float:
    """Rate w0 at which the centre of mass falls away from above the feet that stand [1/s]."""
    height = body.center.place[2] - sum(body.feet[foot].place[2] for foot in stance) / len(stance)
    return math.sqrt(GRAVITY / max(height, LOW))


def _capture(body: BodyMotion, target: Target) -> Array:
    """Horizontal distance of the capture point from the planned one [m], shape (2,)."""
    off, faster = body.center.place - target.center.place, body.center.velocity - target.center.velocity
    return np.asarray((off + faster / _pendulum(body, target.stance))[:2])


def _off(course: Course, frame: FrameMotion) -> Array:
    """Place [m] and turn [rad] that are missing to a frame's course, in world axes, shape (6,)."""
    return np.concatenate([course.place - frame.place, pin.log3(course.turn @ frame.turn.T)])


def _solutions(rows: Array, numbers: Array) -> tuple[Array, Array]:
    """One solution of equations, and an orthonormal basis of what may be added to it, by QR with pivoting."""
    count, size = rows.shape
    whole = np.zeros((size, size), order="F")
    whole[:, :count], order, factors, _, _ = lapack.dgeqp3(rows.T)
    sizes = np.abs(np.diagonal(whole))[:count]
    rank = int(np.count_nonzero(sizes > DEPENDENT * sizes[0]))
    part = lapack.dtrtrs(whole[:rank, :rank], numbers[order[:rank] - 1], trans=1)[0]
    basis = lapack.dorgqr(whole, factors, overwrite_a=True)[0]
    return basis[:, :rank] @ part, basis[:, rank:]
