"""What formulations of the posture problem have in common.

A formulation says which agents have a body in which program, and what is a variable: robot and person
together (`joint`), one after the other (`decoupled`), the load's height (`reach`), the design (`codesign`).
All are assembled from the same terms.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from evodesign.design.space import DesignSpace
from evodesign.human.measured_posture import MeasuredPosture
from evodesign.identity import Exceptions, digest
from evodesign.mechanics.scene import Agent, Payload, Scene
from evodesign.nlp.landscape import Landscape
from evodesign.nlp.method import SolverOptions
from evodesign.nlp.optimality import NotDifferentiable
from evodesign.nlp.program import Start
from evodesign.nlp.solver import RawSolution
from evodesign.posture.allocation import EffortWeights
from evodesign.posture.candidate import Trial
from evodesign.posture.check import Checker
from evodesign.posture.results import CaseSolution, Neighbour
from evodesign.posture.solution_derivative import PostureDerivative
from evodesign.records import ActiveLimit, Task


@dataclass(frozen=True, slots=True)
class Setting:
    """What the programs of a scene follow from.

    Args:
        scene: agents, load, ground and stance.
        space: design parameters.
        weights: of the agents' efforts.
        options: of the solver.
        lowest_asked: height of the load [m] below which nobody asks whether it can be held.
    """

    scene: Scene
    space: DesignSpace
    weights: EffortWeights
    options: SolverOptions
    lowest_asked: float = 0.0


NO_PART_OF_PROGRAMS: Exceptions = {
    Setting: {
        "options": "say how a program is solved",
        "lowest_asked": "is a parameter of the reach program",
    },
    Scene: {"human": "only hands stand in for a person who has no body in the program"},
    Payload: {"mass": "is a parameter of every program", "label": "is a word for results"},
    Agent: {"label": "is a word for results"},
    MeasuredPosture: {"drawn": "is a parameter of every program with the person's body"},
}


class Formulation(Protocol):
    """A way of finding the postures of a design for a task; programs are built when they are needed.

    Attributes:
        name: by which attempts and solutions refer to it.
    """

    name: str

    def solve(
        self, design: Sequence[float], task: Task, portfolio: Sequence[Start], checker: Checker
    ) -> Trial:
        """What the starts of a portfolio lead to, or fixed starts if there are none that fit."""

    def sketched(self, design: Sequence[float], task: Task, portfolio: Sequence[Start]) -> Trial:
        """What one start leads to about, not checked."""

    def solve_beside(
        self,
        design: Sequence[float],
        task: Task,
        portfolio: Sequence[Start],
        neighbour: Neighbour,
        checker: Checker,
    ) -> Trial:
        """What the solution in a similar scene leads to, and the first starts of a portfolio."""

    def followed(
        self, design: Sequence[float], solution: CaseSolution, raw: RawSolution
    ) -> CaseSolution | None:
        """The robot's postures of another design near those of a solution, not checked; a person may stay."""

    def finished(self, design: Sequence[float], task: Task, raw: RawSolution, checker: Checker) -> Trial:
        """A solve for this design that was not checked, checked."""

    def landscape(self, task: Task) -> Landscape:
        """The cost, of which a portfolio of starts is made."""

    def derivative(
        self, design: Sequence[float], solution: CaseSolution, *, exact: bool = True
    ) -> PostureDerivative | NotDifferentiable:
        """How a solution that this formulation found moves with the design (`SolutionSensitivity.at`)."""

    def active_limits(self, design: Sequence[float], solution: CaseSolution) -> tuple[ActiveLimit, ...]:
        """Which limits hold a solution that this formulation found, and what they cost."""


def program_key(formulation: str, *parts: object) -> str:
    """Digest of what a program follows from: all of it but the named exceptions.

    Args:
        formulation: its name.
        parts: setting or scene, and the forms of agents with a body, who count with all that they are.
    """
    return digest((formulation, *parts), without=NO_PART_OF_PROGRAMS)
