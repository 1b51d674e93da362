"""The published setting of the paper: solved, held against its torque formula, and its broken limits.

Source: Sartore et al. 2022, Eq. 12 and 14.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from evodesign.mechanics.coupled import PAYLOAD, CoupledModel, level_load
from evodesign.mechanics.floating_base import Configuration
from evodesign.mechanics.projected import projected_torques
from evodesign.posture.check import TOLERANCE
from evodesign.posture.formulations.codesign import JointSolution
from evodesign.problem.baseline import Baseline
from evodesign.problem.build import Problem
from evodesign.records import Genome, Task

__all__ = ["broken_limits", "held_at", "torque_difference"]


def held_at(problem: Problem, genome: Genome, tasks: Sequence[Task]) -> JointSolution:
    """The joint problem with the design held at a genome, over some tasks, from the standard start."""
    return Baseline(replace(problem, tasks=tuple(tasks), joint_start=(genome,)), fixed=genome).solve(genome)


def torque_difference(problem: Problem, solution: JointSolution) -> float:
    """Largest difference of a solution's torques from the paper's formula at its postures [N m]."""
    tree = problem.space.resized(problem.scene.robot.tree, solution.design)
    model = CoupledModel(problem.scene, tree)
    worst = 0.0
    for case in solution.cases:
        places = {
            n: Configuration(p.base_position, p.base_angles, p.joints) for n, p in case.postures.items()
        }
        system = model.at({**places, PAYLOAD: level_load(case.case.task.height_m)})
        torques = [case.postures[agent].torques[joint] for agent, joint in system.joints]
        worst = max(worst, float(np.abs(projected_torques(system) - torques).max()))
    return worst


@dataclass(frozen=True, slots=True)
class _Kind:
    """A kind of limit: how its residuals' names end, and how to say it."""

    ending: str
    words: str


_KINDS = (
    _Kind(".joint_limits", "joint limits by up to {:.2g} rad"),
    _Kind(".foot_contact", "the contact of a foot with the ground by up to {:.2g} N"),
    _Kind(".trunk_clear", "the trunk's distance from the load by up to {:.2g} m"),
    _Kind(".feet_apart", "the feet's distance by up to {:.2g} m"),
)


def broken_limits(solutions: Sequence[JointSolution]) -> str:
    """In words, the limits that the check found broken; empty for none."""
    found: Mapping[str, float] = {}
    every = [of.items() for solution in solutions for of in solution.violations]
    found = {
        kind.words: max(
            (x for items in every for name, x in items if name.endswith(kind.ending)), default=0.0
        )
        for kind in _KINDS
    }
    return ", ".join(words.format(size) for words, size in found.items() if size > TOLERANCE)
