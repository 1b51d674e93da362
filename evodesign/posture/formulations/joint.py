"""Robot and person in one program: how they stand at every instant of a task, at the least effort.

    minimise    w_r |tau_r|^2 + w_h |tau_h|^2 + regularisation
    subject to  every term, for both agents and the load

for any design (a parameter of one program built once).

Beyond 300 lines: the steps from starts to an accepted posture stand in the order in which they happen.

Source: Sartore et al. 2022, Eq. 14 with pi fixed.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property, partial
from typing import Any

import casadi as ca
import numpy as np

from evodesign.mechanics.agent import Role
from evodesign.nlp.optimality import NotDifferentiable
from evodesign.nlp.program import Program, Start
from evodesign.nlp.sensitivity import SolutionSensitivity
from evodesign.nlp.solver import RawSolution, Solver, SolverCache
from evodesign.posture.active_limits import LimitSlopes, priced
from evodesign.posture.allocation import shared_scene, shared_weights
from evodesign.posture.assemble import CaseSymbols, assemble, total
from evodesign.posture.check import Checker, own_overlaps
from evodesign.posture.formulations.base import Setting, embodied, program_key
from evodesign.posture.formulations.person import PersonProblem
from evodesign.posture.load_cases import WorstCase, aggregated
from evodesign.posture.parting import Parted, parted
from evodesign.posture.results import CaseSolution, Instant
from evodesign.posture.seeking.budget import BUDGET
from evodesign.posture.seeking.candidate import Candidate, Finishing, Trial, cheapest, checked
from evodesign.posture.seeking.exchange import Exchange
from evodesign.posture.seeking.landscape import REFUSED, Landscape
from evodesign.posture.seeking.measured_starts import POSTURE, measured_starts
from evodesign.posture.seeking.seeker import Seeker
from evodesign.posture.seeking.starts import (
    NamedStart,
    different_people,
    fixed_starts,
    named_starts,
    universal_starts,
)
from evodesign.posture.solution_derivative import PostureDerivative, found_again
from evodesign.posture.symmetry import Form
from evodesign.posture.terms.load import any_load
from evodesign.posture.terms.measured_posture import any_person, person_parameters
from evodesign.posture.terms.registry import TERMS
from evodesign.posture.warm_start import filled, instants_of, layout_of, start_from
from evodesign.records import ActiveLimit, Status
from evodesign.tasks import Hold, Task, TaskRecord


class JointPostures:
    """A posture program over the given forms of both agents.

    Args:
        name: of the formulation.
        forms: of all agents of the scene, in their order.
        setting: of the problem.
        solvers: of other scenes.
        kind: of the tasks.
        others: starts of which some people are put beside the best robot that a design's own starts lead to.
    """

    def __init__(
        self,
        name: str,
        forms: tuple[Form, ...],
        setting: Setting,
        solvers: SolverCache,
        kind: type[TaskRecord] = Hold,
        others: Sequence[Start] = (),
    ) -> None:
        self.name, self._others = name, others
        self._forms, self._setting, self._solvers, self._kind = forms, setting, solvers, kind
        self._fixed_of: dict[Task, tuple[Start, ...]] = {}

    @cached_property
    def _solver(self) -> Solver:
        key = program_key(self.name, self._setting.scene, self._setting, self._forms, self._kind.__qualname__)
        return self._solvers.solver(key, self._program, self._setting.options)

    @cached_property
    def _seeker(self) -> Seeker:
        return Seeker(self._solver)

    @cached_property
    def _undisturbed(self) -> JointPostures | None:
        """Without disturbances; None where there are none."""
        scene = self._setting.scene
        if not scene.disturbances:
            return None
        setting = replace(self._setting, scene=scene.undisturbed)
        return JointPostures(self.name, self._forms, setting, self._solvers, self._kind)

    @cached_property
    def _worst(self) -> WorstCase:
        return WorstCase(self._solver.program)

    def _fixed(self, task: Task) -> tuple[Start, ...]:
        """Starts that know nothing better."""
        if task not in self._fixed_of:
            self._fixed_of[task] = self._fixed_starts(task)
        return self._fixed_of[task]

    def _fixed_starts(self, task: Task) -> tuple[Start, ...]:
        """With a person who is drawn to measured postures at their mean, and at two others."""
        program = self._solver.program
        starts = fixed_starts(program, self._people_names)
        people = self._measured(task)
        if people:
            mean, *others = people
            robots = (*((start, mean) for start in starts), *((starts[0], person) for person in others))
            starts = tuple({**robot, **person} for robot, person in robots)
        return starts[:1] if self._setting.options.seldom else starts  # docs/benchmarks.md

    @cached_property
    def _people_names(self) -> tuple[str, ...]:
        return tuple(form.agent.name for form in self._forms if form.agent.role is Role.PERSON)

    def _measured(self, task: Task) -> list[Start]:
        """The people's side of starts at measured postures; none where nobody is drawn to one."""
        program, scene = self._solver.program, self._setting.scene
        own = [measured_starts(program, form, scene, task.heights) for form in self._forms]
        return [
            {name: values for start in starts for name, values in start.items()}
            for starts in zip(*filter(None, own), strict=True)
        ]

    @cached_property
    def _standing(self) -> tuple[str, ...]:
        """Names of the variables that say where people's bases and joints are."""
        own = layout_of(self._solver.program, *self._people_names).items()
        return tuple(name for slot, name in own if slot.part in POSTURE)

    @cached_property
    def _people(self) -> list[Start]:
        return different_people(self._solver.program, self._others, self._people_names)

    @cached_property
    def _exchange(self) -> Exchange:
        return Exchange(self._solver.program, self._forms)

    @cached_property
    def _sensitivity(self) -> SolutionSensitivity:
        return SolutionSensitivity(self._solver)

    @cached_property
    def _limit_slopes(self) -> LimitSlopes:
        return LimitSlopes(self._solver.program)

    def _program(self) -> Program:
        return posture_program(self._forms, self._setting, self._kind)

    def landscape(self, task: Task) -> Landscape:
        """The program's cost for a task."""
        program, people = self._solver.program, self._known_people(task)
        return Landscape(
            self._seeker,
            self._beside(task),
            self._fixed(task),
            *BUDGET.near,
            begun=self._begun,
            universal=universal_starts(program, people),
            known=people,
        )

    def _known_people(self, task: Task) -> tuple[Start, ...]:
        """The person's side of starts: the mean of measured postures, or what costs the person alone least.

        Agents mostly push or pull as far as they may, so the person alone does both. Whole people have more
        ways to stand than a few stand for: theirs is not known.
        """
        program, setting, measured = self._solver.program, self._setting, self._measured(task)
        roles, form = [form.agent.role for form in self._forms], self._forms[-1]
        if measured or roles != [Role.ROBOT, Role.PERSON] or form.mirror is None:
            return tuple(measured[:1])
        own = layout_of(program, *self._people_names).values()
        scene = setting.scene.undisturbed
        alone = PersonProblem(form, scene, setting.weights.human, setting.options, self._solvers)
        pushes = dict.fromkeys((-scene.stance.push, scene.stance.push))
        ends = [alone.best_of_many(task.heights[0], push) for push in pushes]
        return tuple({name: end.values[name] for name in own if name in end.values} for end in ends if end)

    @cached_property
    def person(self) -> frozenset[str]:
        """Names of all that starts say of people."""
        program = self._solver.program
        own, switches = layout_of(program, *self._people_names).values(), program.switches
        if not isinstance(switches, Parted):
            return frozenset(own)
        return frozenset(own).union(*map(switches.names_of, self._people_names))

    def cleared(self, design: Sequence[float], raw: RawSolution, task: Task, checker: Checker) -> RawSolution:
        """What a solution leads to in which the check finds no bodies in each other, or one that failed.

        Where it finds some, their rows ask for as much more as they lack, and the solve goes on.
        """
        parameters = {"design": design, **self._beside(task)}
        switches = self._solver.program.switches
        for _ in range(BUDGET.rounds):
            overlaps = checker.overlaps(self._instants(raw, task), task.heights)
            if not any(overlaps):
                return raw
            if not isinstance(switches, Parted):
                break
            on = switches.wider(raw.values, parameters, [own_overlaps(gaps) for gaps in overlaps])
            if not on:
                break
            raw = self._seeker.further(parameters, raw, on)
            if raw.status is not Status.SOLVED:
                break
        return replace(raw, status=Status.NUMERICAL_FAILURE, reason=REFUSED)

    def starts(self, task: Task, portfolio: Sequence[Start] = ()) -> list[NamedStart]:
        """Those of a portfolio, or the fixed ones if none of it fits.

        Beside a robot alone a measured person stands at the mean: in a T-pose the direction of the upper arm
        has no derivative.
        """
        if portfolio and any(form.agent.measured is not None for form in self._forms):
            mean = {name: self._fixed(task)[0][name] for name in self._standing}
            portfolio = [{**mean, **start} for start in portfolio]
        return named_starts(self._solver, portfolio, self._fixed(task))

    def start_at(self, known: Sequence[Instant], name: str = "neighbour") -> NamedStart:
        """A start at known postures."""
        return name, start_from(self._solver.program, self._forms, known)

    def solve(
        self,
        design: Sequence[float],
        task: Task,
        starts: Sequence[NamedStart],
        checker: Checker,
        *,
        people: bool = False,
    ) -> Trial:
        """The best checked posture that starts lead to.

        Args:
            design: one number per design parameter.
            task: of the problem.
            starts: of it.
            checker: the independent check, made for this design.
            people: whether people of other starts are put beside the best robot, too.
        """
        parameters = {"design": design, **self._beside(task)}
        names, given = [name for name, _ in starts], [self._begun(start, parameters) for _, start in starts]
        ends = [*zip(names, self._seeker.ends(parameters, given), strict=True)]
        solved = [end for end in ends if end[1].status is Status.SOLVED]
        ends += self._exchanged(parameters, solved)
        if solved:
            name, best = min(solved, key=lambda end: end[1].cost)
            ends += [
                (f"{name}, person {number}", self._solver.solve(parameters, {**best.values, **person}))
                for number, person in enumerate(self._people if people else (), 1)
            ]
        return cheapest(self.name, ends, self._finishing(parameters, task, checker))

    def sketched(self, design: Sequence[float], task: Task, portfolio: Sequence[Start]) -> Trial:
        """What the first start leads to without disturbances and with no rows on that part bodies."""
        simple = self._undisturbed or self
        name, start = named_starts(simple._solver, portfolio, simple._fixed(task))[0]
        switches = simple._solver.program.switches
        if switches is not None:
            start = {key: value for key, value in start.items() if key not in switches.names}
        parameters = {"design": design, **simple._beside(task)}
        raw = simple._solver.solve(parameters, simple._begun(start, parameters))
        attempt = checked(self.name, name, raw, ())
        found = Candidate(attempt, simple._instants(raw, task), (), raw)
        return Trial((attempt,), found if found.solved else None)

    def cheaper(
        self, design: Sequence[float], task: Task, neighbour: CaseSolution, checker: Checker, most: float
    ) -> Trial:
        """What the solution in a similar scene leads to, where that promises to cost less than `most`."""
        parameters = {"design": design, **self._beside(task)}
        name, start = self.start_at(neighbour.instants)
        raw = self._seeker.brief.solve(parameters, self._begun(start, parameters))
        if raw.status is Status.SOLVED and raw.cost < most:
            return cheapest(self.name, [(name, raw)], self._finishing(parameters, task, checker))
        return Trial((checked(self.name, name, raw, ()),), None)

    def followed(
        self, design: Sequence[float], solution: CaseSolution, raw: RawSolution
    ) -> CaseSolution | None:
        """The postures of another design near those of a solution."""
        task, solver = solution.case.task, self._solver
        parameters = {"design": design, **self._beside(task)}
        start = self._begun(self._seeker.needed(raw), parameters)
        raw = solver.near.solve(parameters, start)  # the check comes later
        if raw.status is not Status.SOLVED:
            return None
        return replace(solution, instants=self._instants(raw, task), raw=raw)

    def finished(self, design: Sequence[float], task: Task, raw: RawSolution, checker: Checker) -> Trial:
        """A solve for this design that was not checked, checked."""
        found = self._candidate("neighbour", raw, task, checker)
        if found.solved:
            return Trial((found.attempt,), found)
        parameters = {"design": design, **self._beside(task)}
        finishing = self._finishing(parameters, task, checker, gain=np.inf)
        return cheapest(self.name, [("neighbour", raw)], finishing)

    def derivative(
        self, design: Sequence[float], solution: CaseSolution, *, exact: bool = True
    ) -> PostureDerivative | NotDifferentiable:
        """How a posture that this program found moves with the design."""
        program = self._sensitivity.program
        parameters = {"design": design, **self._beside(solution.case.task)}
        if solution.raw is None:
            start = self._begun(start_from(program, self._forms, solution.instants), parameters)
            found = self._sensitivity.at(parameters, start, exact=exact)
        else:
            found = self._sensitivity.at_solution(parameters, solution.raw, exact=exact)
        if isinstance(found, NotDifferentiable):
            return found
        own = found.along("design")
        derivative = PostureDerivative(
            layout=layout_of(program),
            forms=self._forms,
            scene=self._setting.scene,
            times=solution.case.task.times,
            values=own.values,
            slopes=own.slopes,
            cost=own.cost,
            cost_slope=own.cost_slope,
            limits=own.limits,
        )
        return found_again(derivative, solution)

    def active_limits(self, design: Sequence[float], solution: CaseSolution) -> tuple[ActiveLimit, ...]:
        """Which limits hold a posture that this program found, and what they cost."""
        if solution.raw is None:
            return ()
        parameters = {"design": design, **self._beside(solution.case.task)}
        return priced(self._limit_slopes.of(parameters, solution.raw), solution.raw.cost)

    def _instants(self, raw: RawSolution, task: Task) -> tuple[Instant, ...]:
        layout, scene = layout_of(self._solver.program), self._setting.scene
        return instants_of(layout, self._forms, scene, raw.values, task.times)

    def _beside(self, task: Task) -> Mapping[str, Any]:
        """The parameters beside the design."""
        scene = self._setting.scene
        return {**task.given, "mass": scene.payload.mass, **person_parameters(scene)}

    def _exchanged(
        self, parameters: Mapping[str, Any], solved: Sequence[tuple[str, RawSolution]]
    ) -> list[tuple[str, RawSolution]]:
        """Where the most promising robot leads beside the most promising person, if they are of two ends."""
        weights = shared_weights(self._setting.weights, self._setting.space, parameters["design"])
        pair = self._exchange.best([raw.values for _, raw in solved], weights)
        if pair is None:
            return []
        (name, robot), (other, person) = (solved[place] for place in pair)
        start = {**robot.values, **{key: person.values[key] for key in self.person & person.values.keys()}}
        return [
            (f"{name}, person of {other}", self._solver.solve(parameters, self._begun(start, parameters)))
        ]

    def _finishing(
        self, parameters: Mapping[str, Any], task: Task, checker: Checker, gain: float = 0.0
    ) -> Finishing:
        """How ends are settled with a gain, and checked."""
        seeker = self._seeker
        return Finishing(
            settle=partial(seeker.settled, parameters, gain=gain),
            better=partial(seeker.bettered, parameters),
            finish=lambda start, raw: self._candidate(start, raw, task, checker),
            clear=lambda raw: self.cleared(parameters["design"], raw, task, checker),
            go_on=partial(seeker.continued, parameters),
        )

    def _candidate(self, start: str, raw: RawSolution, task: Task, checker: Checker) -> Candidate:
        """A solve that succeeded, after the check."""
        instants = self._instants(raw, task)
        residuals = checker.task_residuals(instants, task.heights)
        return Candidate(checked(self.name, start, raw, residuals), instants, residuals, raw)

    def _begun(self, start: Start, parameters: Mapping[str, Any]) -> Start:
        """A start in which disturbed load cases begin as the undisturbed one, and s with them."""
        return self._worst.put(filled(start, self._solver.program), parameters)


