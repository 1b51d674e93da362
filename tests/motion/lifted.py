"""The point-grasp problem's unscaled robot and person, who lift."""

from __future__ import annotations

from dataclasses import dataclass

from evodesign.motion.lifting import LiftProblem
from evodesign.motion.solution import LiftSolution
from evodesign.posture.check import AgentModel, Checker
from evodesign.posture.formulations.base import Setting
from evodesign.posture.postures import PostureProblem
from evodesign.posture.results import CaseSolution
from evodesign.records import Hold
from evodesign.tasks import Lift

LIFT = Lift(0.9, 1.1, 1.5, knots=8)


@dataclass(frozen=True)
class Lifted:
    """Everything that a lift of a design needs."""

    setting: Setting
    design: tuple[float, ...]
    robot: AgentModel
    human: AgentModel
    lifts: LiftProblem
    holds: PostureProblem

    def hold(self, height: float) -> CaseSolution:
        checker = Checker(self.setting.scene, self.robot, self.human)
        return self.holds.solve(self.design, Hold(height_m=height), checker)

    def solve(self, lift: Lift) -> LiftSolution:
        holds = [self.hold(height) for height in (lift.from_m, lift.to_m)]
        return self.lifts.solve(self.design, lift, holds, self.robot, self.human)
