"""The inner problems of a problem, built once: a reach per load, a posture per person and load."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from evodesign.motion.lifting import LiftProblem
from evodesign.nlp.solver import SolverCache
from evodesign.posture.formulations.base import Setting
from evodesign.posture.formulations.reach import ReachProblem
from evodesign.posture.postures import PostureProblem, Symmetry
from evodesign.posture.precompute.meetings import with_meetings
from evodesign.posture.precompute.precomputed import NOTHING_PRECOMPUTED, Precomputed
from evodesign.problem.build import DesignProblem

__all__ = ["InnerProblems", "inner_problems"]


@dataclass(frozen=True, slots=True)
class InnerProblems:
    """What is solved for every design.

    Args:
        postures: by names of person and load.
        reaches: by label of the load.
        lifts: by names of person and load.
    """

    postures: Mapping[tuple[str, str], PostureProblem]
    reaches: Mapping[str, ReachProblem]
    lifts: Mapping[tuple[str, str], LiftProblem]


def inner_problems(problem: DesignProblem, known: Precomputed = NOTHING_PRECOMPUTED) -> InnerProblems:
    """The inner problems of a problem, with what is known beforehand."""
    symmetric, solvers = problem.symmetry is not Symmetry.OFF, SolverCache()
    scenes = [with_meetings(scene, known.meetings) for scene in problem.scenes]
    settings = [Setting(scene, problem.space, problem.weights, problem.options) for scene in scenes]
    return InnerProblems(
        postures={
            setting.scene.pair: PostureProblem(setting, problem.symmetry, known, solvers)
            for setting in settings
        },
        reaches={
            setting.scene.payload.label: ReachProblem(
                setting, symmetric=symmetric, known=known, solvers=solvers
            )
            for setting in settings
        },
        lifts={setting.scene.pair: LiftProblem(setting, symmetric=symmetric) for setting in settings},
    )
