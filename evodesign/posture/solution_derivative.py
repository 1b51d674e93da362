"""How a design's postures and reach move with the design, to first order.

The solved posture is found again by the formulation that it came from, made exact, and differentiated
(`nlp.sensitivity`).

Source: implicit function theorem and envelope theorem, see `nlp.sensitivity`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from evodesign.mechanics.scene import Scene
from evodesign.nlp.optimality import Array, NotDifferentiable
from evodesign.nlp.sensitivity import Limit
from evodesign.posture.assemble import Slot
from evodesign.posture.results import CaseSolution, Instant
from evodesign.posture.symmetry import Form
from evodesign.posture.warm_start import Layout, instants_of

SAME = 1e-2
"""Difference of torques [N m] below which a posture that is found again is the same one."""


@dataclass(frozen=True, slots=True)
class PostureDerivative:
    """A posture made exact, and how it moves with the design.

    Args:
        layout: of the variables of both agents.
        forms: of robot and person, for which the values are.
        scene: in which they stand.
        times: of the instants [s].
        values: by variable name, SI units.
        slopes: their derivatives with respect to the design's parameters, shape (rows, parameters).
        cost: the least cost of the posture problem.
        cost_slope: its derivative, one per parameter.
        limits: every inequality, with slopes per parameter.
    """

    layout: Layout
    forms: tuple[Form, ...]
    scene: Scene
    times: tuple[float, ...]
    values: Mapping[str, Array]
    slopes: Mapping[str, Array]
    cost: float
    cost_slope: Array
    limits: Sequence[Limit]

    def moved(self, step: Array) -> tuple[Instant, ...]:
        """To first order, the postures of a design that differs by a step, one number per parameter."""
        moved = {name: value + self.slopes[name] @ step for name, value in self.values.items()}
        return instants_of(self.layout, self.forms, self.scene, moved, self.times)

    def along_torques(
        self, instant: int, load_case: int, weights: Mapping[str, Mapping[str, float]]
    ) -> Array:
        """The gradient of a weighted sum of torques, one per parameter.

        Args:
            instant: its number.
            load_case: zero for the undisturbed one, else one more than the disturbance's number.
            weights: by agent and joint.
        """
        found = np.zeros(len(self.cost_slope))
        for form in self.forms:
            agent = form.agent.name
            if agent in weights:
                slopes = self.slopes[self.layout[Slot(instant, load_case, agent, "torques")]]
                found += form.folded(weights[agent]) @ slopes
        return found


def found_again(
    derivative: PostureDerivative, solution: CaseSolution
) -> PostureDerivative | NotDifferentiable:
    """The derivative, if its posture is the one that was solved and everything of the agents has a slope."""
    for number, instant in enumerate(solution.instants):
        for form in derivative.forms:
            again = derivative.values[derivative.layout[Slot(number, 0, form.agent.name, "torques")]]
            torques = instant.postures[form.agent.name].torques
            known = np.array([torques[joint] for joint in form.joints])
            if not (np.abs(again - known) < SAME).all():
                return NotDifferentiable("the posture was not found again")
    if any(np.isnan(derivative.slopes[name]).any() for name in derivative.layout.values()):
        return NotDifferentiable("the posture can move at no cost")
    return derivative


@dataclass(frozen=True, slots=True)
class ReachDerivative:
    """An extreme height made exact, and how it moves with the design.

    Args:
        height: [m].
        slope: its derivative with respect to each parameter.
        start: which start won, from zero.
        starts: how many there were.
        runner_up: how far the next best other optimum falls short [m]; None when there is no other.
        limits: every inequality, with slopes per parameter.
    """

    height: float
    slope: Array
    start: int
    starts: int
    runner_up: float | None
    limits: Sequence[Limit]
