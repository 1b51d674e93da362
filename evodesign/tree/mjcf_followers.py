"""Joints of an MJCF model that equalities hold, or let follow others.

    q - r = sum c_k (p - r_p)^k        with references r, coefficients c and the leader's position p

A leader may be held itself, or follow another; those that nothing holds are at zero.

Source: MuJoCo XML reference (equality/joint).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Rules = Mapping[int, tuple[int, NDArray[np.float64]]]
"""Leader, -1 for none, and coefficients by the joint that is moved."""


@dataclass(frozen=True, slots=True)
class FollowerRule:
    """A joint that does not move by itself.

    Args:
        leader: the joint that it follows; empty where nothing moves, so that it is held.
        slope: of its position over the leader's, at the leader's reference.
        position: where it is while all joints that move by themselves are at zero [rad or m].
        leader_position: where its leader is meanwhile.
    """

    leader: str
    slope: float
    position: float
    leader_position: float

    @property
    def offset(self) -> float:
        """Of a mimic joint, whose position is slope times the leader's plus offset."""
        return self.position - self.slope * self.leader_position


def follower_rules(mujoco: Any, model: Any, joints: Mapping[int, str]) -> dict[str, FollowerRule]:
    """The coupled ones of a robot's joints, by name.

    Args:
        mujoco: the module.
        model: compiled.
        joints: names of the robot's joints by number.
    """
    rules = {
        int(model.eq_obj1id[each]): (int(model.eq_obj2id[each]), model.eq_data[each, :5])
        for each in range(model.neq)
        if model.eq_active0[each] and model.eq_type[each] == mujoco.mjtEq.mjEQ_JOINT
    }
    rules = {joint: rule for joint, rule in rules.items() if joint in joints}
    found = {}
    for joint, (leader, coefficients) in rules.items():
        position, moves = _position(joint, rules, model, joints, ())
        name = joints[leader] if moves else ""
        at = _position(leader, rules, model, joints, ())[0] if moves else 0.0
        found[joints[joint]] = FollowerRule(name, float(coefficients[1]), position, at)
    return found


def _position(
    joint: int, rules: Rules, model: Any, joints: Mapping[int, str], followers: tuple[int, ...]
) -> tuple[float, bool]:
    """Where a joint is, and whether one that moves by itself leads it; of a ring the URDF's reader tells."""
    if joint not in rules or joint in followers:
        return 0.0, True
    leader, coefficients = rules[joint]
    apart, moves = 0.0, False  # a leader outside of the robot stays at its reference
    if leader in joints:
        at, moves = _position(leader, rules, model, joints, (*followers, joint))
        apart = at - _reference(model, leader)
    polynomial = np.polynomial.polynomial.polyval(apart, coefficients)
    return _reference(model, joint) + float(polynomial), moves


def _reference(model: Any, joint: int) -> float:
    return float(model.qpos0[model.jnt_qposadr[joint]])
