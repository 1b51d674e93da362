"""How an agent stands that is about to walk with the load: from a hold, by inverse kinematics.

Hands and load stay where they are, but

    feet         stand under the hips, parallel, about the point in which the floor's pressure acts
    body         moves to the side until that point is in the middle between both hands
    height       is that in which a knee is bent by `KNEE` at the end of a step
    trunk, root  look ahead, as inclined as in the hold

Steps of least squares within the ranges of joints, which are drawn to the hold's; steps are damped by what is
missing.

Source: Sugihara 2011, Solvability-unconcerned inverse kinematics by the Levenberg-Marquardt method.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from evodesign.control.controller import LEVEL
from evodesign.control.limits import JointLimits
from evodesign.control.moving_body import BodyMotion, MovingBody
from evodesign.control.quadratic import least_squares
from evodesign.control.target import Course, Target
from evodesign.mechanics.agent import SIDES, TO_THE_LEFT, Agent
from evodesign.mechanics.balance import GRAVITY
from evodesign.mechanics.floating_base import ROOT

Array = NDArray[np.float64]

KNEE = math.radians(10.0)
"""Flexion of a knee when its leg is stretched as far as a step asks."""

REACH = (0.75, -0.5)
"""How far a hip moves along the way from where it stands above its foot, of a step: until the foot leaves the
floor behind it, and from where the foot lands before it."""

GAP = 0.03
"""Between the soles' edges at least [m]."""

WITHIN = 5e-3
"""How far feet and hands may be from where they shall be [m]."""

DAMPING = 0.03
"""Of a step of the inverse kinematics, beside a hundredth of what is missing."""

STEPS, LARGEST, CONVERGED = 200, 0.3, 1e-5
"""Of the inverse kinematics: how many steps at most; the largest of a joint, and that of the last [rad]."""


@dataclass(frozen=True, slots=True, eq=False)
class ReadyStance:
    """How an agent stands that is about to walk.

    Args:
        target: at rest.
        pressure: where the floor's pressure acts, amid the feet [m], shape (2,).
        weight: what the feet carry together [N].
        pendulum: height of the centre of mass of body and carried load [m].
        reason: why it cannot stand so; empty where it can.
    """

    target: Target
    pressure: Array
    weight: float
    pendulum: float
    reason: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class _Places:
    """Where everything shall be, in the world [m], and how trunk and root link shall be turned.

    Args:
        soles: shape (3,) each.
        center: of mass, shape (2,).
        height: of the root link.
        trunk: its turn, shape (3, 3).
        root: likewise.
    """

    soles: tuple[Array, ...]
    center: Array
    height: float
    trunk: Array
    root: Array


def ready_stance(body: MovingBody, hold: Target, limits: JointLimits, stride: Array) -> ReadyStance:
    """How an agent stands that is about to walk.

    Args:
        body: of the agent.
        hold: of the plan.
        limits: of its joints.
        stride: a step along the way [m], shape (2,).
    """
    motion, still = body.at(hold.coordinates, hold.velocity), np.zeros(body.size)
    weight = float(body.total * GRAVITY - hold.hand_wrenches[:, 2].sum())
    pressure = _pressure(motion, hold, body.total, weight)
    left = body.agent.turn[:2, 1]
    hands = [hand.place[:2] for hand in motion.hands]
    middle = np.mean(hands, axis=0) if len(hands) == len(SIDES) else pressure
    aside = (middle - pressure) @ left * left
    center = motion.center.place[:2] + aside * weight / (body.total * GRAVITY)
    places = replace(_places(body, motion, hold, stride, pressure + aside), center=center)
    q = _solved(body, hold, limits, places)
    found = body.at(q, still)
    carried = -hold.hand_wrenches[:, 2] / GRAVITY @ [hand.place[2] for hand in found.hands]
    force = np.array([*-hold.hand_wrenches[:, :2].sum(axis=0), weight]) / len(places.soles)
    return ReadyStance(
        target=replace(
            hold,
            coordinates=q,
            center=Course.of(found.center, still),
            trunk=Course.of(found.trunk, still),
            hands=tuple(Course.of(hand, still) for hand in found.hands),
            feet_wrenches=np.tile([*body.agent.turn.T @ force, 0.0, 0.0, 0.0], (len(places.soles), 1)),
        ),
        pressure=pressure + aside,
        weight=weight,
        pendulum=float(body.total * found.center.place[2] + carried) * GRAVITY / weight,
        reason=_unmet(body.agent, hold, found, places),
    )


def _pressure(motion: BodyMotion, hold: Target, mass: float, weight: float) -> Array:
    """Where the floor's pressure acts at rest [m], shape (2,): it balances gravity and what hands carry."""
    moment = np.cross(motion.center.place, [0.0, 0.0, -mass * GRAVITY])
    for hand, wrench in zip(motion.hands, hold.hand_wrenches, strict=True):
        moment += np.cross(hand.place, wrench[:3]) + wrench[3:]
    return np.array([moment[1], -moment[0]]) / weight


