"""The posture problem: how robot and person stand with the load at one height, straining least.

    minimise    w_r |tau_r|^2 + w_h |tau_h|^2 + comfort
    subject to  the constraints of both agents and of the load

for any design (a parameter of one program built once). It is solved from a few fixed starts and the best
result that the independent check accepts is kept, so that the answer depends on problem and design alone.

A scene that is its own mirror image is solved for symmetric postures: half the variables and far fewer local
minima. The full program, started from the symmetric solution, is the polish, and the refuge when no symmetric
posture is found.

Source: Sartore et al. 2022, Eq. 14 with pi fixed; DESIGN 3.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from evodesign.design.space import DesignSpace
from evodesign.posture.agent import TORQUE_UNIT, agent_block
from evodesign.posture.check import TOLERANCE, Checker
from evodesign.posture.form import Form, symmetric_forms, whole
from evodesign.posture.load import load_constraints
from evodesign.posture.program import IpoptOptions, Program, RawSolution, Solver
from evodesign.posture.solution import AgentPosture, Attempt, HeightSolution
from evodesign.records import Status, worst_status
from evodesign.statics.scene import HUMAN, ROBOT, Scene

__all__ = ["EffortWeights", "PostureProblem", "Symmetry"]

STARTS: tuple[Mapping[str, float], ...] = ({ROBOT: 0.5, HUMAN: 0.5}, {ROBOT: 1.0, HUMAN: 0.5})
"""Starts, as the share of the way from zero to the middle of each joint's range, by agent.

Of nine such starts this pair gave the best of 19 on 86 % of 42 heights of random designs, within 2 %.
"""


class Symmetry(StrEnum):
    """Which postures are looked for."""

    ON = "on"
    OFF = "off"
    POLISH = "polish"


@dataclass(frozen=True, slots=True)
class EffortWeights:
    """Weights w_r and w_h of the agents' squared torques."""

    robot: float = 1.0
    human: float = 1.0


@dataclass(frozen=True, slots=True)
class Candidate:
    """A start's result after the check."""

    attempt: Attempt
    postures: Mapping[str, AgentPosture]
    residuals: Mapping[str, float]


class PostureProblem:
    """One posture program for all designs and heights of a scene.

    Raises:
        ModelError: symmetric postures of a scene that is not its own mirror image; it says what differs.
    """

    def __init__(
        self,
        scene: Scene,
        space: DesignSpace,
        weights: EffortWeights,
        options: IpoptOptions,
        symmetry: Symmetry,
    ) -> None:
        self._symmetry = symmetry
        self._ingredients = (scene, space, weights, options)
        if symmetry is not Symmetry.OFF:
            space.check_mirror(scene.robot.tree)
            self._half = _Postures(symmetric_forms(scene), *self._ingredients)

    def solve(self, values: Sequence[float], height: float, checker: Checker) -> HeightSolution:
        """The best checked posture of a design at one height.

        Args:
            values: one number per design parameter.
            height: of the load's centre [m].
            checker: the independent check, made for this design.
        """
        parameters = [*values, height]
        if self._symmetry is Symmetry.OFF:
            return _best(height, self._full.tries(parameters, checker))
        candidates = self._half.tries(parameters, checker)
        solved = [c for c in candidates if c.attempt.status is Status.SOLVED]
        if not solved:
            candidates += self._full.tries(parameters, checker)
        elif self._symmetry is Symmetry.POLISH:
            best = min(solved, key=lambda c: c.attempt.cost)
            candidates.append(self._full.polish(parameters, best.postures, checker))
        return _best(height, candidates)

    @cached_property
    def _full(self) -> _Postures:
        """The full program, built when it is first needed."""
        scene = self._ingredients[0]
        return _Postures((whole(scene.robot), whole(scene.human)), *self._ingredients)


