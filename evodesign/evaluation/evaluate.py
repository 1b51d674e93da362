"""The evaluation of one design: reach first, then the postures of every case, then the objectives.

An evaluation depends on problem and design alone: no state is carried from one to the next.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import msgspec

from evodesign.evaluation.design_solver import DesignSolver
from evodesign.evaluation.gradients import assessed_gradients
from evodesign.evaluation.inner import inner_problems
from evodesign.evaluation.judge import is_judged
from evodesign.evaluation.sensitivities import Sensitivities
from evodesign.mechanics.agent import HUMAN, ROBOT
from evodesign.nlp.method import MethodName
from evodesign.nlp.solver import SolverCache, own_solvers
from evodesign.pool.base import Limits
from evodesign.posture.formulations.reach import Reach
from evodesign.posture.precompute.precomputed import NOTHING_PRECOMPUTED, Precomputed
from evodesign.posture.results import AgentPosture, Array, CaseSolution, Instant
from evodesign.problem.build import DesignProblem
from evodesign.quantities.design_result import DesignResult
from evodesign.quantities.objectives import objective_values
from evodesign.quantities.push_quantities import unsimulated, weakest_pushes
from evodesign.records import (
    ActiveLimit,
    AgentDetail,
    Assessed,
    Assessment,
    CaseDetail,
    CaseOutcome,
    Genome,
    Hold,
    InstantDetail,
    LoadCaseDetail,
    ProblemSource,
    ReachOutcome,
    Status,
    worst_status,
)
from evodesign.searches.surrogate.threads import one_thread
from evodesign.violations import BODIES_APART, missed_height, total_violation

UNDISTURBED = ""
"""Name of the load case in which nothing happens."""


class Evaluator:
    """The inner problems of a problem, built once and solved for any number of designs.

    Attributes:
        problem: whose designs they are.
        known: what is known beforehand.
        inner: its inner problems.
    """

    def __init__(
        self,
        problem: DesignProblem,
        known: Precomputed = NOTHING_PRECOMPUTED,
        solvers: SolverCache | None = None,
    ) -> None:
        self.problem = problem
        self.known = known
        self.inner = inner_problems(problem, known, solvers)
        self._solver = DesignSolver(problem, known, self.inner)

    def solve(self, values: Sequence[float]) -> DesignResult:
        """Reach and postures of a design given as one number per parameter."""
        return self._solver.solve(values)

    def assess(self, genome: Genome) -> Assessed:
        """The results of a genome, with its postures."""
        values = self.problem.space.values(genome)
        return self._with_judgement(genome, self._assessed(values, self._solver.solve(values)))

    def assess_with_gradients(self, genome: Genome) -> Assessed:
        """The same with gradients, and what they took."""
        values = self.problem.space.values(genome)
        result = self.solve(values)
        began = time.perf_counter()
        with one_thread():
            gradients = assessed_gradients(self.problem, self._sensitivities, values, result)
        seconds = time.perf_counter() - began
        assessed = self._assessed(values, result)
        assessment = msgspec.structs.replace(assessed.assessment, gradients=gradients)
        assessed = msgspec.structs.replace(assessed, assessment=assessment, gradient_seconds=seconds)
        return self._with_judgement(genome, assessed)

    def _with_judgement(self, genome: Genome, assessed: Assessed) -> Assessed:
        if not self._native or not is_judged(genome):
            return assessed
        judged = self._judge.assess_values(self.problem.space.values(genome)).assessment.objectives
        assessment = msgspec.structs.replace(assessed.assessment, judged=judged)
        return msgspec.structs.replace(assessed, assessment=assessment)

    @cached_property
    def _sensitivities(self) -> Sensitivities:
        return Sensitivities(self.problem, self.known, self.inner)

    @property
    def _native(self) -> bool:
        return self.problem.options.method is MethodName.NATIVE

    @cached_property
    def _judge(self) -> Evaluator:
        """The same, solved by IPOPT; too seldom to compile for."""
        options = replace(self.problem.options, compiled=False)
        return Evaluator(replace(self.problem, options=options), self.known)

    def assess_values(self, values: Sequence[float]) -> Assessed:
        """The results of a design given as one number per parameter, with its postures."""
        return self._assessed(values, self.solve(values))

    def _assessed(self, values: Sequence[float], result: DesignResult) -> Assessed:
        return Assessed(assessment=self.assessment(values, result), cases=self.details(result))

    def details(self, result: DesignResult) -> tuple[CaseDetail, ...]:
        """The postures of a design's solved cases, with the limits that hold them."""
        return tuple(
            detail_of(solution, self._active_limits(result, solution))
            for solution in result.cases
            if solution.solved
        )

    def _active_limits(self, result: DesignResult, solution: CaseSolution) -> tuple[ActiveLimit, ...]:
        if not isinstance(solution.case.task, Hold):
            return ()
        return self.inner.postures[solution.case.pair].active_limits(result.program_values, solution)

    def assessment(self, values: Sequence[float], result: DesignResult) -> Assessment:
        """A design's results in short, as they are logged."""
        failed = [solution for solution in result.cases if not solution.solved]
        constraints, reach = self.problem.constraints, reach_of(result.reach)
        known = constraints
        if any(solution.status is Status.BODIES_OVERLAP for solution in failed):  # nothing else is known
            known = tuple(constraint for constraint in constraints if constraint.name == BODIES_APART)
        cases = tuple(case_outcome(solution, native=self._native) for solution in result.cases)
        missed = missed_height(reach, cases)
        constrained = objective_values(unsimulated(known), result)
        violation = total_violation(unsimulated(constraints), constrained, missed)
        if violation == 0.0 and self.problem.pushes is not None:
            from evodesign.evaluation.pushes import found_pushes  # MuJoCo takes its time to load

            result = replace(result, pushes=found_pushes(result, self.problem.pushes, self.problem))
            constrained = objective_values(known, result)
            violation = total_violation(constraints, constrained, missed)
        return Assessment(
            design=dict(self.problem.space.named(values)),
            objectives=objective_values(self.problem.objectives, result),
            violation=violation,
            status=_status(result),
            reason=failed[0].reason if failed else "solved",
            reach=reach,
            cases=cases,
            constraints=constrained or msgspec.UNSET,
            rated=result.rated_torques or msgspec.UNSET,
            weakest=weakest_pushes(result.pushes) or msgspec.UNSET,
        )


