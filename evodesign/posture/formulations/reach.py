"""The reach problem: the highest and lowest load that the robot can hold.

    maximise (minimise) h subject to the robot's constraints and the load's balance,

with the person's hands free to push as they must: the robot's side alone decides. A share of the load that is
given binds here too; where it is free, a robot with rigid grasps may leave the load to the person. A reach
problem is cheaper than a posture, so it is solved first and spares the heights that are out of reach. It has
several optima (arms forward, arms raised sideways over the head), so it begins at seeds as a posture does.

Source: DESIGN 3 (reach); feasibility constraints of Sartore et al. 2022, Eq. 14.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca

from evodesign.design.space import DesignSpace
from evodesign.mechanics.scene import HUMAN, ROBOT, Scene
from evodesign.nlp.program import IpoptOptions, Program, RawSolution, Start, Variable
from evodesign.nlp.solver_cache import SolverCache, program_key
from evodesign.nlp.start_portfolio import Landscape
from evodesign.posture.allocation import shared_scene
from evodesign.posture.load_cases import cases_of, filled, with_cases
from evodesign.posture.precompute.precomputed import NOTHING_PRECOMPUTED, Precomputed
from evodesign.posture.symmetry import Form, symmetric_forms, whole
from evodesign.posture.terms.agent import agent_block
from evodesign.posture.terms.grasp import free_hands
from evodesign.posture.terms.load import any_load, load_constraints
from evodesign.records import Status, worst_status
from evodesign.tree.model import Tree

__all__ = ["HIGHEST", "LOWEST", "Reach", "ReachProblem", "common_reach", "reach_program"]

Expression = Any

COMFORT = 1e-4
"""Weight of the comfort terms beside the height [m]; it costs less than 0.1 mm of reach."""

HIGHEST, LOWEST = -1.0, 1.0
"""Sense in which the height is extreme: the sign with which it is minimised."""

FIXED: tuple[Start, ...] = ({"height": [1.0]}, {"height": [0.6]})
"""Starts where there are no seeds; the best result counts."""

NEAR_HEIGHT = 0.005
"""How far [m] from the best known extreme another one is still good."""


@dataclass(frozen=True, slots=True)
class Reach:
    """The interval of load heights that a robot can hold.

    Args:
        lowest, highest: of the load's centre [m]; None when not solved.
        status: solved, or why not.
        reason: a sentence.
    """

    lowest: float | None
    highest: float | None
    status: Status
    reason: str

    def distance(self, height: float) -> float | None:
        """How far a height [m] lies outside the interval [m]; None when the interval is not known."""
        if self.lowest is None or self.highest is None:
            return None
        return max(height - self.highest, self.lowest - height, 0.0)


def common_reach(reaches: Sequence[Reach]) -> Reach:
    """The interval that several loads have in common; the first that failed, if one did."""
    failed = [reach for reach in reaches if reach.lowest is None or reach.highest is None]
    if failed or len(reaches) == 1:
        return (failed or reaches)[0]
    lowest = max(reach.lowest for reach in reaches if reach.lowest is not None)
    highest = min(reach.highest for reach in reaches if reach.highest is not None)
    reason = f"holds every load from {lowest:.3f} to {highest:.3f} m"
    return Reach(lowest, highest, Status.SOLVED, reason)


class ReachProblem:
    """One reach program for all designs of a scene.

    Attributes:
        form: of the robot.
        mass: of the load [kg].
    """

    def __init__(
        self,
        scene: Scene,
        space: DesignSpace,
        options: IpoptOptions,
        *,
        symmetric: bool,
        known: Precomputed = NOTHING_PRECOMPUTED,
        solvers: SolverCache | None = None,
    ) -> None:
        self.mass = scene.payload.mass
        self.form = symmetric_forms(scene)[0] if symmetric else whole(scene.robot)
        key = ("reach", program_key(scene))
        self._solver = (solvers or SolverCache()).solver(
            key, lambda: _robot(self.form, scene, space), options
        )
        self._seeds = {HIGHEST: known.highest.seeds, LOWEST: known.lowest.seeds}

    @property
    def program(self) -> Program:
        """What is solved; its parameters are the design's, then the load's mass and the sense."""
        return self._solver.program

    def landscape(self, sense: float) -> Landscape:
        """Minus the highest (sense -1) or plus the lowest (sense 1) height [m], of which seeds are made."""
        return Landscape(self._solver, (self.mass, sense), FIXED, 0.0, NEAR_HEIGHT)

    def solve(self, values: Sequence[float]) -> Reach:
        """The interval of a design, given as one number per design parameter."""
        highest, high = self._extreme(values, HIGHEST)
        lowest, low = self._extreme(values, LOWEST)
        status = worst_status([high.status, low.status])
        if status is not Status.SOLVED:
            which = "highest" if high.status is not Status.SOLVED else "lowest"
            reason = high.reason if high.status is not Status.SOLVED else low.reason
            return Reach(lowest, highest, status, f"no {which} load height found: {reason}")
        return Reach(lowest, highest, status, f"holds loads from {lowest:.3f} to {highest:.3f} m")

    def solves(self, values: Sequence[float], sense: float) -> list[RawSolution]:
        """The result of every start in one sense."""
        starts = [filled(start, self.program) for start in self._seeds[sense] or FIXED]
        return [self._solver.solve([*values, self.mass, sense], start) for start in starts]

    def _extreme(self, values: Sequence[float], sense: float) -> tuple[float | None, RawSolution]:
        """The extreme height in one sense (-1 highest, 1 lowest) and the solve that found it."""
        solves = self.solves(values, sense)
        solved = [raw for raw in solves if raw.status is Status.SOLVED]
        if not solved:
            return None, solves[0]
        best = min(solved, key=lambda raw: sense * float(raw.values["height"][0]))
        return float(best.values["height"][0]), best


def _robot(form: Form, scene: Scene, space: DesignSpace) -> Program:
    """The robot's program; its parameters are the design's, then the load's mass and the sense."""
    design = ca.SX.sym("design", len(space.parameters))
    values = ca.vertsplit(design)
    tree = space.resized(scene.robot.tree, values)
    return reach_program(form, tree, shared_scene(scene, space, values), design)


def reach_program(form: Form, tree: Tree, scene: Scene, given: Expression) -> Program:
    """The program of an agent's extreme heights; the other agent is a pair of free hands.

    Args:
        form: of the agent.
        tree: of the agent.
        scene: load, ground and stance.
        given: parameters that the tree depends on; the program's are these, the load's mass and the sense.
    """
    scene, mass = any_load(scene)
    sense = ca.SX.sym("sense")
    floor = scene.payload.size[2] / 2.0
    height = Variable.column("height", [floor], [5.0], [1.0], 1.0)
    body = agent_block(form, tree, scene, height.value)
    partner = free_hands(form, scene)
    other = HUMAN if form.agent.name == ROBOT else ROBOT
    hands = {form.agent.name: body.hand_wrenches, other: partner.wrenches}
    load = load_constraints(scene, hands, symmetric=form.mirror is not None)
    program = Program(
        name="reach",
        variables=(height, *body.variables, *partner.variables),
        constraints=(*body.constraints, *load),
        cost=sense * height.value + COMFORT * (body.comfort + partner.comfort),
        parameters=ca.vertcat(given, mass, sense),
    )
    return with_cases(program, cases_of(scene, body.stand))
