"""The gradients of a lift's objectives against differences of solves, on random designs of icub_lift.

Every design is evaluated as a search with gradients does it. Then its motion is solved again, with as many
knots, for neighbours along every parameter, to 1e-12 and from the design's own motion. Central differences
at a step and at half of it are extrapolated to none (Richardson); the difference between both is the error
that they own to. Where it is not small a smaller step is tried, and the one with the least such error counts.
Components are per range of the parameter; errors are relative to the gradient's largest component, or to a
thousandth of the objective's value or of its unit where one of those is larger. Results go to
benchmarks/results/lift_gradients.json.

    python -m benchmarks.lift_gradients [--designs 10]
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Mapping
from dataclasses import dataclass, replace

import msgspec
import numpy as np
from numpy.typing import NDArray

from benchmarks.inner_problem import HERE
from evodesign.evaluation.evaluate import Evaluator
from evodesign.evaluation.factory import evaluator_of
from evodesign.evaluation.gradients import assessed_gradients
from evodesign.evaluation.sensitivities import Sensitivities
from evodesign.motion.instant import KnotBlocks
from evodesign.motion.lift_program import LiftProgram
from evodesign.motion.solution import MotionCase
from evodesign.nlp.optimality import NotDifferentiable
from evodesign.posture.formulations.base import Setting
from evodesign.posture.symmetry import symmetric_forms
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.source import read_source
from evodesign.quantities.design_result import DesignResult
from evodesign.quantities.objectives import objective_value

PROBLEM = HERE.parent / "problems" / "icub_lift.toml"

ASKED = '"robot_torque", "human_torque"'
QUANTITIES = ("robot_torque", "human_torque", "robot_power", "l5s1_moment")
NAMES = (*QUANTITIES, *(f"worst_{name}" for name in QUANTITIES), "energy")

STEPS = (1e-4, 1e-5)
"""Of the differences, as shares of a parameter's range."""

SMALL = 1e-3
"""Gradient per range, relative to its objective or to its unit, below which errors are relative to this."""

CLEAR = 1e-5
"""Error that differences own to, relative to themselves, with which no other step is tried."""

TOLERANCE, RIGHT = 1e-12, 1e-4

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Compared:
    """One objective of one design, per range of each parameter.

    Args:
        value: of the objective.
        gradient: as a search gets it.
        differences: extrapolated.
        own_error: of the differences, as they say themselves.
    """

    value: float
    gradient: Array
    differences: Array
    own_error: Array

    @property
    def size(self) -> float:
        """What errors are relative to."""
        return max(float(np.abs(self.gradient).max()), SMALL * abs(self.value), SMALL)

    @property
    def error(self) -> float:
        """Largest difference, relative."""
        return float(np.abs(self.gradient - self.differences).max()) / self.size

    @property
    def doubt(self) -> float:
        """The largest error that the differences own to, relative."""
        return float(self.own_error.max()) / self.size

    @property
    def flat(self) -> bool:
        """Whether the objective does not move with the design."""
        return bool(np.abs(self.gradient).max() < self.size)


