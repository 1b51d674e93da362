"""What MuJoCo's contacts and grasps pass on, as evodesign tells wrenches.

    foot   sum of the forces of the floor's contacts with the sole, and of their moments about its origin
    hand   J_load^T f of the grasp's rows: its generalised force on the load, moved to the grasp point

Source: MuJoCo computation chapter (constraint forces J^T f; `mj_contactForce`).
"""

from __future__ import annotations

import mujoco
import numpy as np

from evodesign.posture.results import Array
from evodesign.simulation.model import AgentParts, SimulatedScene


def foot_wrenches(found: SimulatedScene, parts: AgentParts) -> Array:
    """On each foot, force [N] and moment [N m], in the sole frame, shape (feet, 6)."""
    model, data = found.model, found.data
    rows = {geom: row for row, geom in enumerate(parts.soles.values())}
    wrenches = np.zeros((len(rows), 6))
    for number in range(data.ncon):
        contact, force = data.contact[number], np.zeros(6)
        row = rows.get(int(contact.geom[1]))
        if row is None:
            continue
        mujoco.mj_contactForce(model, data, number, force)
        in_world = contact.frame.reshape(3, 3).T @ force[:3]
        sole = int(contact.geom[1])
        turn = data.geom_xmat[sole].reshape(3, 3)
        lever = contact.pos - found.sole_origin(sole)
        wrenches[row] += np.r_[turn.T @ in_world, turn.T @ np.cross(lever, in_world)]
    return wrenches


def hand_wrenches(found: SimulatedScene, parts: AgentParts) -> Array:
    """On each hand, in the agent's frame and about the grasp point, likewise."""
    model, data = found.model, found.data
    first = int(model.body_dofadr[found.load])
    grasps = data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY
    agent_from_world = parts.agent.turn.T
    wrenches = np.zeros((len(parts.hands), 6))
    for row, (hand, site) in enumerate(parts.hands.items()):
        number = model.equality(f"{parts.agent.name}/{hand}").id
        mine = grasps & (data.efc_id == number)
        whole = np.zeros(model.nv)
        mujoco.mj_mulJacTVec(model, data, whole, np.where(mine, data.efc_force, 0.0))
        force, moment = np.split(whole[first : first + 6], 2)
        moment = data.xmat[found.load].reshape(3, 3) @ moment  # a free body turns in its own axes
        lever = data.site_xpos[site] - data.xpos[found.load]
        moment = moment - np.cross(lever, force)
        wrenches[row] = np.r_[-agent_from_world @ force, -agent_from_world @ moment]
    return wrenches
