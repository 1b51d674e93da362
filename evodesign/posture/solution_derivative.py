"""How a design's postures and reach move with the design: their tangents.

The solved posture is found again by the program that it came from, made exact, and differentiated
(`sensitivity`). Where robot and person were solved one after the other, the person follows the push X:

    d person / d pi = d person / dX  dX / d pi
    d cost / d pi   = d cost_r / d pi + (cost_h'(X) - V'(X)) dX / d pi

with cost_r the robot's optimal cost (which holds V) and cost_h the person's. A push at its limit stays there.

Source: implicit function theorem and envelope theorem, see `sensitivity`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.polynomial import Chebyshev

from evodesign.design.space import DesignSpace
from evodesign.mechanics.scene import ROBOT, SIDES, Scene
from evodesign.nlp.optimality import Array, NotDifferentiable
from evodesign.nlp.program import IpoptOptions, values_under
from evodesign.nlp.sensitivity import Limit, Optimum, SolutionSensitivity
from evodesign.posture.allocation import EffortWeights
from evodesign.posture.formulations.decoupled import DECOUPLED, robot_program
from evodesign.posture.formulations.human_value import HumanValue, human_program
from evodesign.posture.formulations.joint import SYMMETRIC, posture_program
from evodesign.posture.load_cases import postures_in_cases, with_worst
from evodesign.posture.results import AgentPosture, CaseSolution
from evodesign.posture.symmetry import Form, symmetric_forms, whole
from evodesign.posture.warm_start import start_from
from evodesign.records import Task

__all__ = ["PostureDerivative", "PostureDerivatives", "labels_of"]

SAME = 1e-2
"""Difference of torques [N m] below which a posture that is found again is the same one."""

Forms = tuple[Form, Form]


@dataclass(frozen=True, slots=True)
class PostureDerivative:
    """A posture made exact, and how it moves with the design.

    Args:
        forms: of robot and person, for which the values are.
        values: by variable name, SI units.
        slopes: their derivatives with respect to the design's parameters, shape (rows, parameters).
        cost: the least cost of the posture problem.
        cost_slope: its derivative, one per parameter.
        compared: the cost by which starts are compared: with V(X) where the person is solved after the robot.
        limits: every inequality, with slopes per parameter.
    """

    forms: Forms
    values: Mapping[str, Array]
    slopes: Mapping[str, Array]
    cost: float
    cost_slope: Array
    compared: float
    limits: tuple[Limit, ...]

    def postures(self, step: Array) -> dict[str, AgentPosture]:
        """To first order, the postures of a design that differs by a step, one number per parameter."""
        moved = {name: value + self.slopes[name] @ step for name, value in self.values.items()}
        return {form.agent.name: form.expand(values_under(form.agent.name, moved)) for form in self.forms}

    def disturbed(self, scene: Scene, step: Array) -> dict[str, dict[str, AgentPosture]]:
        """Likewise, what is borne under each of the scene's disturbances."""
        moved = {name: value + self.slopes[name] @ step for name, value in self.values.items()}
        return postures_in_cases(scene, self.forms, moved)


class _Way(Protocol):
    """A way of solving postures, with derivatives."""

    def at(self, design: Sequence[float], solution: CaseSolution) -> PostureDerivative | NotDifferentiable:
        """The tangent of a posture that this way might have found."""


class PostureDerivatives:
    """Tangents of the postures that `PostureProblem` finds, built from the same ingredients."""

    def __init__(
        self,
        scene: Scene,
        space: DesignSpace,
        weights: EffortWeights,
        options: IpoptOptions,
        values: Mapping[Task, HumanValue],
    ) -> None:
        self._ingredients = (scene, space, weights, options)
        self._values = values

    def at(self, design: Sequence[float], solution: CaseSolution) -> PostureDerivative | NotDifferentiable:
        """The tangent of a design's solved posture, or why it has none.

        Args:
            design: one number per parameter.
            solution: of that design, solved.
        """
        found = self._way(solution).at(design, solution)
        if isinstance(found, NotDifferentiable):
            return found
        if not _same(found, solution):
            return NotDifferentiable("the posture was not found again")
        return found if _determined(found) else NotDifferentiable("the posture can move at no cost")

    def _way(self, solution: CaseSolution) -> _Way:
        """The program that found a posture, differentiated; built when it is first needed."""
        program = solution.start.partition(":")[0]
        if program == DECOUPLED:
            return self._decoupled
        return self._half if program == SYMMETRIC else self._full

    @cached_property
    def _decoupled(self) -> _Way:
        scene, space, weights, options = self._ingredients
        return _Decoupled(symmetric_forms(scene), scene, space, weights, options, self._values)

    @cached_property
    def _half(self) -> _Way:
        return _Joint(symmetric_forms(self._ingredients[0]), *self._ingredients)

    @cached_property
    def _full(self) -> _Way:
        scene = self._ingredients[0]
        return _Joint((whole(scene.robot), whole(scene.human)), *self._ingredients)


