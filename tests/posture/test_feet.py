"""Feet that point ahead."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

from evodesign.posture.allocation import EffortWeights
from evodesign.posture.check import AgentModel
from evodesign.posture.formulations.base import Setting
from evodesign.posture.formulations.reach import robot_reach_program
from evodesign.posture.symmetry import symmetric_forms
from evodesign.problem.build import DesignProblem


def test_a_foot_that_points_backwards_is_turned_by_half_a_circle(problem: DesignProblem) -> None:
    """The row is the angle that pinocchio finds: a limit of its sine would let a foot point backwards."""
    form = symmetric_forms(problem.scene)[0]
    setting = Setting(problem.scene, problem.space, EffortWeights(1.0, 1.0), problem.options)
    program = robot_reach_program(form, setting)
    row = next(block for block in program.constraints if block.name.endswith("_foot_yaw"))
    turn = ca.Function("turn", [program.symbols, program.given], [row.expression])
    robot, agent = AgentModel.of(problem.scene.robot, problem.scene.robot.tree), problem.scene.robot
    given = {
        name: problem.space.unscaled(agent.tree) if name == "design" else np.zeros(symbol.numel())
        for name, symbol in program.parameters.items()
    }
    rng, found = np.random.default_rng(5), []
    for _ in range(20):
        values = program.unpacked(program.packed({}) + rng.uniform(-2.0, 2.0, program.symbols.numel()))
        posture = form.expand({name.partition(".")[2]: value for name, value in values.items()})
        rotation, _ = robot.at(posture).pose(form.feet[0].frame)
        wanted = float(np.arctan2(rotation[1, 0], rotation[0, 0]))
        found.append(wanted)
        own = float(turn(program.packed(values), program.packed_parameters(given)))
        assert own == pytest.approx(wanted, abs=1e-9)
    assert max(np.abs(found)) > np.pi / 2.0
    assert row.upper == problem.scene.stance.foot_yaw
