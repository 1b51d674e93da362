"""Solvers that are built once, however many scenes need them.

The load's mass is a number that every program is given, and a robot's program knows of the person only what
the load passes on. So scenes that differ in the mass of their load alone share all programs, and scenes that
differ in the person share the robot's.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from evodesign.mechanics.scene import Agent, Scene
from evodesign.nlp.program import IpoptOptions, Program, Solver

__all__ = ["SolverCache", "program_key"]


class SolverCache:
    """Solvers by what their programs follow from."""

    def __init__(self) -> None:
        self._solvers: dict[tuple[str, ...], Solver] = {}

    def solver(self, key: tuple[str, ...], program: Callable[[], Program], options: IpoptOptions) -> Solver:
        """The solver of a program, built when it is first asked for.

        Args:
            key: of everything that distinguishes the program from others on this shelf.
            program: builds it.
            options: of the solver.
        """
        whole_key = (*key, repr(options))
        if whole_key not in self._solvers:
            self._solvers[whole_key] = Solver(program(), options)
        return self._solvers[whole_key]


def program_key(scene: Scene, *agents: Agent) -> str:
    """What the programs of a scene's agents follow from, beside the agents; the load's mass is none of it.

    Args:
        scene: load, ground and stance.
        agents: those with a body in the program; the same object is the same agent.
    """
    load = replace(scene.payload, mass=0.0, label="")
    limits = (scene.ground, scene.stance, scene.robot_share, scene.disturbances)
    return repr((load, *limits, *(id(agent) for agent in agents)))
