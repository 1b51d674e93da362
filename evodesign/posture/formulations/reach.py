"""The reach problem: the highest and lowest load that the robot can hold.

    maximise (minimise) h subject to the robot's constraints and the load's balance,

with the person's hands free to push as they must: the robot's side alone decides. A share of the load that is
given binds here too; where it is free, a robot with rigid grasps may leave the load to the person. A reach
problem is cheaper than a posture, so it is solved first and spares the heights that are out of reach. No load
is sought lower than somebody asks for: at the lowest of all the robot folds up, bodies are in each other's
way, and the best of dozens of optima, which no task needs, is hardly ever found. The problem has
several optima (arms forward, arms raised sideways over the head), so it begins at a portfolio of starts
as a posture does.

Beyond 300 lines: robot's, person's and shared reach are one program with different agents.

Source: feasibility constraints of Sartore et al. 2022, Eq. 14.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from evodesign.mechanics.agent import ROBOT, Role
from evodesign.mechanics.scene import Scene
from evodesign.nlp.method import SolverOptions
from evodesign.nlp.optimality import NotDifferentiable
from evodesign.nlp.program import ConstraintBlock, Program, Start, Variable
from evodesign.nlp.sensitivity import SolutionSensitivity
from evodesign.nlp.solver import RawSolution, Solver, SolverCache
from evodesign.posture.allocation import shared_scene
from evodesign.posture.assemble import CaseSymbols, Embodied, Party, assemble, free_hands_beside, total
from evodesign.posture.formulations.base import Setting, program_key
from evodesign.posture.parting import parted
from evodesign.posture.precompute.precomputed import NOTHING_PRECOMPUTED, PersonReach, Precomputed
from evodesign.posture.seeking.budget import BUDGET
from evodesign.posture.seeking.landscape import Landscape
from evodesign.posture.seeking.seeker import Seeker
from evodesign.posture.seeking.starts import person_starts, universal_starts
from evodesign.posture.solution_derivative import ReachDerivative
from evodesign.posture.symmetry import Form, forms_of
from evodesign.posture.terms.load import any_load
from evodesign.posture.terms.registry import TERMS
from evodesign.posture.warm_start import filled, layout_of
from evodesign.records import Status, worst_status
from evodesign.tree.model import Tree

WEIGHT_OF_REGULARISATION = 1e-4
"""Beside the height [m]; it costs less than 0.1 mm of reach."""

HEIGHT = "height"
"""Name of the variable that is the load's height."""

LEAST = "least_height"
"""Name of the parameter that is the least height of the load [m], and of its row."""

HIGHEST, LOWEST = -1.0, 1.0
"""Sense in which the height is extreme: the sign with which it is minimised."""

FIXED_HEIGHTS = (1.0, 0.6)
"""Where the load is in the starts that know nothing better [m]."""

FIXED: tuple[Start, ...] = tuple({HEIGHT: [height]} for height in FIXED_HEIGHTS)
"""Starts of a robot where there is no portfolio."""


@dataclass(frozen=True, slots=True)
class Reach:
    """The interval of load heights that a robot can hold.

    Args:
        lowest, highest: of the load's centre [m]; None when not solved.
        status: solved, or why not.
        reason: a sentence.
        or_lower: whether loads below the lowest may be held, too: it is the lowest that is asked for.
    """

    lowest: float | None
    highest: float | None
    status: Status
    reason: str
    or_lower: bool = False

    def distance(self, height: float) -> float | None:
        """How far a height [m] lies outside the interval [m]; None when the interval is not known."""
        if self.lowest is None or self.highest is None:
            return None
        return max(height - self.highest, self.lowest - height, 0.0)

    def beyond(self, heights: Sequence[float]) -> float | None:
        """How far the worst of some heights [m] lies outside the interval [m]; None if not known."""
        distances = [self.distance(height) for height in heights]
        return max((each for each in distances if each is not None), default=None)


def interval_text(lowest: float, highest: float, *, or_lower: bool) -> str:
    """Heights between which loads are held, in words."""
    return f"{lowest:.3f} m{' or lower' if or_lower else ''} to {highest:.3f} m"


def common_reach(reaches: Sequence[Reach]) -> Reach:
    """The interval that several loads have in common; the first that failed, if one did."""
    failed = [reach for reach in reaches if reach.lowest is None or reach.highest is None]
    if failed or len(reaches) == 1:
        return (failed or reaches)[0]
    lowest = max(reach.lowest for reach in reaches if reach.lowest is not None)
    highest = min(reach.highest for reach in reaches if reach.highest is not None)
    or_lower = all(reach.or_lower for reach in reaches)
    reason = f"holds every load from {interval_text(lowest, highest, or_lower=or_lower)}"
    return Reach(lowest, highest, Status.SOLVED, reason, or_lower)


