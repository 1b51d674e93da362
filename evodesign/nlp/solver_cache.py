"""Solvers that are built once, however many scenes need them.

The load's mass is a number that every program is given, and a robot's program knows of the person only what
the load passes on. So scenes that differ in the mass of their load alone share all programs, and scenes that
differ in the person share the robot's.
"""

from __future__ import annotations

from collections.abc import Callable

from evodesign.identity import Exceptions, digest
from evodesign.mechanics.scene import Agent, Payload, Scene
from evodesign.nlp.program import IpoptOptions, Program, Solver

__all__ = ["SolverCache", "program_key"]

NO_PART_OF_PROGRAMS: Exceptions = {
    Scene: {"human": "only hands stand in for a person who has no body in the program"},
    Payload: {"mass": "is a parameter of every program", "label": "is a word for results"},
    Agent: {"label": "is a word for results"},
}


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
    """Digest of what the programs of a scene's agents follow from: all of it but the named exceptions.

    Args:
        scene: robot, load, ground and stance.
        agents: those with a body in the program; the robot counts in any case.
    """
    others = tuple(agent for agent in agents if agent is not scene.robot)
    return digest((scene, others), without=NO_PART_OF_PROGRAMS)
