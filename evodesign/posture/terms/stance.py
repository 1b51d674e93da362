"""What binds an agent to the load, the ground and a natural stance.

These are the constraints of the paper's Eq. 14 (c to g: hands on the load, feet on the ground and flat), made
well posed: "flat" is two vanishing entries of the sole's rotation rather than one entry equal to one (whose
gradient vanishes at the solution), and unilateral contact, friction and the stance are enforced.

All are expressions over an agent's frames in its own frame, for the sides that its form describes.

Source: Sartore et al. 2022, Eq. 14; DESIGN 3.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import casadi as ca
import numpy as np

from evodesign.mechanics.contact import foot_margins
from evodesign.mechanics.scene import SIDES, Agent, Scene
from evodesign.nlp.program import Constraint
from evodesign.posture.symmetry import Form
from evodesign.tree.kinematics import Pose, vector

__all__ = ["equal", "foot_contact", "foot_flat", "foot_yaw", "hand_constraints", "stance_constraints"]

Expression = Any

MARGIN_UNIT = 100.0  # [N] and [N m] per unit of a foot's margin


def equal(name: str, expression: Expression) -> Constraint:
    """Rows that must vanish."""
    return Constraint(name, expression, 0.0, 0.0)


def hand_constraints(
    form: Form, poses: Mapping[str, Pose], scene: Scene, height: Expression
) -> list[Constraint]:
    """Hands on their grasp points (Eq. 14 c and d)."""
    agent, lift = form.agent, ca.vertcat(0.0, 0.0, height)
    return [
        equal(
            f"{agent.name}.{side}_hand_on_load",
            poses[agent.hands[side]].position - vector(scene.payload.grasp_point(agent, side)) - lift,
        )
        for side in form.sides
    ]


def foot_flat(agent: Agent, poses: Mapping[str, Pose], side: str) -> Constraint:
    """A sole on the ground, and flat (Eq. 14 e to g)."""
    sole = poses[agent.soles[side]]
    level = ca.vertcat(sole.position[2], sole.rotation[0, 2], sole.rotation[1, 2])
    return equal(f"{agent.name}.{side}_foot_flat", level)


def foot_yaw(agent: Agent, poses: Mapping[str, Pose], side: str, scene: Scene) -> Constraint:
    """A foot that is not turned far."""
    yaw = math.sin(scene.stance.foot_yaw)
    return Constraint(f"{agent.name}.{side}_foot_yaw", poses[agent.soles[side]].rotation[1, 0], -yaw, yaw)


def foot_contact(name: str, side: str, wrench: Expression, agent: Agent, scene: Scene) -> Constraint:
    """A foot that presses as the ground allows.

    Args:
        name: begins the constraint's name.
        side: of the foot.
        wrench: force [N] and moment [N m] on it, in the sole frame.
        agent: whose foot it is.
        scene: for the ground.
    """
    margins = ca.vertcat(*foot_margins(wrench, agent.sole_size, scene.ground)) / MARGIN_UNIT
    return Constraint(f"{name}.{side}_foot_contact", margins, 0.0, np.inf)


def stance_constraints(form: Form, poses: Mapping[str, Pose], scene: Scene) -> list[Constraint]:
    """Feet neither too near nor too far apart, and the trunk clear of the load."""
    agent, stance = form.agent, scene.stance
    soles = [poses[agent.soles[side]].position for side in form.sides]
    nearest = -scene.payload.size[0] / 2.0 - stance.trunk_clearance
    trunk = ca.vertcat(*[poses[frame].position[0] for frame in form.trunk])
    constraints = [Constraint(f"{agent.name}.trunk_clear", trunk, -np.inf, nearest)] if form.trunk else []
    if form.sides != SIDES:  # the right sole is the left one's mirror image
        return [*constraints, Constraint(f"{agent.name}.feet_apart", 2.0 * soles[0][1], *stance.feet_apart)]
    apart, stagger = soles[0][1] - soles[1][1], soles[0][0] - soles[1][0]
    return [
        *constraints,
        Constraint(f"{agent.name}.feet_apart", apart, *stance.feet_apart),
        Constraint(f"{agent.name}.feet_stagger", stagger, -stance.feet_stagger, stance.feet_stagger),
    ]