def main() -> None:
    """Compare, write and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--designs", type=int, default=10)
    wanted = parser.parse_args().designs
    source = read_source(PROBLEM)
    text = source.text.replace(ASKED, ", ".join(f'"{name}"' for name in NAMES))
    problem = build_problem(msgspec.structs.replace(source, text=text))
    evaluator, rng = evaluator_of(problem, 1), np.random.default_rng(11)
    found: list[dict[str, Compared]] = []
    absent: list[str] = []
    while len(found) + len(absent) < wanted:
        values = problem.space.values(tuple(rng.uniform(size=len(problem.space.parameters)).tolist()))
        compared = _compared(problem, evaluator, values)
        if isinstance(compared, NotDifferentiable):
            absent.append(compared.reason)
        elif compared:
            found.append(compared)
            print(*(f"{name} {each.error:.0e}" for name, each in compared.items()), flush=True)
    result = {"designs": wanted, "absent": absent, **{name: _summary(found, name) for name in NAMES}}
    (HERE / "results" / "lift_gradients.json").write_text(json.dumps(result, indent=2) + "\n")
    print(json.dumps(result, indent=2))


def _compared(
    problem: DesignProblem, evaluator: Evaluator, values: tuple[float, ...]
) -> dict[str, Compared] | NotDifferentiable:
    """Of a design; nothing where it has no lift."""
    result = evaluator.solve(values)
    (case,) = result.cases
    if not isinstance(case, MotionCase) or case.motion is None or not case.solved:
        return {}
    began = time.perf_counter()
    gradients = assessed_gradients(problem, Sensitivities(problem, inner=evaluator.inner), values, result)
    print(f"{case.motion.lift.knots} knots, gradients in {time.perf_counter() - began:.1f} s: ", end="")
    if gradients.absent:
        return NotDifferentiable("; ".join(sorted(set(gradients.absent.values()))))
    neighbours = _Neighbours(problem, result, case)
    found = [neighbours.differences(place) for place in range(len(values))]
    return {
        name: Compared(
            value=objective_value(name, result) or 0.0,
            gradient=np.array(list(gradients.values[name].values())),
            differences=np.array([each[name][0] for each in found]),
            own_error=np.array([each[name][1] for each in found]),
        )
        for name in NAMES
    }


class _Neighbours:
    """Motions of neighbours of a design, and their objectives."""

    def __init__(self, problem: DesignProblem, result: DesignResult, case: MotionCase) -> None:
        motion, setting = case.motion, Setting(problem.scene, problem.space, problem.weights, problem.options)
        assert motion is not None
        assert motion.start is not None
        assert motion.ending is not None
        self._result, self._case, self._lift = result, case, motion.lift
        options = replace(problem.options, tolerance=TOLERANCE, near=True)
        blocks = KnotBlocks(symmetric_forms(problem.scene), setting)
        self._program = LiftProgram(blocks, motion.lift.knots, options)
        self._start = replace(motion.start, symbols=motion.ending.symbols)
        self._ranges = [p.slope_at(x) for p, x in zip(problem.space.records, result.values, strict=True)]
        self._mass = problem.scene.payload.mass

    def _objectives(self, place: int, share: float) -> Mapping[str, float]:
        values = np.array(self._result.values)
        values[place] += share * self._ranges[place]
        ending, _ = self._program.solve(self._lift, self._start, values.tolist(), self._mass)
        course = self._program.course(self._lift, ending.symbols)
        instants = course.instants(self._case.case.task.result_times)  # type: ignore[union-attr]
        tree = self._result.space.resized(self._result.robot.tree, values.tolist())
        moved = replace(self._result, tree=tree, cases=(replace(self._case, instants=instants),))
        return {name: objective_value(name, moved) or 0.0 for name in NAMES}

    def differences(self, place: int) -> dict[str, tuple[float, float]]:
        """Along one parameter, per range: each objective's, and what error they own to."""
        best: dict[str, tuple[float, float]] = {}
        for step in STEPS:
            ends = {share: self._objectives(place, share * step) for share in (-1.0, -0.5, 0.5, 1.0)}
            for name in NAMES:
                far = (ends[1.0][name] - ends[-1.0][name]) / (2.0 * step)
                near = (ends[0.5][name] - ends[-0.5][name]) / step
                found = ((4.0 * near - far) / 3.0, abs(near - far))
                best[name] = min(best.get(name, found), found, key=lambda pair: pair[1])
            if all(doubt < CLEAR * max(abs(slope), SMALL) for slope, doubt in best.values()):
                break
        return best


def _summary(found: list[dict[str, Compared]], name: str) -> dict[str, object]:
    each = [compared[name] for compared in found]
    return {
        "largest_error": float(f"{max(one.error for one in each):.1e}"),
        "errors": [float(f"{one.error:.1e}") for one in each],
        "errors_of_differences": [float(f"{one.doubt:.1e}") for one in each],
        "does_not_move": sum(one.flat for one in each),
        "within_1e-4": sum(one.error < RIGHT for one in each),
    }


if __name__ == "__main__":
    main()
