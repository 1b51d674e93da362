"""The evaluation of one design: reach first, then a posture per height, then the objectives.

An evaluation depends on problem and design alone: no state is carried from one to the next.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

from evodesign.mechanics.scene import HUMAN, ROBOT, Scene
from evodesign.nlp.solver_cache import SolverCache
from evodesign.pool.base import Limits
from evodesign.posture.allocation import shared_scene
from evodesign.posture.check import AgentModel, Checker
from evodesign.posture.formulations.base import Setting
from evodesign.posture.formulations.reach import Reach, ReachProblem, common_reach
from evodesign.posture.postures import PostureProblem, Symmetry
from evodesign.posture.precompute.precomputed import NOTHING_PRECOMPUTED, Precomputed
from evodesign.posture.results import AgentPosture, Array, HeightSolution, Neighbour
from evodesign.problem.build import Problem
from evodesign.problem.objectives import objective_values
from evodesign.problem.result import DesignResult
from evodesign.records import (
    AgentDetail,
    Assessed,
    Assessment,
    Genome,
    HeightDetail,
    HeightOutcome,
    LoadCaseDetail,
    ProblemSource,
    ReachOutcome,
    Status,
    worst_status,
)

__all__ = ["AssessmentFactory", "Evaluator", "detail_of", "height_outcome", "reach_of"]


class Evaluator:
    """The inner problems of a problem, built once and solved for any number of designs.

    Attributes:
        problem: whose designs they are.
        known: what is known beforehand.
    """

    def __init__(self, problem: Problem, known: Precomputed = NOTHING_PRECOMPUTED) -> None:
        self.problem = problem
        self.known = known
        space, options, symmetry = problem.space, problem.options, problem.symmetry
        solvers = SolverCache()
        self._postures = [
            PostureProblem(
                Setting(scene, space, problem.weights, options), symmetry, known.of_scene(number), solvers
            )
            for number, scene in enumerate(problem.scenes)
        ]
        symmetric = symmetry is not Symmetry.OFF
        self._reaches = {
            id(scene.payload): ReachProblem(
                Setting(scene, space, problem.weights, options),
                symmetric=symmetric,
                known=known,
                solvers=solvers,
            )
            for scene in problem.scenes
        }
        self._people = {id(s.human): AgentModel.of(s.human, s.human.tree) for s in problem.scenes}

    def solve(self, values: Sequence[float]) -> DesignResult:
        """Reach and postures of a design given as one number per parameter."""
        problem = self.problem
        tree = problem.space.resized(problem.scene.robot.tree, values)
        scenes = [shared_scene(scene, problem.space, values) for scene in problem.scenes]
        check = Checker(problem.scene, tree, self._people[id(problem.scene.human)])
        reach = common_reach([reach.solve(values) for reach in self._reaches.values()])
        heights: list[HeightSolution] = []
        for number, scene in enumerate(scenes):
            checker = check.elsewhere(scene, self._people[id(scene.human)])
            for height in problem.heights:
                found = self._at_height(values, number, height, reach, checker, heights)
                heights.append(replace(found, scene=number))
        return DesignResult(
            scenes=problem.scenes,
            space=problem.space,
            values=tuple(values),
            tree=tree,
            reach=reach,
            heights=tuple(heights),
            paper=problem.joint,
            people_highest=min((stretch.highest for stretch in self.known.person_reaches), default=None),
        )

    def _scene(self, height: HeightSolution) -> Scene:
        return self.problem.scenes[height.scene]

    def _neighbour(self, before: Sequence[HeightSolution], number: int, height: float) -> Neighbour | None:
        """The most similar case at a height [m] of those solved before: of the same load if there is one."""
        scene, best = self.problem.scenes[number], None
        for solution in before:
            other = self._scene(solution)
            if solution.solved and solution.height == height and other.human.joints == scene.human.joints:
                same_load = other.payload is scene.payload
                if best is None or same_load >= best.same_load:
                    best = Neighbour(solution, same_load)
        return best

    def assess(self, genome: Genome) -> Assessed:
        """The results of a genome, with its postures."""
        return self.assess_values(self.problem.space.values(genome))

    def assess_values(self, values: Sequence[float]) -> Assessed:
        """The results of a design given as one number per parameter, with its postures."""
        result = self.solve(values)
        heights = tuple(detail_of(height, self._scene(height)) for height in result.heights if height.solved)
        return Assessed(assessment=self.assessment(values, result), heights=heights)

    def assessment(self, values: Sequence[float], result: DesignResult) -> Assessment:
        """A design's results in short, as they are logged."""
        heights = tuple(height_outcome(height, self._scene(height)) for height in result.heights)
        failed = [height for height in result.heights if not height.solved]
        return Assessment(
            design=dict(self.problem.space.named(values)),
            objectives=objective_values(self.problem.objectives, result),
            violation=_violation(result),
            status=worst_status([result.reach.status, *(height.status for height in result.heights)]),
            reason=failed[0].reason if failed else "solved",
            reach=reach_of(result.reach),
            heights=heights,
        )

    def _at_height(
        self,
        values: Sequence[float],
        scene: int,
        height: float,
        reach: Reach,
        checker: Checker,
        before: Sequence[HeightSolution],
    ) -> HeightSolution:
        distance = reach.distance(height)
        if distance is None:
            return HeightSolution(height, reach.status, reach.reason, {}, {}, ())
        if distance > 0.0:
            reason = f"{height:g} m is {distance:.3f} m out of reach: the robot {reach.reason}"
            return HeightSolution(height, Status.INFEASIBLE, reason, {}, {}, ())
        neighbour = self._neighbour(before, scene, height)
        return self._postures[scene].solve(values, height, checker, neighbour)


