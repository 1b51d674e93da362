"""The multi-start gradient baseline: from a start to what the joint problem makes of it.

A start is a genome, as any other evaluation's is, and the assessment is that of the design in which its solve
ended. So a baseline is a run like any other, whose genomes are starts and whose designs are optima. A start
that fails leaves an assessment without objectives, with its status and reason.

The published setting of the paper is the joint problem without limits: here it is solved at a design that is
held, compared with the paper's torque formula, and asked which limits it breaks.

Source: Sartore et al. 2022, Eq. 12 and 14.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from evodesign.design.parameter import EFFORT_RATIO
from evodesign.errors import InputError
from evodesign.evaluation.evaluate import case_outcome, detail_of, reach_of
from evodesign.mechanics.coupled import PAYLOAD, CoupledModel, level_load
from evodesign.mechanics.floating_base import Configuration
from evodesign.mechanics.projected import projected_torques
from evodesign.pool.base import Limits
from evodesign.posture.check import TOLERANCE
from evodesign.posture.formulations.codesign import JointProblem, JointSolution
from evodesign.posture.formulations.reach import Reach
from evodesign.posture.results import CaseSolution
from evodesign.posture.terms.base import Residual
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.constraints import refuse_constraints
from evodesign.problem.design_space import refuse_choices
from evodesign.quantities.design_result import DesignResult
from evodesign.quantities.objectives import objective_values
from evodesign.records import Assessed, Assessment, Genome, Hold, ProblemSource, Status

GENERATION = 10
"""Starts after which a log says how things stand."""


def refuse_unsuited(problem: DesignProblem) -> None:
    """Refuse a problem that the joint problem cannot tell.

    Raises:
        InputError: constraints, several people or loads, disturbances, weights that a design would choose for
            itself, or a density of materials.
    """
    refuse_constraints(problem.constraints, problem.source)
    refuse_choices(problem.space, problem.source)
    if EFFORT_RATIO in problem.space.allocation_names:
        wanted = f"no {EFFORT_RATIO} in the joint problem, whose cost it would weigh"
        raise InputError(problem.source.path, "design.allocation", wanted, f"'{EFFORT_RATIO}'")
    if problem.moves:
        raise InputError(problem.source.path, "task.lift", "loads held still in the joint problem", "a lift")
    if len(problem.scenes) > 1:
        found = f"{len(problem.scenes)} pairs of a person and a load"
        wanted = "one person and one load in the joint problem"
        raise InputError(problem.source.path, "human", wanted, found)
    if problem.scene.disturbances:
        found = f"{len(problem.scene.disturbances.cases)}"
        raise InputError(problem.source.path, "disturbance", "none in the joint problem", found)


class Baseline:
    """The joint problem of a problem, built once and solved from any number of starts.

    Args:
        problem: with its `[baseline]`.
        fixed: a genome that the design is held at; None to optimise it.
    Raises:
        InputError: as in `refuse_unsuited`.
    """

    def __init__(self, problem: DesignProblem, fixed: Genome | None = None) -> None:
        refuse_unsuited(problem)
        self._problem = problem
        self._joint = JointProblem(problem.scene, problem.space, problem.holds, problem.joint, fixed)

    def solve(self, start: Genome) -> JointSolution:
        """The result of a start; named designs begin with standard postures, others with drawn ones."""
        return self._joint.solve(start, drawn=start not in self._problem.joint_start)

    def polish(self, result: DesignResult) -> JointSolution:
        """The local optimum next to a design whose postures are known in every case.

        Args:
            result: of an evaluation; all its cases are solved.
        """
        genome = self._problem.space.genome(result.values)
        return self._joint.polish(genome, [solution.instants[0] for solution in result.cases])

    def assess(self, start: Genome) -> Assessed:
        """The results of the design in which a start ended, with its postures."""
        solution = self.solve(start)
        result = self.result(solution)
        details = tuple(detail_of(case) for case in result.cases if case.solved)
        assessment = Assessment(
            design=dict(self._problem.space.named(solution.design)),
            objectives=objective_values(self._problem.objectives, result) if solution.solved else {},
            violation=0.0 if solution.solved else None,
            status=solution.attempt.status,
            reason="solved" if solution.solved else solution.cases[0].reason,
            reach=reach_of(result.reach),
            cases=tuple(
                case_outcome(replace(case, reason=_reason(case, violations)))
                for case, violations in zip(result.cases, solution.violations, strict=True)
            ),
        )
        return Assessed(assessment=assessment, cases=details)

    def result(self, solution: JointSolution) -> DesignResult:
        """A solution as the result of its design."""
        problem = self._problem
        return DesignResult(
            scenes=problem.scenes,
            space=problem.space,
            values=solution.design,
            tree=problem.space.resized(problem.scene.designed_tree, solution.design),
            reach=_reach(solution),
            cases=solution.cases,
            paper=problem.joint,
        )


def _reach(solution: JointSolution) -> Reach:
    """The heights that a solution holds; beyond them nothing was tried."""
    heights = [case.case.task.heights[0] for case in solution.cases]
    if not solution.solved:
        return Reach(None, None, solution.attempt.status, solution.attempt.reason)
    reason = f"holds loads at {', '.join(f'{height:g}' for height in heights)} m; no others were tried"
    return Reach(min(heights), max(heights), Status.SOLVED, reason)


def _reason(case: CaseSolution, violations: Sequence[Residual]) -> str:
    """A solved case's reason, with every limit that is not enforced and does not hold."""
    beyond = [f"{r.name} by {r.size:.3g}" for r in violations if r.size > TOLERANCE]
    return f"{case.reason}; limits not enforced and exceeded: {', '.join(beyond)}" if beyond else case.reason


