"""The joint feedback of a simulation: gains from one natural frequency and each joint's own inertia.

    k = w^2 I        d = 2 z w I

so that every joint by itself, all others locked, is an oscillator of natural frequency w and damping ratio z.
I is the inertia about the joint's axis of what the joint moves in a stance: beyond a joint of the legs lies
the rest of the body, which both legs share; beyond any other joint what hangs on it. A quarter of the load
counts as a point mass at each hand.

An upright body of height l needs w^2 > g / l to stand by feedback of its ankles at all: w > 3.5 rad/s.

Source: Craig, Introduction to Robotics (2005), section 9.5 (gains of a joint's control from its inertia).
"""

from __future__ import annotations

import mujoco
import numpy as np

from evodesign.control.gains import Feedback
from evodesign.mechanics.floating_base import ROOT
from evodesign.posture.results import Array
from evodesign.simulation.model import AgentParts, SimulatedScene


def joint_inertias(found: SimulatedScene, parts: AgentParts) -> Array:
    """Inertia I about each of an agent's joints in the posture that the data hold [kg m^2], shape (j,)."""
    model, data = found.model, found.data
    mass = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, mass)
    holding = sum(len(each.hands) for each in found.agents.values())
    at_hand = float(model.body_mass[found.load]) / max(holding, 1)
    for hand in parts.hands.values():
        jacobian = np.zeros((3, model.nv))
        mujoco.mj_jacSite(model, data, jacobian, None, hand)
        mass += at_hand * jacobian.T @ jacobian
    inertias = mass[parts.rates, parts.rates].copy()
    free = int(model.body_dofadr[parts.root])
    for place, joint in enumerate(parts.rates):
        if _carries_a_sole(model, parts, int(model.dof_bodyid[joint])):
            still = _all_but_what_is_beyond(found, parts, int(joint), free)
            inertias[place] = still @ mass @ still / 2.0
    return np.asarray(inertias)


def _carries_a_sole(model: mujoco.MjModel, parts: AgentParts, body: int) -> bool:
    """Whether a sole is on a body or beyond it."""
    for geom in parts.soles.values():
        above = int(model.geom_bodyid[geom])
        while above > body:
            above = int(model.body_parentid[above])
        if above == body:
            return True
    return False


def _all_but_what_is_beyond(found: SimulatedScene, parts: AgentParts, joint: int, free: int) -> Array:
    """Velocities with which the body turns about a joint's axis while what is beyond stays in place."""
    model, data = found.model, found.data
    number = int(model.dof_jntid[joint])
    axis, anchor = data.xaxis[number], data.xanchor[number]
    velocity = np.zeros(model.nv)
    velocity[free : free + 3] = np.cross(axis, data.xpos[parts.root] - anchor)
    velocity[free + 3 : free + ROOT] = data.xmat[parts.root].reshape(3, 3).T @ axis
    velocity[joint] = -1.0
    return velocity


def set_damping(found: SimulatedScene, parts: AgentParts, inertias: Array, feedback: Feedback) -> None:
    """Give an agent's actuators the damping of a feedback, taken at the end of a step.

        (M + h d) (v' - v) / h = f + u - d v        is        M (v' - v) / h = f + u - d v'

    with h d in each joint's inertia, which is of no body.

    Source: Tan, Liu and Turk 2011, Stable proportional-derivative controllers.
    """
    model, damping = found.model, feedback.rate * inertias
    model.actuator_biasprm[parts.actuators, 2] = -damping
    model.dof_armature[parts.rates] += model.opt.timestep * damping


def set_gains(found: SimulatedScene, feedback: Feedback) -> None:
    """Give the model's actuators the gains of a feedback, from the inertias in its present posture."""
    for parts in found.agents.values():
        inertias = joint_inertias(found, parts)
        found.model.actuator_biasprm[parts.actuators, 1] = -(feedback.frequency**2) * inertias
        set_damping(found, parts, inertias, feedback)
