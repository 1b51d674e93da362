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
from evodesign.quantities.motion_quantities import LEAST_TIME


@dataclass(frozen=True, slots=True)
class InnerProblems:
    """What is solved for every design.

    Args:
        postures: by names of person and load.
        reaches: by label of the load and name of the robot; of people who hold it without robots also by what
            they are called together.
        lifts: by names of person and load.
    """

    postures: Mapping[tuple[str, str], PostureProblem]
    reaches: Mapping[tuple[str, str, str], ReachProblem]
    lifts: Mapping[tuple[str, str], LiftProblem]


def inner_problems(
    problem: DesignProblem, known: Precomputed = NOTHING_PRECOMPUTED, solvers: SolverCache | None = None
) -> InnerProblems:
    """The inner problems of a problem, with what is known beforehand, and solvers of others like it."""
    symmetric, solvers = problem.symmetry is not Symmetry.OFF, solvers or SolverCache()
    names = [*(each.name for each in problem.objectives), *(each.name for each in problem.constraints)]
    timed = any(name.endswith(LEAST_TIME) for name in names)
    scenes = [with_meetings(scene, known.meetings) for scene in problem.scenes]
    settings = [
        Setting(scene, problem.space, problem.weights, problem.options, problem.lowest_asked)
        for scene in scenes
    ]
    return InnerProblems(
        postures={
            setting.scene.pair: PostureProblem(setting, problem.symmetry, known, solvers)
            for setting in settings
        },
        reaches={
            (scene.payload.label, agent.name, "" if scene.robots else scene.pair[0]): ReachProblem(
                setting, agent.name, symmetric=symmetric, known=known, solvers=solvers
            )
            for scene, setting in zip(scenes, settings, strict=True)
            for agent in scene.robots or scene.people
        },
        lifts={
            setting.scene.pair: LiftProblem(setting, symmetric=symmetric, timed=timed) for setting in settings
        },
    )