def _places(body: MovingBody, motion: BodyMotion, hold: Target, stride: Array, pressure: Array) -> _Places:
    """Where everything shall be, with the soles about a point [m], shape (2,)."""
    agent, legs, soles, lowered = body.agent, body.legs(hold.coordinates), [], -math.inf
    left = agent.turn[:2, 1]
    middle = np.mean([leg.top[:2] for leg in legs], axis=0)
    for leg, foot, contact in zip(legs, motion.feet, agent.feet, strict=True):
        half = max(abs((leg.top[:2] - middle) @ left), (contact.sole.width + GAP) / 2.0)
        soles.append(np.append(pressure + TO_THE_LEFT[contact.side] * half * left, 0.0))
        ankle = soles[-1] + agent.turn @ foot.turn.T @ (leg.ankle - foot.place)
        off = (leg.hip - ankle)[:2] - (middle - pressure) @ left * left
        far = max(float(np.linalg.norm(off + share * stride)) for share in REACH)
        span = math.sqrt(max(leg.span(KNEE) ** 2 - far**2, 0.0))
        lowered = max(lowered, leg.hip[2] - ankle[2] - span)
    root = pin.Quaternion(hold.coordinates[3:7]).toRotationMatrix()
    return _Places(
        tuple(soles),
        motion.center.place[:2],
        float(hold.coordinates[2]) - lowered,
        _ahead(agent, motion.trunk.turn),
        _ahead(agent, root),
    )


def _ahead(agent: Agent, turn: Array) -> Array:
    """A frame's turn in the world, without roll and yaw against its agent's."""
    pitch = pin.rpy.matrixToRpy(agent.turn.T @ turn)[1]
    return np.asarray(agent.turn @ pin.rpy.rpyToMatrix(0.0, pitch, 0.0))


def _solved(body: MovingBody, hold: Target, limits: JointLimits, places: _Places) -> Array:
    """The configuration that comes nearest to what shall be."""
    q, still, count = hold.coordinates.copy(), np.zeros(body.size), len(body.rates)
    lower, upper = limits.lower.copy(), limits.upper.copy()
    for leg in body.legs(q):  # a straight leg could not tell how to bend
        knee = leg.knee_joint
        if upper[knee] > -lower[knee]:
            lower[knee] = max(lower[knee], KNEE)
        else:
            upper[knee] = min(upper[knee], -KNEE)
    q[body.places] = np.clip(q[body.places], lower, upper)
    own = np.zeros((count, body.size))
    own[range(count), body.rates] = 1.0
    for _ in range(STEPS):
        joints, tasks = q[body.places], list(_tasks(body, body.at(q, still), q, hold, places))
        off = [weight * missing for weight, _, missing in tasks]
        damping = (DAMPING + LEVEL * np.linalg.norm(np.concatenate(off))) * np.eye(body.size)
        rows = np.vstack([*(weight * jacobian for weight, jacobian, _ in tasks), LEVEL * own, damping])
        off += [LEVEL * (hold.coordinates[body.places] - joints), np.zeros(body.size)]
        room = np.minimum(lower - joints, 0.0), np.maximum(upper - joints, 0.0)
        step = least_squares(rows, np.concatenate(off), own, *room).x
        largest = float(np.abs(step).max())
        q = body.moved(q, step * min(1.0, LARGEST / max(largest, LARGEST)))
        if largest < CONVERGED:
            break
    return q


def _tasks(
    body: MovingBody, motion: BodyMotion, q: Array, hold: Target, places: _Places
) -> Iterator[tuple[float, Array, Array]]:
    """Weights, Jacobians and what is missing: soles and hands first, then balance, trunk and root."""
    for foot, place in zip(motion.feet, places.soles, strict=True):
        off, turn = foot.turn.T @ (place - foot.place), pin.log3(foot.turn.T @ body.agent.turn)
        yield 1.0 / LEVEL, foot.jacobian, np.concatenate([off, turn])
    for hand, held in zip(motion.hands, hold.hands, strict=True):
        yield 1.0 / LEVEL, hand.jacobian[:3], held.place - hand.place
        yield LEVEL**0.5, hand.jacobian[3:], pin.log3(held.turn @ hand.turn.T)
    yield 1.0, motion.center.jacobian[:2], places.center - motion.center.place[:2]
    yield LEVEL**0.5, motion.trunk.jacobian[3:], pin.log3(places.trunk @ motion.trunk.turn.T)
    root, rows = pin.Quaternion(q[3:7]).toRotationMatrix(), np.zeros((ROOT, body.size))
    rows[:3, :3], rows[3:, 3:ROOT] = root, np.eye(3)
    yield 1.0, rows[2:3], np.array([places.height - q[2]])
    yield LEVEL**0.5, rows[3:], pin.log3(root.T @ places.root)


def _unmet(agent: Agent, hold: Target, found: BodyMotion, places: _Places) -> str:
    """Why an agent cannot stand so, a sentence; empty where it can."""
    pairs = {
        "feet": [(foot.place, place) for foot, place in zip(found.feet, places.soles, strict=True)],
        "hands": [(hand.place, held.place) for hand, held in zip(found.hands, hold.hands, strict=True)],
    }
    for what, places_of in pairs.items():
        off = max((float(np.linalg.norm(one - other)) for one, other in places_of), default=0.0)
        if not off <= WITHIN:
            return f"{agent.name} cannot stand ready to walk: its {what} would be {100.0 * off:.1f} cm off"
    return ""