class ReachProblem:
    """One reach program for all designs of a scene; built when it is needed.

    Args:
        setting: of the problem; the weights of efforts do not count.
        name: of the robot.
        symmetric: whether postures are mirror-symmetric.
        known: portfolios of starts.
        solvers: of other scenes.
    """

    def __init__(
        self,
        setting: Setting,
        name: str = ROBOT,
        *,
        symmetric: bool,
        known: Precomputed = NOTHING_PRECOMPUTED,
        solvers: SolverCache | None = None,
    ) -> None:
        setting = _with_own_rows(setting, name)
        scene = setting.scene
        self.form = forms_of(scene, symmetric=symmetric)[scene.agents.index(scene.agent(name))]
        self._setting, self._solvers = setting, solvers or SolverCache()
        agent = self.form.agent
        self._starts = dict.fromkeys((HIGHEST, LOWEST), ()) | {
            sense: tuple(_in_place(start, scene.agents[0].name, agent.name) for start in own.starts)
            for sense, own in ((HIGHEST, known.highest), (LOWEST, known.lowest))
            if agent.tree is scene.agents[0].tree
        }
        self._latest: dict[float, tuple[tuple[float, ...], list[RawSolution]]] = {}

    @cached_property
    def _solver(self) -> Solver:
        key = program_key("reach", self._setting.scene, self._setting, self.form)
        return self._solvers.solver(key, self._program, self._setting.options)

    @cached_property
    def _seeker(self) -> Seeker:
        return Seeker(self._solver)

    @cached_property
    def _fixed(self) -> tuple[Start, ...]:
        """Starts where there is no portfolio; the best result counts."""
        if self.form.agent.role is Role.ROBOT:
            return FIXED
        return tuple({**start, **height} for height in FIXED for start in person_starts(self.program))

    @cached_property
    def _sensitivity(self) -> SolutionSensitivity:
        return SolutionSensitivity(self._solver)

    def _program(self) -> Program:
        return robot_reach_program(self.form, self._setting)

    @property
    def program(self) -> Program:
        """What is solved; its parameters are the design, the load's mass and least height, and the sense."""
        return self._solver.program

    def _beside(self, sense: float) -> Mapping[str, float]:
        """The parameters beside the design, of one that holds the load at the lowest height that is asked."""
        least = self._setting.lowest_asked if sense == LOWEST else 0.0
        return {"mass": self._setting.scene.payload.mass, "sense": sense, LEAST: least}

    def landscape(self, sense: float) -> Landscape:
        """Minus the highest (sense -1) or plus the lowest (sense 1) height [m]."""
        universal = tuple({**start, **height} for height in FIXED for start in universal_starts(self.program))
        return Landscape(
            self._seeker,
            self._beside(sense),
            self._fixed,
            0.0,
            BUDGET.near_height,
            universal=universal,
        )

    def solve(self, design: Sequence[float]) -> Reach:
        """The interval of a design, given as one number per design parameter."""
        highest, high = self.extreme(design, HIGHEST)
        lowest, low = self.extreme(design, LOWEST)
        status = worst_status([high.status, low.status])
        if highest is None or lowest is None:
            which, reason = ("highest", high.reason) if highest is None else ("lowest", low.reason)
            return Reach(lowest, highest, status, f"no {which} load height found: {reason}")
        asked = self._setting.lowest_asked
        or_lower = lowest - asked < BUDGET.same_height and asked > 0.0
        reason = f"holds loads from {interval_text(lowest, highest, or_lower=or_lower)}"
        return Reach(lowest, highest, status, reason, or_lower)

    def solves(self, design: Sequence[float], sense: float) -> list[RawSolution]:
        """The result of every start in one sense; that of the latest design is at hand.

        Starts are the portfolio, or fixed ones; a load as low as is asked for is held where the highest is.
        """
        latest = self._latest.get(sense)
        if latest is not None and latest[0] == tuple(design):
            return latest[1]
        starts = [filled(start, self.program) for start in self._starts[sense] or self._fixed]
        parameters = {"design": design, **self._beside(sense)}
        seeker, ways = self._seeker, [starts, [*self._fixed]] if self._starts[sense] else [starts]
        height, highest = self.extreme(design, HIGHEST) if sense == LOWEST else (None, None)
        if highest is not None and height is not None:
            ways.append([highest.values])
        for way in ways:
            found = _best_settled(seeker, parameters, way, sense)
            if any(raw.status is Status.SOLVED for raw in found):
                break
        else:
            if seeker.solver.native:
                found = _best_settled(seeker.by_ipopt, parameters, starts, sense)
        self._latest[sense] = tuple(design), found
        return found

    def extreme(self, design: Sequence[float], sense: float) -> tuple[float | None, RawSolution]:
        """The extreme height in one sense (-1 highest, 1 lowest) and the solve that found it.

        The lowest load of a design that holds none as high as is asked for is its highest one.
        """
        if sense == LOWEST and self._holds_none(design):
            return self.extreme(design, HIGHEST)
        solves = self.solves(design, sense)
        solved = [raw for raw in solves if raw.status is Status.SOLVED]
        if not solved:
            return None, solves[0]
        best = min(solved, key=lambda raw: sense * _height(raw))
        return _height(best), best

    def _holds_none(self, design: Sequence[float]) -> bool:
        """Whether the highest load is lower than any that is asked for."""
        asked = self._setting.lowest_asked
        highest = self.extreme(design, HIGHEST)[0] if asked else None
        return highest is not None and highest <= asked

    def extreme_posture(self, design: Sequence[float], sense: float) -> tuple[Start, ...]:
        """The robot's posture at the extreme height, for other programs to begin at; none if it is not known.

        How bodies are parted is no part of it: other rows part them elsewhere.
        """
        height, raw = self.extreme(design, sense)
        own = layout_of(self.program, self.form.agent.name).values()
        return () if height is None else ({name: raw.values[name] for name in own},)

    def derivative(
        self, design: Sequence[float], sense: float, *, exact: bool = True
    ) -> ReachDerivative | NotDifferentiable:
        """How a design's highest or lowest load moves with the design, or why it has no derivative.

        An extreme height is the solution of the reach problem, not its optimal cost (which holds a little
        regularisation), so its derivative is that of the solution. Every start is solved as for the reach
        itself; the one that counts is differentiated, and the next best other optimum is where another one
        may win; `exact` is that of `SolutionSensitivity.at`.
        """
        if sense == LOWEST and self._holds_none(design):
            return self.derivative(design, HIGHEST, exact=exact)
        solves = self.solves(design, sense)
        heights = {start: _height(raw) for start, raw in enumerate(solves) if raw.status is Status.SOLVED}
        if not heights:
            return NotDifferentiable("no posture was found")
        start = min(heights, key=lambda number: sense * heights[number])
        if self._at_end(heights[start], self._beside(sense)[LEAST]):
            return ReachDerivative(heights[start], np.zeros(len(design)), start, len(solves), None, ())
        parameters = {"design": design, **self._beside(sense)}
        found = self._sensitivity.at_solution(parameters, solves[start], exact=exact)
        if isinstance(found, NotDifferentiable):
            return found
        own = found.along("design")
        slope = own.slopes[HEIGHT][0]
        if np.isnan(slope).any():
            return NotDifferentiable("the height is not determined")
        short = [sense * (height - heights[start]) for height in heights.values()]
        return ReachDerivative(
            height=float(found.values[HEIGHT][0]),
            slope=slope,
            start=start,
            starts=len(solves),
            runner_up=min((much for much in short if much > BUDGET.same_height), default=None),
            limits=own.limits,
        )

    def _at_end(self, height: float, least: float) -> bool:
        """Whether a height ends the range that is asked for, whatever the design: a load on the ground."""
        block = next(v for v in self.program.variables if v.name == HEIGHT)
        lower = max(block.lower[0], least)
        return bool(min(height - lower, block.upper[0] - height) < BUDGET.same_height)