def posture_program(
    forms: tuple[Form, ...], setting: Setting, kind: type[TaskRecord] = Hold, *, switched: bool = False
) -> Program:
    """The program over both agents; parameters are the design, the task's numbers, load's mass, and who."""
    space = setting.space
    scene, mass = any_load(setting.scene)
    scene, person = any_person(scene)
    design = ca.SX.sym("design", len(space.parameters))
    given = {name: ca.SX.sym(name) for name in kind.PARAMETERS}
    values = ca.vertsplit(design)
    scene, weights = shared_scene(scene, space, values), shared_weights(setting.weights, space, values)
    by_agent = weights.by_agent(scene.agents)
    case = CaseSymbols(scene, kind.load_heights(given))
    assembly = assemble(embodied(forms, space, values), TERMS.values(), case, switched=switched)
    undisturbed = [load_cases[0] for load_cases in assembly.instants]
    whole = [part for each in undisturbed for part in (each.effort(by_agent), *each.regularisation)]
    program = Program(
        name="posture",
        variables=assembly.variables,
        constraints=assembly.constraints,
        cost=total(whole),
        parameters={"design": design, **given, "mass": mass, **person, **assembly.given},
        switches=parted(assembly.parted, lambda: posture_program(forms, setting, kind, switched=True)),
    )
    if not scene.disturbances:
        return program
    every = [each for load_cases in assembly.instants for each in load_cases]
    costs = [total([each.effort(by_agent), *each.costs]) for each in every]
    posture = replace(program, cost=total(cost for each in undisturbed for cost in each.posture_costs))
    return aggregated(posture, scene.disturbances.effort, costs)
