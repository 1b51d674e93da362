"""Lifts of a problem's designs: every person with every load, from the holds at both ends."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property

from evodesign.motion.course import Lift
from evodesign.motion.lifting import LiftProblem, LiftSolution
from evodesign.posture.allocation import shared_scene
from evodesign.posture.check import AgentModel, Checker
from evodesign.posture.formulations.base import Setting
from evodesign.posture.postures import Symmetry
from evodesign.posture.results import CaseSolution
from evodesign.problem.evaluate import Evaluator
from evodesign.records import Hold

__all__ = ["Lifts"]


class Lifts:
    """The lifts of a problem, whose programs are built once.

    Args:
        evaluator: of the problem's designs.
    """

    def __init__(self, evaluator: Evaluator) -> None:
        self._evaluator, self._problem = evaluator, evaluator.problem

    @cached_property
    def _programs(self) -> Mapping[tuple[str, str], LiftProblem]:
        problem, symmetric = self._problem, self._problem.symmetry is not Symmetry.OFF
        return {
            scene.pair: LiftProblem(
                Setting(scene, problem.space, problem.weights, problem.options), symmetric=symmetric
            )
            for scene in problem.scenes
        }

    def solve(self, values: Sequence[float], lift: Lift) -> dict[tuple[str, str], LiftSolution]:
        """The lift of a design, by names of person and load.

        Args:
            values: one number per design parameter.
            lift: what is asked for.
        """
        problem, space = self._problem, self._problem.space
        if space.margins:  # rated torques follow from what the tasks ask for
            values = self._evaluator.solve(values).rated
        unscaled = problem.scene.robot
        robot = AgentModel.of(unscaled, unscaled.tree).resized(space.resized(unscaled.tree, values))
        found = {}
        for plain in problem.scenes:
            scene = shared_scene(plain, space, values)
            human = AgentModel.of(scene.human, scene.human.tree)
            checker = Checker(scene, robot, human)
            ends = [self._hold(values, plain.pair, height, checker) for height in (lift.from_m, lift.to_m)]
            found[plain.pair] = self._programs[plain.pair].solve(values, lift, ends, robot, human)
        return found

    def _hold(
        self, values: Sequence[float], pair: tuple[str, str], height: float, checker: Checker
    ) -> CaseSolution:
        return self._evaluator.inner.postures[pair].solve(values, Hold(height_m=height), checker)
