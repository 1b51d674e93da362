"""The posture of a design in a case: formulations in turn, until the check accepts a result.

A scene that is its own mirror image is solved for symmetric postures: half the variables and far fewer local
minima. The whole program, started from the symmetric solution, is the polish, and the refuge when no
symmetric posture is found. Solves begin at the problem's portfolio of starts (at two fixed ones where there
is none), so that the result depends on problem and design alone.

Beyond 300 lines: the order in which formulations, methods and starts are tried stands in one class.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from enum import StrEnum
from functools import partial

import numpy as np

from evodesign.nlp.method import MethodName
from evodesign.nlp.optimality import NotDifferentiable
from evodesign.nlp.program import Start
from evodesign.nlp.solver import RawSolution, SolverCache
from evodesign.posture.check import Checker
from evodesign.posture.formulations.base import Setting
from evodesign.posture.formulations.joint import JointPostures
from evodesign.posture.precompute.precomputed import NOTHING_PRECOMPUTED, Precomputed
from evodesign.posture.results import CaseSolution, Neighbour
from evodesign.posture.seeking.budget import BUDGET
from evodesign.posture.seeking.candidate import Trial, case_solution
from evodesign.posture.seeking.landscape import Landscape
from evodesign.posture.solution_derivative import PostureDerivative
from evodesign.posture.symmetry import forms_of, symmetric_forms
from evodesign.records import ActiveLimit, Status
from evodesign.tasks import Task, TaskRecord

SYMMETRIC, WHOLE = "symmetric", "whole"
"""Names of the formulations in results."""


class Symmetry(StrEnum):
    """Which postures are looked for; `auto` becomes `on` or `off` when a problem is built."""

    AUTO = "auto"
    ON = "on"
    OFF = "off"
    POLISH = "polish"


class PostureProblem:
    """The postures of any design of a scene.

    Args:
        setting: of the scene.
        symmetry: which postures are looked for.
        known: portfolios of starts.
        solvers: of other scenes, which may have programs in common with this one.
    Raises:
        ModelError: symmetric postures of a scene that is not its own mirror image; it says what differs.
    """

    def __init__(
        self,
        setting: Setting,
        symmetry: Symmetry,
        known: Precomputed = NOTHING_PRECOMPUTED,
        solvers: SolverCache | None = None,
    ) -> None:
        self._setting, self._symmetry, self._known = setting, symmetry, known
        self._solvers = solvers or SolverCache()
        self._made: dict[tuple[str, type[TaskRecord], MethodName], JointPostures] = {}
        self._latest: dict[tuple[JointPostures, Task, bool], tuple[object, Trial]] = {}
        if symmetry is not Symmetry.OFF:
            for robot in setting.scene.designed:
                setting.space.check_mirror(robot.tree)
            symmetric_forms(setting.scene)

    def solve(
        self,
        design: Sequence[float],
        task: Task,
        checker: Checker,
        neighbour: Neighbour | None = None,
        others: Sequence[Neighbour] = (),
        starts: Sequence[Start] = (),
    ) -> CaseSolution:
        """The best checked posture of a design in one case.

        Args:
            design: one number per design parameter.
            task: of the problem.
            checker: the independent check, made for this design.
            neighbour: what the same design led to in a similar scene; fewer starts do beside it.
            others: what it led to elsewhere, for a case in which the portfolio leads nowhere.
            starts: of this design alone, for the same case.
        """
        trials: list[Trial] = []
        for tried in self._ways(design, task, checker, neighbour, trials, others, starts):
            trials.append(tried())
            if trials[-1].best is not None:
                break
        return self._finished(design, task, checker, trials)

    def sketched(self, design: Sequence[float], task: Task) -> CaseSolution:
        """What the first start leads to about, not checked; arguments as in `solve`."""
        name, portfolio = next(self._in_turn(task))
        formulation = self._formulation(name, task)
        trial = formulation.sketched(design, task, portfolio)
        return case_solution(self._setting.scene.case(task), [trial])

    def begun(
        self,
        design: Sequence[float],
        task: Task,
        checker: Checker,
        neighbour: Neighbour | None = None,
        *,
        polished: bool,
    ) -> CaseSolution:
        """What the formulation that is tried first leads to; arguments as in `solve`.

        Where the problem asks for polish, `polished` says whether this posture needs it: one that another
        round of sizing goes on from does not.
        """
        tried = next(self._ways(design, task, checker, neighbour, []))
        return self._ended(design, task, checker, [tried()], polished=polished)

    def improved(
        self,
        design: Sequence[float],
        solution: CaseSolution,
        others: Sequence[CaseSolution],
        checker: Checker,
        *,
        polished: bool,
    ) -> CaseSolution:
        """The best of a solution and of what others of the same design lead to; arguments as in `begun`."""
        task = solution.case.task
        name, _ = next(self._in_turn(task))
        formulation = self._formulation(name, task)
        for other in others:
            most = (1.0 - BUDGET.same) * _cost(solution)
            trials = [formulation.cheaper(design, task, other, checker, most)]
            found = self._ended(design, task, checker, trials, polished=polished)
            best = min(found, solution, key=_cost)
            solution = replace(best, attempts=(*solution.attempts, *found.attempts))
        return solution

    def _ended(
        self,
        design: Sequence[float],
        task: Task,
        checker: Checker,
        trials: Sequence[Trial],
        *,
        polished: bool,
    ) -> CaseSolution:
        """The best posture of some trials, polished only where it is asked to be."""
        if polished:
            return self._finished(design, task, checker, trials)
        return case_solution(self._setting.scene.case(task), trials)

    def _finished(
        self, design: Sequence[float], task: Task, checker: Checker, trials: Sequence[Trial]
    ) -> CaseSolution:
        """The best posture of some trials, polished where the problem asks for it."""
        best, found = trials[-1].best, [*trials]
        if self._symmetry is Symmetry.POLISH and best is not None:
            whole = self._formulation(WHOLE, task)
            found.append(whole.solve(design, task, [whole.start_at(best.instants, "polish")], checker))
        return case_solution(self._setting.scene.case(task), found)

    def followed(self, design: Sequence[float], solution: CaseSolution) -> CaseSolution | None:
        """The robot's postures of another design near those of a solution, not checked; None if not found.

        They ask of the robot's actuators what the design's own postures will, where these are near.
        """
        if solution.attempt is None or solution.raw is None:
            return None
        formulation = self._formulation(solution.attempt.formulation, solution.case.task)
        return formulation.followed(design, solution, solution.raw)

    def derivative(
        self, design: Sequence[float], solution: CaseSolution, *, exact: bool = True
    ) -> PostureDerivative | NotDifferentiable:
        """How a solved posture moves with the design, or why it has no derivative.

        `exact` is that of `SolutionSensitivity.at`.
        """
        if solution.attempt is None:
            return NotDifferentiable(solution.reason)
        formulation = self._formulation(solution.attempt.formulation, solution.case.task)
        return formulation.derivative(design, solution, exact=exact)

    def active_limits(self, design: Sequence[float], solution: CaseSolution) -> tuple[ActiveLimit, ...]:
        """Which limits hold a solved posture, and what they cost; none where nobody knows."""
        if solution.attempt is None:
            return ()
        formulation = self._formulation(solution.attempt.formulation, solution.case.task)
        return formulation.active_limits(design, solution)

    def landscape(
        self, task: Task, checker_of: Callable[[Sequence[float]], Checker] | None = None
    ) -> Landscape:
        """The cost for a task of the formulation that is tried first, of which portfolios are made.

        Args:
            task: of the problem.
            checker_of: the check of a design, by which postures count where no bodies overlap; left out, all
                count as they are.
        """
        name, _ = next(self._in_turn(task))
        formulation = self._formulation(name, task)
        found = formulation.landscape(task)
        if checker_of is None:
            return found
        return replace(
            found,
            cleared=lambda design, raw: formulation.cleared(design, raw, task, checker_of(design)),
        )

    def _ways(
        self,
        design: Sequence[float],
        task: Task,
        checker: Checker,
        neighbour: Neighbour | None,
        trials: Sequence[Trial],
        others: Sequence[Neighbour] = (),
        starts: Sequence[Start] = (),
    ) -> Iterator[Callable[[], Trial]]:
        """What each formulation tries, in turn: from its portfolio, and then from what else is known.

        A neighbour's solution counts among those of other tasks where starts were learned in this very case.
        Where all starts ended at postures that violate the constraints no more than any near them, no other
        method is asked: IPOPT solves no such height either (docs/benchmarks.md). Nor where bodies overlap
        that no row keeps apart.
        """
        known, pair = self._known, self._setting.scene.pair
        if neighbour is not None and not neighbour.unchecked and known.is_learned(pair, task):
            others, neighbour = (neighbour, *others), None
        for name, portfolio in self._in_turn(task):
            for method in self._methods(name):
                formulation = self._formulation(name, task, method)
                solved = partial(formulation.solve, design, task, checker=checker)
                if neighbour is not None:
                    if not neighbour.unchecked:
                        begun = formulation.start_at(neighbour.solution.instants)
                        yield partial(solved, [begun, *formulation.starts(task, portfolio)])
                    elif (raw := _raw_of(neighbour.solution, name)) is not None:
                        yield partial(formulation.finished, design, task, raw, checker)
                yield partial(self._from_portfolio, formulation, design, task, portfolio, checker)
                trial = trials[-1]
                if trial.overlaps:
                    break
                if portfolio and method is self._methods(name)[0]:
                    for other in others:
                        begun = formulation.start_at(other.solution.instants)
                        yield partial(solved, [begun, *formulation.starts(task)])
                    if starts:
                        yield partial(solved, formulation.starts(task, starts), people=True)
                if all(each.status is Status.INFEASIBLE for each in trial.attempts):
                    break

    def _from_portfolio(
        self,
        formulation: JointPostures,
        design: Sequence[float],
        task: Task,
        portfolio: Sequence[Start],
        checker: Checker,
    ) -> Trial:
        """What the portfolio, or the fixed starts, lead to; that of the latest design is at hand.

        Where that is doubtful, the starts of others in the same task are tried; where it is nothing, those of
        all other tasks.
        """
        key, of = (formulation, task, bool(portfolio)), (tuple(design), type(checker))
        found = self._latest.get(key)
        if found is None or found[0] != of:
            given = formulation.starts(task, portfolio)
            trial = formulation.solve(design, task, given, checker, people=bool(portfolio))
            beside, rest = self._known.other_starts(self._setting.scene.pair, task)
            if portfolio and beside and trial.is_doubtful:
                given = formulation.starts(task, beside)
                trial = trial.beside(formulation.solve(design, task, given, checker, people=True))
            if portfolio and rest and trial.best is None:
                given = formulation.starts(task, rest)
                trial = trial.beside(formulation.solve(design, task, given, checker, people=True))
            found = of, trial
            self._latest[key] = found
        return found[1]

    def _in_turn(self, task: Task) -> Iterator[tuple[str, tuple[Start, ...]]]:
        """The formulations to be tried until one succeeds, with their starts; a refuge has none."""
        portfolio = self._known.starts(self._setting.scene.pair, task)
        if self._symmetry is Symmetry.OFF:
            yield WHOLE, portfolio
            if portfolio:
                yield WHOLE, ()
            return
        yield SYMMETRIC, portfolio
        yield WHOLE, ()

    def _formulation(self, name: str, task: Task, method: MethodName | None = None) -> JointPostures:
        """A formulation, solved by the method that is tried first if none is named."""
        method = method or self._methods(name)[0]
        key = (name, type(task), method)
        if key not in self._made:
            self._made[key] = self._joint(name, self._solved_by(method, name), type(task))
        return self._made[key]

    def _joint(self, name: str, setting: Setting, kind: type[TaskRecord]) -> JointPostures:
        """The program of a formulation; beside the best whole robot people of other starts are put, too."""
        forms = forms_of(setting.scene, symmetric=name == SYMMETRIC)
        if name == SYMMETRIC:
            return JointPostures(name, forms, setting, self._solvers, kind)
        people = [start for found in self._known.postures.values() for start in found.starts]
        return JointPostures(name, forms, setting, self._solvers, kind, people)

    def _methods(self, name: str) -> tuple[MethodName, ...]:
        """Who solves a formulation, in turn: IPOPT is tried where the native method finds no posture.

        Not in a refuge, whose program takes IPOPT seconds.
        """
        first = self._setting.options.method
        return (first,) if first is MethodName.IPOPT or self._is_refuge(name) else (first, MethodName.IPOPT)

    def _is_refuge(self, name: str) -> bool:
        """Whether a formulation is solved only where another one failed."""
        return name == WHOLE and self._symmetry is Symmetry.ON

    def _solved_by(self, method: MethodName, name: str) -> Setting:
        """The setting of a formulation; what IPOPT seldom solves is not worth compiling."""
        options, refuge = self._setting.options, self._is_refuge(name)
        native = method is MethodName.NATIVE
        compiled = options.compiled and method is options.method and (native or not refuge)
        changed = replace(options, method=method, compiled=compiled, seldom=native and refuge)
        return replace(self._setting, options=changed)


def _cost(solution: CaseSolution) -> float:
    return np.inf if solution.attempt is None else solution.attempt.cost


def _raw_of(solution: CaseSolution, formulation: str) -> RawSolution | None:
    """The solve that gave a solution, where it is of a formulation."""
    attempt = solution.attempt
    return solution.raw if attempt is not None and attempt.formulation == formulation else None
