"""A lift beside a person who is drawn to postures of people who lift, with a spine that bends as a whole."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from evodesign.human.coupled_joints import rhythms
from evodesign.human.measured_posture import measured_posture
from evodesign.mechanics.agent import HUMAN
from evodesign.motion.lifting import LiftProblem
from evodesign.posture.check import AgentModel
from evodesign.posture.formulations.base import Setting
from evodesign.posture.postures import PostureProblem, Symmetry
from evodesign.problem.build import DesignProblem
from evodesign.tasks import Lift
from tests.motion.lifted import Lifted

LIFT = Lift(0.8, 1.1, 1.5, knots=8)


@pytest.fixture(scope="module")
def lifted(problem: DesignProblem) -> Lifted:
    human = replace(problem.scene.human, measured=measured_posture(1.82), rhythms=rhythms())
    scene = problem.scene.with_agents(human)
    setting = Setting(scene, problem.space, problem.weights, problem.options)
    return Lifted(
        setting=setting,
        design=tuple(problem.space.unscaled(scene.robot.tree)),
        robot=AgentModel.of(scene.robot, scene.robot.tree),
        human=AgentModel.of(human, human.tree),
        lifts=LiftProblem(setting, symmetric=True),
        holds=PostureProblem(setting, Symmetry.ON),
    )


@pytest.mark.slow
def test_the_lift_is_solved_and_checked_with_lumbar_joints_at_their_shares(lifted: Lifted) -> None:
    """At all times, and their speeds as well; the person bends more than in a hold at 0.9 m and above."""
    solution = lifted.solve(LIFT)
    assert solution.solved, solution.reason
    assert solution.course is not None
    (flexion,) = [each for each in rhythms() if each.name == "lumbar_flexion"]
    totals = []
    for instant in solution.course.instants(np.linspace(0.0, LIFT.seconds, 21)):
        posture = instant.postures[HUMAN]
        for values in (posture.joints, posture.speeds):
            total = sum(values[name] for name in flexion.joints)
            expected = [share * total for share in flexion.shares]
            assert [values[name] for name in flexion.joints] == pytest.approx(expected, abs=1e-9)
        totals.append(sum(posture.joints[name] for name in flexion.joints))
    assert np.degrees(max(totals)) > 10.0
    assert np.degrees(min(totals)) > -15.0
