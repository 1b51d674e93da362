"""Lifts of a problem's designs: every person with every load, from the holds at both ends."""

from __future__ import annotations

from collections.abc import Sequence

from evodesign.evaluation.evaluate import Evaluator
from evodesign.motion.solution import LiftSolution
from evodesign.posture.allocation import shared_scene
from evodesign.posture.check import AgentModel, Checker
from evodesign.posture.precompute.precomputed import Precomputed
from evodesign.posture.results import CaseSolution
from evodesign.records import Hold, Lift


class Lifts:
    """The lifts of a problem, with the programs of its evaluator.

    Args:
        evaluator: of the problem's designs.
        known: what is known beforehand, starts of the lifts among it.
    """

    def __init__(self, evaluator: Evaluator, known: Precomputed) -> None:
        self._evaluator, self._problem, self._known = evaluator, evaluator.problem, known

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
            motions, starts = (
                self._evaluator.inner.lifts[plain.pair],
                self._known.lift_starts(plain.pair, lift),
            )
            found[plain.pair] = motions.solve(values, lift, ends, robot, human, known=starts)
        return found

    def _hold(
        self, values: Sequence[float], pair: tuple[str, str], height: float, checker: Checker
    ) -> CaseSolution:
        return self._evaluator.inner.postures[pair].solve(values, Hold(height_m=height), checker)
