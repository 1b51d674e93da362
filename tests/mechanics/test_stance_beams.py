"""What links transmit in load cases: wrenches that keep the robot at rest, and the torques of its joints."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

from evodesign.mechanics.stance_beams import stance_safety, standing
from tests.problem.test_standing_cases import HOLD, ON_ONE_LEG, PUSH, at_rest, stood, with_cases


@pytest.mark.parametrize(
    ("text", "name"), [("", "one leg"), (HOLD, "tray"), (PUSH, "shove"), (ON_ONE_LEG, "bumped")]
)
def test_wrenches_hold_the_robot_as_pinocchio_says(repository: Path, text: str, name: str) -> None:
    """The recursive Newton-Euler algorithm leaves nothing at the base and the case's torques at joints."""
    tree, case, found = stood(with_cases(repository, text), name)
    base, _, wrenches = standing(tree, case, found)
    model, data, q = at_rest(tree, case, found)
    assert np.array(base.rotation) == pytest.approx(np.array(pin.Quaternion(q[3:7]).matrix()), abs=1e-9)
    outside = [pin.Force.Zero() for _ in range(model.njoints)]
    for frame, force, moment in wrenches:
        number = model.getFrameId(frame)
        carrier = model.frames[number].parentJoint
        place = data.oMf[number].translation - data.oMi[carrier].translation
        turn = np.array(data.oMi[carrier].rotation).T
        outside[carrier] += pin.Force(turn @ force, turn @ (moment + np.cross(place, force)))
    still = np.zeros(model.nv)
    rows = np.array(pin.rnea(model, data, q, still, still, outside))
    assert np.abs(rows[:6]).max() < 1e-6
    for joint, torque in found.torques.items():
        assert rows[model.joints[model.getJointId(joint)].idx_v] == pytest.approx(torque, abs=1e-6)
    assert stance_safety(tree, case, found)