def _violation(result: DesignResult) -> float | None:
    """Sum over heights of the distance to the reachable interval [m]; None when a failure hides it."""
    total = 0.0
    for height in result.heights:
        distance = result.reach.distance(height.height)
        if distance is None or (distance == 0.0 and not height.solved):
            return None
        total += distance if height.scene == 0 else 0.0  # the interval is the same in every scene
    return total


def reach_of(reach: Reach) -> ReachOutcome:
    """The reachable interval, as it is logged."""
    return ReachOutcome(
        lowest_m=reach.lowest, highest_m=reach.highest, status=reach.status, reason=reach.reason
    )


def height_outcome(height: HeightSolution, scene: Scene) -> HeightOutcome:
    """A height in short, as it is logged."""
    return HeightOutcome(
        height_m=height.height,
        status=height.status,
        reason=height.reason,
        robot_torque_norm=height.postures[ROBOT].torque_norm if height.solved else None,
        human_torque_norm=height.postures[HUMAN].torque_norm if height.solved else None,
        iterations=sum(attempt.iterations for attempt in height.attempts),
        residual=max(height.residuals.values()) if height.solved else None,
        human_name=scene.human.label,
        payload_name=scene.payload.label,
        disturbed={
            disturbance: {name: posture.torque_norm for name, posture in postures.items()}
            for disturbance, postures in height.disturbed.items()
        },
    )


def detail_of(height: HeightSolution, scene: Scene) -> HeightDetail:
    """The postures at a height, as they are logged."""
    agents = {
        name: AgentDetail(
            base_position_m=tuple(posture.base_position.tolist()),
            base_rpy_rad=tuple(posture.base_angles.tolist()),
            joints_rad=dict(posture.joints),
            torques_n_m=dict(posture.torques),
            hand_wrenches=_numbers(posture.hand_wrenches),
            foot_wrenches=_numbers(posture.foot_wrenches),
        )
        for name, posture in height.postures.items()
    }
    disturbed = {
        disturbance: {name: _borne(posture) for name, posture in postures.items()}
        for disturbance, postures in height.disturbed.items()
    }
    return HeightDetail(
        height_m=height.height,
        agents=agents,
        human_name=scene.human.label,
        payload_name=scene.payload.label,
        disturbed=disturbed,
    )


def _borne(posture: AgentPosture) -> LoadCaseDetail:
    return LoadCaseDetail(
        torques_n_m=dict(posture.torques),
        hand_wrenches=_numbers(posture.hand_wrenches),
        foot_wrenches=_numbers(posture.foot_wrenches),
    )


def _numbers(wrenches: Mapping[str, Array]) -> dict[str, tuple[float, ...]]:
    return {side: tuple(wrench.tolist()) for side, wrench in wrenches.items()}


@dataclass(frozen=True, slots=True)
class AssessmentFactory:
    """Builds the evaluation of a problem in whichever process it is called.

    The problem travels as numbers: a worker need not read URDFs, whose reader takes a second to load.

    Args:
        digest: of the problem's source; two factories of equal digest build the same evaluation.
        problem: as built from its source.
        known: what was worked out beforehand; it follows from the problem.
    """

    digest: str
    problem: Problem = field(compare=False)
    known: Precomputed = field(compare=False)

    @property
    def source(self) -> ProblemSource:
        """What the problem was built from."""
        return self.problem.source

    @property
    def limits(self) -> Limits:
        """What one evaluation may cost."""
        return self.problem.limits

    def __call__(self) -> Callable[[Genome], Assessed]:
        """Build the inner problems and return the function from genome to results."""
        return Evaluator(self.problem, self.known).assess