class _Postures:
    """A posture program over the given forms, with its starts."""

    def __init__(
        self,
        forms: tuple[Form, Form],
        scene: Scene,
        space: DesignSpace,
        weights: EffortWeights,
        options: IpoptOptions,
    ) -> None:
        self._forms = forms
        self._solver = Solver(_program(forms, scene, space, weights), options)
        self._starts = tuple(_start(self._solver, forms, shares) for shares in STARTS)

    def tries(self, parameters: Sequence[float], checker: Checker) -> list[Candidate]:
        """The result of every start."""
        return [self._try(parameters, start, checker) for start in self._starts]

    def polish(
        self, parameters: Sequence[float], postures: Mapping[str, AgentPosture], checker: Checker
    ) -> Candidate:
        """The result of starting from known whole postures."""
        start = {
            f"{form.agent.name}.{part}": value
            for form in self._forms
            for part, value in _blocks(postures[form.agent.name], self._solver, form.agent.name).items()
        }
        return self._try(parameters, start, checker)

    def _try(self, parameters: Sequence[float], start: Mapping[str, Any], checker: Checker) -> Candidate:
        raw = self._solver.solve(parameters, start)
        postures = {form.agent.name: form.expand(_values_of(form, raw)) for form in self._forms}
        found = checker.residuals(postures, parameters[-1]) if raw.status is Status.SOLVED else {}
        return Candidate(_attempt(raw, found), postures, found)


def _program(forms: tuple[Form, Form], scene: Scene, space: DesignSpace, weights: EffortWeights) -> Program:
    design = ca.SX.sym("design", len(space.parameters))
    height = ca.SX.sym("height")
    tree = space.resized(scene.robot.tree, ca.vertsplit(design))
    robot = agent_block(forms[0], tree, scene, height)
    human = agent_block(forms[1], scene.human.tree, scene, height)
    hands = {ROBOT: robot.hand_wrenches, HUMAN: human.hand_wrenches}
    load = load_constraints(scene, hands, symmetric=forms[0].mirror is not None)
    effort = weights.robot * robot.effort + weights.human * human.effort
    return Program(
        name="posture",
        variables=(*robot.variables, *human.variables),
        constraints=(*robot.constraints, *human.constraints, *load),
        cost=effort / TORQUE_UNIT**2 + robot.comfort + human.comfort,
        parameters=ca.vertcat(design, height),
    )


def _start(solver: Solver, forms: Sequence[Form], shares: Mapping[str, float]) -> dict[str, Any]:
    start = solver.start
    for form in forms:
        block = next(v for v in solver.program.variables if v.name == f"{form.agent.name}.joints")
        middle = (block.lower + block.upper) / 2.0
        start[block.name] = np.clip(shares[form.agent.name] * middle, block.lower, block.upper)
    return start


def _blocks(posture: AgentPosture, solver: Solver, agent: str) -> dict[str, Any]:
    """A whole posture as starting values of a whole agent's variables."""
    rows = {v.name: v.symbol.numel() for v in solver.program.variables}
    hands = {f"{side}_hand": wrench for side, wrench in posture.hand_wrenches.items()}
    return {
        "base_position": posture.base_position,
        "base_angles": posture.base_angles,
        "joints": np.array(list(posture.joints.values())),
        "torques": np.array(list(posture.torques.values())),
        **{name: wrench[: rows[f"{agent}.{name}"]] for name, wrench in hands.items()},
        **{f"{side}_foot": wrench for side, wrench in posture.foot_wrenches.items()},
    }


def _values_of(form: Form, raw: RawSolution) -> dict[str, Any]:
    prefix = f"{form.agent.name}."
    return {name.removeprefix(prefix): v for name, v in raw.values.items() if name.startswith(prefix)}


def _attempt(raw: RawSolution, residuals: Mapping[str, float]) -> Attempt:
    status, reason = raw.status, raw.reason
    if residuals:
        worst = max(residuals, key=lambda name: residuals[name])
        if not residuals[worst] <= TOLERANCE:
            status = Status.NUMERICAL_FAILURE
            reason = f"the check found {worst} {residuals[worst]:.1e} above {TOLERANCE:g}"
    return Attempt(status, reason, raw.iterations, raw.seconds, raw.cost)


def _best(height: float, candidates: Sequence[Candidate]) -> HeightSolution:
    attempts = tuple(candidate.attempt for candidate in candidates)
    solved = [candidate for candidate in candidates if candidate.attempt.status is Status.SOLVED]
    if not solved:
        status = worst_status([attempt.status for attempt in attempts])
        reason = f"no posture found at {height:g} m: " + "; ".join(a.reason for a in attempts)
        return HeightSolution(height, status, reason, {}, {}, attempts)
    best = min(solved, key=lambda candidate: candidate.attempt.cost)
    return HeightSolution(height, Status.SOLVED, "solved", best.postures, best.residuals, attempts)
