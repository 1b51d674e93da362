"""Which shares of the load's weight its balance lets the robot carry.

    minimise, maximise    s = sum_robot f_z / m g        over the hands' forces and moments on the load
    subject to            the load's balance, |push| <= its limit, every hand's moment within its limit

With point grasps at one height the lever rule leaves a single share; rigid grasps leave an interval, which
grows with the moment that a hand may transmit.
"""

from __future__ import annotations

import numpy as np
import scipy
from numpy.typing import NDArray

from evodesign.mechanics.agent import Agent, Contact, Role
from evodesign.mechanics.balance import GRAVITY
from evodesign.mechanics.payload import Grasp
from evodesign.mechanics.scene import Scene

Array = NDArray[np.float64]

FAR = 10.0
"""Shares below -10 or above 10 are not looked at."""


def share_interval(scene: Scene) -> tuple[float, float]:
    """Least and largest share of the load's weight that the robot can carry [-]: one where they agree."""
    payload = scene.payload
    weight = payload.mass * GRAVITY
    largest = 0.0 if payload.grasp is Grasp.POINT else payload.hand_moment
    hands = [(agent, hand) for agent in scene.agents for hand in agent.hands]
    balance = np.hstack([_on_load(scene, agent, hand) for agent, hand in hands])
    loaded = weight * np.array([0.0, 0.0, 1.0, *np.cross(payload.center_of_mass, [0.0, 0.0, 1.0])])
    carried, push = (_of_robots(hands, row) for row in (2, 0))
    outcomes = [
        scipy.optimize.linprog(
            sign * carried,
            A_ub=np.vstack([push, -push, carried, -carried]),
            b_ub=[scene.stance.push, scene.stance.push, FAR * weight, FAR * weight],
            A_eq=balance,
            b_eq=loaded,
            bounds=([(None, None)] * 3 + [(-largest, largest)] * 3) * len(hands),
        )
        for sign in (1.0, -1.0)
    ]
    if not all(outcome.success for outcome in outcomes):
        return (FAR, -FAR)  # no share at all balances the load
    low, high = (float(carried @ outcome.x) / weight for outcome in outcomes)
    return low, high


def _on_load(scene: Scene, agent: Agent, hand: Contact) -> Array:
    """Force and moment on the load (world, box's centre) of a hand's force and moment, shape (6, 6)."""
    x, y, z = agent.turn @ scene.payload.grasp_point(agent, hand)
    lever = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.block([[np.eye(3), np.zeros((3, 3))], [lever, np.eye(3)]])


def _of_robots(hands: list[tuple[Agent, Contact]], row: int) -> Array:
    """Sums one component of the force over the hands of robots, shape (6 x hands,)."""
    picked = np.zeros(6)
    picked[row] = 1.0
    return np.concatenate([picked * (agent.role is Role.ROBOT) for agent, _ in hands])