@dataclass(frozen=True, slots=True)
class BaselineFactory:
    """Builds the baseline of a problem in whichever process it is called.

    Args:
        digest: of the source; two factories of equal digest build the same baseline.
        source: the problem's text and files.
        limits: of one start; they follow from the source.
    """

    digest: str
    source: ProblemSource = field(compare=False)
    limits: Limits = field(default=Limits(), compare=False)

    def __call__(self) -> Callable[[Genome], Assessed]:
        """Build the joint problem and return the function from start to its result."""
        return Baseline(build_problem(self.source)).assess


def held_at(problem: DesignProblem, genome: Genome, tasks: Sequence[Hold]) -> JointSolution:
    """The joint problem with the design held at a genome, over some tasks, from the standard start."""
    return Baseline(replace(problem, tasks=tuple(tasks), joint_start=(genome,)), fixed=genome).solve(genome)


def torque_difference(problem: DesignProblem, solution: JointSolution) -> float:
    """Largest difference of a solution's torques from the paper's formula at its postures [N m]."""
    tree = problem.space.resized(problem.scene.designed_tree, solution.design)
    model = CoupledModel(problem.scene, tree)
    worst = 0.0
    for case in solution.cases:
        places = {
            n: Configuration(p.base_position, p.base_angles, p.joints) for n, p in case.postures.items()
        }
        system = model.at({**places, PAYLOAD: level_load(case.case.task.heights[0])})
        torques = [case.postures[agent].torques[joint] for agent, joint in system.joints]
        worst = max(worst, float(np.abs(projected_torques(system) - torques).max()))
    return worst


def broken_limits(solutions: Sequence[JointSolution]) -> str:
    """In words, the limits that the check found broken; empty for none."""
    found: dict[tuple[str, str], float] = {}
    for residual in (r for solution in solutions for of in solution.violations for r in of):
        kind = (residual.words, residual.unit)
        found[kind] = max(found.get(kind, 0.0), residual.size)
    return ", ".join(
        f"{words} by up to {size:.2g} {unit}" for (words, unit), size in found.items() if size > TOLERANCE
    )
