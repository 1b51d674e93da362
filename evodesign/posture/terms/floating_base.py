"""How an agent stands: its base and joints, and everything that binds them whatever it bears.

Everything is expressed in the agent's own frame (it looks along +x at the load above the origin), so robot
and person share every line, and so do whole agents and the halves of symmetric ones (`Form`).

Source: Sartore et al. 2022, Eq. 14 c to g; DESIGN 3.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Set
from dataclasses import dataclass
from typing import Any

import casadi as ca

from evodesign.mechanics.scene import Agent, Scene
from evodesign.nlp.program import Constraint, Variable
from evodesign.posture.symmetry import Form
from evodesign.posture.terms.stance import foot_flat, foot_yaw, hand_constraints, stance_constraints
from evodesign.tree.kinematics import Pose, euler_rotation, forward
from evodesign.tree.model import Tree

__all__ = ["COMFORT", "Stand", "stand_of"]

Expression = Any

COMFORT = 1e-2
"""Weight of what is slightly disliked beside a lifted torque."""


@dataclass(frozen=True, slots=True)
class Stand:
    """The part of a program that says how an agent stands.

    Args:
        form: all of the agent, or its left half.
        part: the links and joints that the form holds, resized by a design; numbers or expressions.
        doubled: joints of the part whose branch stands for its mirror image too.
        poses: of the part's links, in the agent's frame.
        variables: base and joints.
        hands: constraints that keep the hands on the load.
        flat, yaw: constraints on each foot, by side.
        stance: constraints that keep the posture a natural one.
        comfort: small convex cost that makes the posture unique where torques do not.
        uprights: z_sole . z by side; 1 for a flat foot, -1 for one upside down, which joint limits rule out.
    """

    form: Form
    part: Tree
    doubled: Set[str]
    poses: Mapping[str, Pose]
    variables: tuple[Variable, ...]
    hands: tuple[Constraint, ...]
    flat: Mapping[str, Constraint]
    yaw: Mapping[str, Constraint]
    stance: tuple[Constraint, ...]
    comfort: Expression
    uprights: Mapping[str, Expression]


def stand_of(form: Form, tree: Tree, scene: Scene, height: Expression) -> Stand:
    """Variables and constraints of an agent's posture.

    Args:
        form: all of the agent, or its left half.
        tree: the agent's whole tree, resized by a design; numbers or expressions.
        scene: load, ground and stance.
        height: of the load's centre above the ground [m].
    """
    variables = _variables(form, scene)
    position, angles, joints = (variable.value for variable in variables)
    part, doubled = form.part(tree)
    positions = {name: joints[i] for i, name in enumerate(form.joints)}
    poses = forward(part, Pose(euler_rotation(angles), position), positions)
    return Stand(
        form=form,
        part=part,
        doubled=doubled,
        poses=poses,
        variables=variables,
        hands=tuple(hand_constraints(form, poses, scene, height)),
        flat={side: foot_flat(form.agent, poses, side) for side in form.sides},
        yaw={side: foot_yaw(form.agent, poses, side, scene) for side in form.sides},
        stance=tuple(stance_constraints(form, poses, scene)),
        comfort=_comfort(form, joints, angles),
        uprights={side: poses[form.agent.soles[side]].rotation[2, 2] for side in form.sides},
    )


def _variables(form: Form, scene: Scene) -> tuple[Variable, Variable, Variable]:
    """Position and angles of the base, and the joints."""
    name, tilt = form.agent.name, scene.stance.base_tilt
    joints = [form.agent.tree.joint_by_name[joint] for joint in form.joints]
    sideways, turn = (0.0, 0.0) if form.mirror else (0.5, tilt)  # none in a symmetric posture
    farthest, nearest = [-3.0, -sideways, 0.0], [0.0, sideways, 3.0]
    standing = _standing(form.agent, scene)
    return (
        Variable.column(f"{name}.base_position", farthest, nearest, standing, 1.0),
        Variable.column(f"{name}.base_angles", [-turn, -tilt, -turn], [turn, tilt, turn], [0.0] * 3, 1.0),
        Variable.column(
            f"{name}.joints",
            [max(joint.lower, -math.pi) for joint in joints],
            [min(joint.upper, math.pi) for joint in joints],
            [0.0] * len(joints),
            1.0,
        ),
    )


def _standing(agent: Agent, scene: Scene) -> list[float]:
    """Base position [m] from which a solve begins: soles on the ground with all joints at zero."""
    poses = forward(agent.tree, Pose(ca.DM.eye(3), ca.DM.zeros(3)), {})
    lowest = min(float(poses[frame].position[2]) for frame in agent.soles.values())
    back = scene.payload.size[0] / 2.0 + scene.stance.trunk_clearance + 0.1
    return [-back, 0.0, -lowest]


def _comfort(form: Form, positions: Expression, base_angles: Expression) -> Expression:
    """Bent joints and a tilted base, slightly disliked."""
    joints = [form.agent.tree.joint_by_name[name] for name in form.joints]
    ranges = [min(j.upper, math.pi) - max(j.lower, -math.pi) for j in joints]
    bent = ca.dot(ca.DM(list(form.counts)), (positions / ca.DM(ranges)) ** 2)
    return COMFORT * (bent + ca.sumsqr(base_angles))
