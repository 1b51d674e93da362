"""The gradients of a problem's objectives against finite differences of the objectives themselves.

    python benchmarks/gradients.py [--designs N]

Random designs of the point-grasp problem are evaluated as a search evaluates them, from the seeds, with a
tighter tolerance; so are their neighbours along every parameter. Central differences at two steps,
extrapolated to none, are compared with the gradients, each component times its parameter's range, relative to
the largest. A design is left out, and counted, where a point without a derivative is near.
"""

from __future__ import annotations

import argparse
import json
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from evodesign.evaluation.evaluate import Evaluator
from evodesign.evaluation.factory import evaluator_of
from evodesign.evaluation.sensitivities import DesignDerivative, Sensitivities
from evodesign.posture.precompute.precomputed import Precomputed
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.source import read_source
from evodesign.quantities.design_result import DesignResult
from evodesign.quantities.objectives import objective_kinds

OBJECTIVES = objective_kinds()

HERE = Path(__file__).parent
TOLERANCE = 1e-12
STEP = 2e-5
"""Larger step of the differences, as a share of a parameter's range; the other is half of it."""

OTHER = 0.02
"""Difference of a joint [rad] between neighbours above which a posture is another one."""

OTHER_REACH = 0.001
"""Difference of the reach [m] between neighbours above which another optimum was found."""

CLEAR = 1e-3
"""Share of a range within which no limit may change."""

SMALL = 1e-2
"""Gradient per range, relative to its objective, below which errors are relative to this and not to it."""


@dataclass(frozen=True, slots=True)
class Comparison:
    """One design: the largest relative error per objective, or why it was left out."""

    errors: dict[str, float]
    left_out: str


class Comparer:
    """Gradients and differences of a problem's designs."""

    def __init__(self, problem: DesignProblem, known: Precomputed) -> None:
        self._problem = replace(
            problem, options=replace(problem.options, tolerance=TOLERANCE, compiled=False)
        )
        self._evaluator = Evaluator(self._problem, known)
        self._sensitivities = Sensitivities(self._problem, known)

    def compare(self, values: Sequence[float], directions: Sequence[Sequence[float]]) -> Comparison:
        """Errors of a design's gradients along directions of the unit cube."""
        result = self._evaluator.solve(values)
        if not all(height.solved for height in result.cases):
            return Comparison({}, "a height is out of reach")
        derivative = self._sensitivities.at(values, result)
        left_out = self._kink(derivative, np.array(directions))
        if left_out:
            return Comparison({}, left_out)
        ranges = np.array([p.upper - p.lower for p in self._problem.space.parameters])
        neighbours = [self._around(values, np.array(direction) * ranges) for direction in directions]
        if any(_elsewhere(result, other) for pairs in neighbours for pair in pairs for other in pair):
            return Comparison({}, "another optimum wins at a neighbour")
        errors = {}
        for name, found in derivative.sensitivities().items():
            gradient = np.array(directions) @ (np.array(list(found.gradient.values())) * ranges)
            differences = np.array([_extrapolated(name, pairs) for pairs in neighbours])
            size = max(np.abs(gradient).max(), SMALL * abs(OBJECTIVES[name].value(result)))
            errors[name] = float(np.abs(gradient - differences).max() / size)
        return Comparison(errors, "")

    def _around(self, values: Sequence[float], along: np.ndarray) -> list[tuple[DesignResult, DesignResult]]:
        """Results at both sides of a design, one and half a step away."""
        return [
            (
                self._evaluator.solve((np.array(values) + share * along).tolist()),
                self._evaluator.solve((np.array(values) - share * along).tolist()),
            )
            for share in (STEP, STEP / 2.0)
        ]

    def _kink(self, derivative: DesignDerivative, directions: np.ndarray) -> str:
        """Why a design is left out before any difference is taken; empty for most."""
        ranges = np.array([p.upper - p.lower for p in self._problem.space.parameters])
        for part in (*derivative.cases, derivative.highest):
            if not hasattr(part, "limits"):
                return part.reason
            for limit in part.limits:
                if (np.abs(directions @ (limit.slope * ranges)) * CLEAR > limit.margin).any():
                    return f"a limit is reached or left within {CLEAR:g} of a range"
        return ""


def _extrapolated(name: str, pairs: Sequence[tuple[DesignResult, DesignResult]]) -> float:
    """The derivative per range from differences at two steps (Richardson)."""
    value = OBJECTIVES[name].value
    far, near = (
        (value(after) - value(before)) / (2.0 * share)
        for (after, before), share in zip(pairs, (STEP, STEP / 2.0), strict=True)
    )
    return (4.0 * near - far) / 3.0


def _elsewhere(result: DesignResult, neighbour: DesignResult) -> bool:
    """Whether a neighbour's postures or reach are others, and not the same ones a little moved."""
    return abs(result.reach.highest - neighbour.reach.highest) > OTHER_REACH or any(
        not other.solved or abs(other.postures[agent].joints[joint] - position) > OTHER
        for height, other in zip(result.cases, neighbour.cases, strict=True)
        for agent, posture in height.postures.items()
        for joint, position in posture.joints.items()
    )


def main() -> None:
    """Compare until enough designs were, and write what came out."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--designs", type=int, default=20)
    wanted = parser.parse_args().designs
    problem = build_problem(read_source(HERE.parent / "problems" / "point_grasp.toml"))
    known = evaluator_of(problem, 2).known
    comparer = Comparer(problem, known)
    rng = np.random.default_rng(11)
    compared, left_out = [], Counter()
    while len(compared) < wanted:
        genome = tuple(rng.uniform(size=len(problem.space.parameters)).tolist())
        found = comparer.compare(problem.space.values(genome), np.eye(len(genome)).tolist())
        if found.left_out:
            left_out[found.left_out] += 1
            print("left out:", found.left_out)
        else:
            compared.append(found.errors)
            print(" ".join(f"{name} {error:.1e}" for name, error in found.errors.items()), flush=True)
    worst = {name: max(errors[name] for errors in compared) for name in compared[0]}
    evaluation_json = {"designs": wanted, "left_out": dict(left_out), "largest_relative_error": worst}
    print(json.dumps(evaluation_json, indent=2))
    (HERE / "results" / "gradients.json").write_text(json.dumps(evaluation_json, indent=2) + "\n")


if __name__ == "__main__":
    main()