class _Joint:
    """Robot and person in one program."""

    def __init__(
        self, forms: Forms, scene: Scene, space: DesignSpace, weights: EffortWeights, options: IpoptOptions
    ) -> None:
        self._forms, self._mass = forms, scene.payload.mass
        program = posture_program(forms, scene, space, weights)
        self._both = SolutionSensitivity(program, options, labels_of(forms))

    def at(self, design: Sequence[float], solution: CaseSolution) -> PostureDerivative | NotDifferentiable:
        """The tangent of a posture that this program might have found."""
        start = start_from(self._forms, self._both.program, solution.postures, solution.disturbed)
        parameters = [*design, solution.case.task.height_m, self._mass]
        found = self._both.at(parameters, with_worst(start, self._both.program, parameters))
        if isinstance(found, NotDifferentiable):
            return found
        own = slice(len(design))
        return PostureDerivative(
            forms=self._forms,
            values=found.values,
            slopes={name: slope[:, own] for name, slope in found.slopes.items()},
            cost=found.cost,
            cost_slope=found.cost_slope[own],
            compared=found.cost,
            limits=tuple(_in(limit, np.eye(len(found.cost_slope))[:, own]) for limit in found.limits),
        )


class _Decoupled:
    """The robot against the person's value function, and then the person."""

    def __init__(
        self,
        forms: Forms,
        scene: Scene,
        space: DesignSpace,
        weights: EffortWeights,
        options: IpoptOptions,
        values: Mapping[Task, HumanValue],
    ) -> None:
        self._forms, self._scene, self._values = forms, scene, values
        labels = labels_of(forms)
        self._robot = SolutionSensitivity(
            robot_program(forms[0], scene, space, weights.robot), options, labels
        )
        self._human = SolutionSensitivity(human_program(forms[1], scene, weights.human), options, labels)

    def at(self, design: Sequence[float], solution: CaseSolution) -> PostureDerivative | NotDifferentiable:
        """The tangent of a posture that this pair of programs might have found."""
        value = self._values[solution.case.task]
        start = start_from(self._forms, self._robot.program, solution.postures)
        beside = (solution.case.task.height_m, self._scene.payload.mass, *value.coefficients)
        robot = self._robot.at([*design, *beside], start)
        if isinstance(robot, NotDifferentiable):
            return robot
        own = np.eye(len(robot.cost_slope))[:, : len(design)]
        push, push_slope = (self._push(part[f"{ROBOT}.left_hand"]) for part in (robot.values, robot.slopes))
        held = any(limit.active and limit.name == "load.push" for limit in robot.limits)
        human = self._person(solution, float(push), held=held)
        if isinstance(human, NotDifferentiable):
            return human
        follow = np.vstack(
            [np.zeros((2, len(design))), push_slope @ own]
        )  # d (height, mass, push) / d design
        expected = Chebyshev(value.coefficients, domain=[-value.push, value.push])
        surprise = human.cost_slope[2] - float(expected.deriv()(push))
        return PostureDerivative(
            forms=self._forms,
            values={**robot.values, **human.values},
            slopes={
                **{name: slope @ own for name, slope in robot.slopes.items()},
                **{name: slope @ follow for name, slope in human.slopes.items()},
            },
            cost=robot.cost - float(expected(push)) + human.cost,
            cost_slope=robot.cost_slope @ own + surprise * follow[2],
            compared=robot.cost,
            limits=(
                *(_in(limit, own) for limit in robot.limits),
                *(_in(limit, follow) for limit in human.limits),
            ),
        )

    def _person(self, solution: CaseSolution, push: float, *, held: bool) -> Optimum | NotDifferentiable:
        """The person under a push [N]; one that is held at its limit does not move the person."""
        parameters = [solution.case.task.height_m, self._scene.payload.mass, push]
        start = start_from(self._forms, self._human.program, solution.postures)
        raw = self._human.solve(parameters, start)
        if not held:
            return self._human.of(parameters, raw)
        still = {name: np.zeros((len(value), len(parameters))) for name, value in raw.values.items()}
        return Optimum(raw.values, still, raw.cost, np.zeros(len(parameters)), ())

    def _push(self, left_hand: Array) -> Array:
        """The robot's push on the load [N] from the force on its left hand; the right one pushes alike."""
        return np.asarray(-len(SIDES) * self._scene.robot.sign * left_hand[0])


def _in(limit: Limit, change: Array) -> Limit:
    """A limit whose parameters follow others, with their derivatives, shape (parameters, others)."""
    return Limit(limit.name, limit.active, limit.margin, limit.slope @ change)


def _same(derivative: PostureDerivative, solution: CaseSolution) -> bool:
    """Whether a posture that was found again has the torques that it had."""
    found = derivative.postures(np.zeros_like(derivative.cost_slope))
    return all(
        abs(found[agent].torques[joint] - torque) < SAME
        for agent, posture in solution.postures.items()
        for joint, torque in posture.torques.items()
    )


def _determined(derivative: PostureDerivative) -> bool:
    """Whether everything of the agents has a derivative."""
    agents = {form.agent.name for form in derivative.forms}
    return not any(
        np.isnan(slope).any()
        for name, slope in derivative.slopes.items()
        if agents.intersection(name.split("."))  # in every case
    )


def labels_of(forms: Sequence[Form]) -> dict[str, tuple[str, ...]]:
    """Names of joints and trunk frames for the rows of variables and constraints about them."""
    joints = {f"{form.agent.name}.{part}": form.joints for form in forms for part in ("joints", "torques")}
    return joints | {f"{form.agent.name}.trunk_clear": form.trunk for form in forms}