def _status(result: DesignResult) -> Status:
    """The worst of reach and cases; bodies in each other explain a reach that was not found as well."""
    found = [solution.status for solution in result.cases]
    if Status.BODIES_OVERLAP in found:
        return Status.BODIES_OVERLAP
    return worst_status([result.reach.status, *found])


def reach_of(reach: Reach) -> ReachOutcome:
    """The reachable interval, as it is logged."""
    return ReachOutcome(
        lowest_m=reach.lowest,
        highest_m=reach.highest,
        status=reach.status,
        reason=reach.reason,
        or_lower=reach.or_lower,
    )


def case_outcome(solution: CaseSolution, *, native: bool = False) -> CaseOutcome:
    """A case in short, as it is logged; of several instants the one with the largest torques counts.

    Args:
        solution: of the case.
        native: whether solves by IPOPT are fallbacks.
    """
    norms: dict[str, dict[str, float]] = {}
    for instant in solution.instants:
        for load_case, postures in ((UNDISTURBED, instant.postures), *instant.disturbed.items()):
            largest = norms.setdefault(load_case, dict.fromkeys(postures, 0.0))
            for name, posture in postures.items():
                largest[name] = max(largest[name], posture.torque_norm)
    together = {load_case: norms_by_role(largest) for load_case, largest in norms.items()}
    undisturbed = together.pop(UNDISTURBED, {})
    return CaseOutcome(
        case=solution.case,
        status=solution.status,
        reason=solution.reason,
        robot_torque_norm=undisturbed.get(ROBOT),
        human_torque_norm=undisturbed.get(HUMAN),
        iterations=sum(attempt.iterations for attempt in solution.attempts),
        fallbacks=sum(each.method is MethodName.IPOPT for each in solution.attempts) if native else 0,
        residual=max(solution.residuals.values()) if solution.solved else None,
        disturbed=together,
    )


def norms_by_role(norms: Mapping[str, float]) -> dict[str, float]:
    """|tau|_2 of all robots, and of all people who hold a load, from those of each by name [N m]."""
    found = {role: [norm for name, norm in norms.items() if name.startswith(role)] for role in (ROBOT, HUMAN)}
    return {role: own[0] if len(own) == 1 else math.hypot(*own) for role, own in found.items() if own}


def detail_of(solution: CaseSolution, limits: tuple[ActiveLimit, ...] = ()) -> CaseDetail:
    """The postures of a case, as they are logged.

    Args:
        solution: of the case.
        limits: that hold the postures.
    """
    instants = tuple(map(_instant_detail, solution.instants))
    return CaseDetail(case=solution.case, instants=instants, limits=limits)


def _instant_detail(instant: Instant) -> InstantDetail:
    agents = {
        name: AgentDetail(
            base_position_m=tuple(posture.base_position.tolist()),
            base_rpy_rad=tuple(posture.base_angles.tolist()),
            joints_rad=dict(posture.joints),
            torques_n_m=dict(posture.torques),
            wrenches=_numbers(posture.wrenches),
            speeds_rad_s=dict(posture.speeds),
        )
        for name, posture in instant.postures.items()
    }
    disturbed = {
        disturbance: {name: _load_case(posture) for name, posture in postures.items()}
        for disturbance, postures in instant.disturbed.items()
    }
    return InstantDetail(
        time_s=instant.time, agents=agents, disturbed=disturbed, load_height_m=instant.height
    )


def _load_case(posture: AgentPosture) -> LoadCaseDetail:
    return LoadCaseDetail(
        torques_n_m=dict(posture.torques),
        wrenches=_numbers(posture.wrenches),
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
        gradients: whether results come with their gradients.
    """

    digest: str
    problem: DesignProblem = field(compare=False)
    known: Precomputed = field(compare=False)
    gradients: bool = False

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
        evaluator = Evaluator(self.problem, self.known, own_solvers())
        return evaluator.assess_with_gradients if self.gradients else evaluator.assess