def _with_own_rows(setting: Setting, name: str) -> Setting:
    """The setting with the rows that keep bodies of a robot apart which meet at extreme heights.

    A person's own bodies may pass through each other here, and no measured posture draws the person.
    """
    agent = setting.scene.agent(name)
    if agent.role is Role.PERSON:
        agent = replace(agent, collisions=None, measured=None)
    elif agent.collisions is not None:
        agent = replace(agent, collisions=agent.collisions.at_reach)
    return replace(setting, scene=setting.scene.with_agents(agent))


def _in_place(start: Start, first: str, name: str) -> Start:
    """A start of the first agent for one like it, each in the other's place."""
    if name == first:
        return start
    renamed = {first: name, name: first}
    parts = {key: key.partition(".") for key in start}
    return {f"{renamed.get(who, who)}{dot}{what}": start[key] for key, (who, dot, what) in parts.items()}


def _best_settled(
    seeker: Seeker, parameters: Mapping[str, Any], starts: Sequence[Start], sense: float
) -> list[RawSolution]:
    """The result of every start, of which the most extreme one violates nothing that was switched off."""
    found = seeker.ends(parameters, starts)
    settled: set[int] = set()
    while True:
        solved = [place for place, raw in enumerate(found) if raw.status is Status.SOLVED]
        best = min(solved, key=lambda place: sense * _height(found[place]), default=None)
        if best is None or best in settled:
            return found
        found[best] = seeker.settled(parameters, found[best], BUDGET.part_farther)
        settled.add(best)


