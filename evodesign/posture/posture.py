"""The posture problem: how robot and person stand with the load at one height, straining least.

    minimise    w_r |tau_r|^2 + w_h |tau_h|^2 + comfort
    subject to  the constraints of both agents and of the load

for any design (a parameter of one program built once). It is solved from a few fixed starts and the best
result that the independent check accepts is kept, so that the answer depends on problem and design alone.

A scene that is its own mirror image is solved for symmetric postures: half the variables and far fewer local
minima. Where the person's value function is known, robot and person are even solved one after the other
(`split`). The full program, started from the symmetric solution, is the polish, and the refuge when no
symmetric posture is found.

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
from evodesign.posture.candidate import Candidate, best_of, checked
from evodesign.posture.check import Checker
from evodesign.posture.form import Form, symmetric_forms, whole
from evodesign.posture.human_value import HumanValue
from evodesign.posture.load import load_constraints
from evodesign.posture.program import IpoptOptions, Program, Solver
from evodesign.posture.solution import AgentPosture, HeightSolution
from evodesign.posture.split import SplitPostures
from evodesign.posture.start import STARTS, joint_starts
from evodesign.records import Status
from evodesign.statics.scene import HUMAN, ROBOT, Scene

__all__ = ["EffortWeights", "PostureProblem", "Symmetry", "posture_program"]


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


class PostureProblem:
    """One posture program for all designs and heights of a scene.

    Args:
        scene: agents, load, ground and stance.
        space: design parameters.
        weights: of the agents' efforts.
        options: of the solver.
        symmetry: which postures are looked for.
        human_values: the person's part at the heights where it is known; of use for symmetric postures only.
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
        human_values: Sequence[HumanValue] = (),
    ) -> None:
        self._symmetry = symmetry
        self._ingredients = (scene, space, weights, options)
        if symmetry is not Symmetry.OFF:
            space.check_mirror(scene.robot.tree)
            self._forms = symmetric_forms(scene)
            self._known = frozenset(value.height for value in human_values)
            if human_values:
                both = (weights.robot, weights.human)
                self._split = SplitPostures(self._forms, scene, space, both, options, human_values)

    def solve(self, values: Sequence[float], height: float, checker: Checker) -> HeightSolution:
        """The best checked posture of a design at one height.

        Args:
            values: one number per design parameter.
            height: of the load's centre [m].
            checker: the independent check, made for this design.
        """
        parameters = [*values, height]
        if self._symmetry is Symmetry.OFF:
            return best_of(height, self._full.tries(parameters, checker))
        candidates: list[Candidate] = []
        if height in self._known:
            candidates += self._split.tries(values, height, checker)
        if not any(candidate.solved for candidate in candidates):
            candidates += self._half.tries(parameters, checker)
        solved = [candidate for candidate in candidates if candidate.solved]
        if not solved:
            candidates += self._full.tries(parameters, checker)
        elif self._symmetry is Symmetry.POLISH:
            best = min(solved, key=lambda c: c.attempt.cost)
            candidates.append(self._full.polish(parameters, best.postures, checker))
        return best_of(height, candidates)

    @cached_property
    def _half(self) -> _Postures:
        """The symmetric program over both agents, built when it is first needed."""
        return _Postures(self._forms, *self._ingredients)

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
        self._solver = Solver(posture_program(forms, scene, space, weights), options)
        self._starts = tuple(joint_starts(self._solver, shares) for shares in STARTS)

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
        postures = {form.agent.name: form.expand(raw.of(form.agent.name)) for form in self._forms}
        found = checker.residuals(postures, parameters[-1]) if raw.status is Status.SOLVED else {}
        return Candidate(checked(raw, found), postures, found)


def posture_program(
    forms: tuple[Form, Form], scene: Scene, space: DesignSpace, weights: EffortWeights
) -> Program:
    """The program over both agents; its parameters are the design's, then the height."""
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
