"""The published setting of the paper: solved, compared with its torque formula, and its broken limits.

Source: Sartore et al. 2022, Eq. 12 and 14.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from evodesign.mechanics.coupled import PAYLOAD, CoupledModel, level_load
from evodesign.mechanics.floating_base import Configuration
from evodesign.mechanics.projected import projected_torques
from evodesign.posture.check import TOLERANCE
from evodesign.posture.formulations.codesign import JointSolution
from evodesign.problem.baseline import Baseline
from evodesign.problem.build import Problem
from evodesign.records import Genome

__all__ = ["broken_limits", "held_at", "torque_difference"]


def held_at(problem: Problem, genome: Genome, heights: Sequence[float]) -> JointSolution:
    """The joint problem with the design held at a genome, over some heights [m], from the standard start."""
    return Baseline(replace(problem, heights=tuple(heights), joint_start=(genome,)), fixed=genome).solve(
        genome
    )


def torque_difference(problem: Problem, solution: JointSolution) -> float:
    """Largest difference of a solution's torques from the paper's formula at its postures [N m]."""
    tree = problem.space.resized(problem.scene.robot.tree, solution.design)
    model = CoupledModel(problem.scene, tree)
    worst = 0.0
    for height in solution.heights:
        places = {
            n: Configuration(p.base_position, p.base_angles, p.joints) for n, p in height.postures.items()
        }
        system = model.at({**places, PAYLOAD: level_load(height.height)})
        torques = [height.postures[agent].torques[joint] for agent, joint in system.joints]
        worst = max(worst, float(np.abs(projected_torques(system) - torques).max()))
    return worst


def broken_limits(solutions: Sequence[JointSolution]) -> str:
    """In words, the limits that the check found broken; empty for none."""
    found: dict[tuple[str, str], float] = {}
    for residual in (r for solution in solutions for of in solution.violations for r in of):
        kind = (residual.words, residual.unit)
        found[kind] = max(found.get(kind, 0.0), residual.size)
    return ", ".join(
        f"{words} by up to {size:.2g} {unit}" for (words, unit), size in found.items() if size > TOLERANCE
    )