def _height(raw: RawSolution) -> float:
    return float(raw.values[HEIGHT][0])


def robot_reach_program(form: Form, setting: Setting, *, switched: bool = False) -> Program:
    """The robot's program; its parameters are the design, the load's mass and the sense."""
    design = ca.SX.sym("design", len(setting.space.parameters))
    values = ca.vertsplit(design)
    agent = form.agent
    tree = setting.space.resized(agent.tree, values) if agent.designed else agent.tree
    scene = shared_scene(setting.scene, setting.space, values)
    return reach_program(form, tree, scene, {"design": design}, switched=switched)


def reach_program(
    form: Form, tree: Tree, scene: Scene, given: Mapping[str, Any], *, switched: bool = False
) -> Program:
    """The program of an agent's extreme heights; the other agent is a pair of free hands.

    Args:
        form: of the agent.
        tree: of the agent.
        scene: load, ground and stance.
        given: parameters that the tree depends on; the program's are these, the load's mass and least
            height, and the sense.
        switched: whether it has the rows that are left out until they are violated.
    """
    given_scene = scene
    scene, mass = any_load(scene)
    sense, least = ca.SX.sym("sense"), ca.SX.sym(LEAST)
    floor = scene.payload.size[2] / 2.0
    height = Variable.column(HEIGHT, [floor], [5.0], [1.0], 1.0)
    parties: list[Party] = [Embodied(form, tree), *free_hands_beside(form, scene)]
    assembly = assemble(parties, TERMS.values(), CaseSymbols(scene, (height.value,)), switched=switched)
    load_case = assembly.undisturbed
    disliked = total([*load_case.regularisation, load_case.free_moments])
    return Program(
        name="reach",
        variables=(height, *assembly.variables),
        constraints=(*assembly.constraints, ConstraintBlock(LEAST, height.value - least, 0.0, np.inf)),
        cost=sense * height.value + WEIGHT_OF_REGULARISATION * disliked,
        parameters={**given, "mass": mass, "sense": sense, LEAST: least, **assembly.given},
        switches=parted(
            assembly.parted, lambda: reach_program(form, tree, given_scene, given, switched=True)
        ),
    )


def people_reach(scene: Scene, options: SolverOptions, *, symmetric: bool) -> PersonReach | None:
    """How low and how high each of a scene's people can hold the load; None when no posture was found."""
    found = [person_reach(scene, person.name, options, symmetric=symmetric) for person in scene.people]
    known = [each for each in found if each is not None]
    if len(known) < len(found):
        return None
    return PersonReach(max(each.lowest for each in known), min(each.highest for each in known))


def person_reach(scene: Scene, name: str, options: SolverOptions, *, symmetric: bool) -> PersonReach | None:
    """How low and how high a scene's person of a name can hold the load; None when no posture was found.

    A person does not depend on the robot, so this is found once per person and load, as the best of many
    starts. Together with a robot's reach it gives the heights at which robot and everyone can hold the load.
    A person's own bodies may pass through each other here, and no measured posture draws the person.
    """
    scene = scene.with_agents(replace(scene.agent(name), collisions=None, measured=None))
    form = forms_of(scene, symmetric=symmetric)[scene.agents.index(scene.agent(name))]
    solver = Solver(reach_program(form, form.agent.tree, scene, {}), options)
    ends: dict[float, float] = {}
    for sense in (LOWEST, HIGHEST):
        parameters = {"mass": scene.payload.mass, "sense": sense, LEAST: 0.0}
        people = person_starts(solver.program)
        starts = [{**start, HEIGHT: [height]} for height in FIXED_HEIGHTS for start in people]
        solves = [solver.solve(parameters, start) for start in starts]
        heights = [float(raw.values[HEIGHT][0]) for raw in solves if raw.status is Status.SOLVED]
        if not heights:
            return None
        ends[sense] = min(heights) if sense == LOWEST else max(heights)
    return PersonReach(ends[LOWEST], ends[HIGHEST])
