"""Would a value function of the person pay with rigid grasps?

With rigid grasps the load passes three numbers between robot and person in a symmetric posture: the push X,
the vertical force Z and the moment N on the person's hands. V(X, Z, N) is fitted by a tensor of Chebyshev
polynomials over the box |X| <= push, 0 <= Z <= m g, |N| <= what two hands transmit, and compared with the
best of as many starts at random points of the box. Costs are in 100 N^2 m^2.

    python -m benchmarks.rigid_value [--height 1.0] [--degrees 4 8 8] [--starts 9] [--points 60]
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np
from numpy.polynomial import chebyshev

from benchmarks.inner_problem import problem_at
from evodesign.mechanics.balance import GRAVITY
from evodesign.mechanics.scene import Grasp, Scene
from evodesign.nlp.program import ConstraintBlock, Program
from evodesign.nlp.solver import Solver
from evodesign.posture.assemble import CaseSymbols, Embodied, assemble, free_hands_beside, total
from evodesign.posture.symmetry import Form, symmetric_forms
from evodesign.posture.terms.base import BodyTerm
from evodesign.posture.terms.registry import TERMS
from evodesign.records import Status

MASS, MOMENT = 10.0, 7.0  # of the load [kg]; that a hand transmits [N m]
SHARES, SPREAD = (0.1, 0.5, 1.0), 0.3

Array = Any


def program(form: Form, scene: Scene, height: float) -> Program:
    """The person alone; the parameters are push, vertical force [N] and moment [N m] on both hands."""
    given = ca.SX.sym("given", 3)
    parties = (Embodied(form, form.agent.tree), free_hands_beside(form))
    terms = [term for term in TERMS.values() if isinstance(term, BodyTerm)]
    assembly = assemble(parties, terms, CaseSymbols(scene, (height,)))
    body, person = assembly.undisturbed, form.agent.name
    wrench = 2.0 * body.hands[person]["left"]
    rows = ca.vertcat(wrench[0] - given[0], wrench[2] + given[1], wrench[4] - given[2]) / 10.0
    cost = body.effort({person: 1.0}) + total(body.regularisation)
    own = tuple(v for v in assembly.variables if v.key.party == person)
    held = ConstraintBlock("given", rows, 0.0, 0.0)
    return Program("human", own, (*assembly.constraints, held), cost, {"given": given})


class Person:
    """The least cost of many starts."""

    def __init__(self, solver: Solver, starts: int) -> None:
        self._solver = solver
        block = next(v for v in solver.program.variables if v.drawn)
        middle, rng = (block.lower + block.upper) / 2.0, np.random.default_rng(0)
        noise = [np.zeros(len(middle))] * len(SHARES)
        noise += [SPREAD * rng.standard_normal(len(middle)) for _ in range(starts - len(SHARES))]
        self._starts: list[Any] = [
            {block.name: np.clip(SHARES[i % len(SHARES)] * middle + n, block.lower, block.upper)}
            for i, n in enumerate(noise)
        ]
        self.seconds: list[float] = []

    def cost(self, given: Array) -> float:
        """The best cost that is found; not a number where there is none."""
        ends = [self._solver.solve({"given": given}, start) for start in self._starts]
        self.seconds += [end.seconds for end in ends]
        return min((end.cost for end in ends if end.status is Status.SOLVED), default=np.nan)


def nodes(degree: int) -> Array:
    """Chebyshev nodes of a degree in [-1, 1]."""
    return np.cos(np.pi * (np.arange(degree + 1) + 0.5) / (degree + 1))


def fitted(costs: Array, degrees: Sequence[int]) -> Array:
    """Coefficients of the tensor through costs at the nodes."""
    first, second, third = (np.linalg.inv(chebyshev.chebvander(nodes(d), d)) for d in degrees)
    return np.einsum("ai,bj,ck,ijk->abc", first, second, third, costs)


def main() -> None:
    """Fit, compare, print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--height", type=float, default=1.0)
    parser.add_argument("--degrees", type=int, nargs=3, default=(4, 8, 8))
    parser.add_argument("--starts", type=int, default=9)
    parser.add_argument("--points", type=int, default=60)
    asked = parser.parse_args()
    problem = problem_at((asked.height,))
    load = replace(problem.scene.payload, mass=MASS, grasp=Grasp.RIGID, hand_moment=MOMENT)
    scene = replace(problem.scene, payload=load)
    solver = Solver(program(symmetric_forms(scene)[1], scene, asked.height), problem.options)
    person = Person(solver, asked.starts)
    push = scene.stance.push
    low = np.array([-push, 0.0, -2.0 * MOMENT])
    high = np.array([push, GRAVITY * MASS, 2.0 * MOMENT])
    began = time.perf_counter()
    grid = np.stack(np.meshgrid(*map(nodes, asked.degrees), indexing="ij"), axis=-1)
    costs = np.apply_along_axis(lambda u: person.cost((low + high + u * (high - low)) / 2.0), 3, grid)
    built = time.perf_counter() - began
    coefficients = fitted(costs, asked.degrees)
    points = np.random.default_rng(5).uniform(-1.0, 1.0, (asked.points, 3))
    best = np.array([person.cost((low + high + u * (high - low)) / 2.0) for u in points])
    error = np.abs(chebyshev.chebval3d(*points.T, coefficients) - best)
    print(f"{costs.size} nodes in {built:.0f} s, {1e3 * np.median(person.seconds):.0f} ms a solve (median)")
    print(f"V from {costs.min():.4f} to {costs.max():.4f}, median {np.median(best):.4f}")
    print(
        f"error: median {np.median(error):.4f}, 90 % {np.quantile(error, 0.9):.4f}, worst {error.max():.4f}"
    )


if __name__ == "__main__":
    main()
