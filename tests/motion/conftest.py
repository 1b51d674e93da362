"""A lift of the point-grasp problem, solved once for all tests of a module."""

from __future__ import annotations

from dataclasses import replace

import pytest

from evodesign.motion.lifting import LiftProblem
from evodesign.motion.solution import LiftSolution
from evodesign.nlp.method import MethodName
from evodesign.posture.check import AgentModel
from evodesign.posture.formulations.base import Setting
from evodesign.posture.postures import PostureProblem, Symmetry
from evodesign.problem.build import DesignProblem
from tests.motion.lifted import LIFT, Lifted


@pytest.fixture(scope="module")
def lifted(problem: DesignProblem) -> Lifted:
    """Lifts by the native method, compiled quickly; holds by IPOPT without a compiler."""
    holds = Setting(problem.scene, problem.space, problem.weights, problem.options)
    native = replace(problem.options, compiled=True, seldom=True, method=MethodName.NATIVE, seconds=200.0)
    setting = replace(holds, options=native)
    return Lifted(
        setting=setting,
        design=tuple(problem.space.unscaled(problem.scene.robot.tree)),
        robot=AgentModel.of(problem.scene.robot, problem.scene.robot.tree),
        human=AgentModel.of(problem.scene.human, problem.scene.human.tree),
        lifts=LiftProblem(setting, symmetric=True),
        holds=PostureProblem(holds, Symmetry.ON),
    )


@pytest.fixture(scope="module")
def solution(lifted: Lifted) -> LiftSolution:
    return lifted.solve(LIFT)
