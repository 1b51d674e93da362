"""What formulations of the posture problem have in common.

A formulation says which agents have a body in which program, and what is a variable: robot and person
together (`joint`), a person alone (`person`), the load's height (`reach`), the design (`codesign`). All are
assembled from the same terms.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from evodesign.body.placement import Scalar
from evodesign.design.space import DesignSpace
from evodesign.human.measured_posture import MeasuredPosture
from evodesign.identity import Exceptions, digest
from evodesign.mechanics.agent import Agent
from evodesign.mechanics.payload import Payload
from evodesign.mechanics.scene import Scene
from evodesign.nlp.method import SolverOptions
from evodesign.posture.allocation import EffortWeights
from evodesign.posture.assemble import Embodied
from evodesign.posture.symmetry import Form


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


def embodied(forms: Iterable[Form], space: DesignSpace, values: Sequence[Scalar]) -> tuple[Embodied, ...]:
    """Agents with their bodies, those that designs change with the hardware of one.

    Args:
        forms: of the agents.
        space: design parameters.
        values: one number or expression per parameter.
    """
    return tuple(
        Embodied(form, space.resized(tree, values) if form.agent.designed else tree)
        for form, tree in ((form, form.agent.tree) for form in forms)
    )


NO_PART_OF_PROGRAMS: Exceptions = {
    Setting: {
        "options": "say how a program is solved",
        "lowest_asked": "is a parameter of the reach program",
    },
    Scene: {"agents": "with a body they count by their forms; of the others, where they stand"},
    Payload: {"mass": "is a parameter of every program", "label": "is a word for results"},
    Agent: {"label": "is a word for results"},
    MeasuredPosture: {"drawn": "is a parameter of every program with the person's body"},
}


def program_key(formulation: str, scene: Scene, *parts: object) -> str:
    """Digest of what a program follows from: all of it but the named exceptions.

    Args:
        formulation: its name.
        scene: in which all agents hold the load.
        parts: the setting, and the forms of agents with a body, who count with all that they are.
    """
    places = tuple((agent.name, agent.role, agent.quarters) for agent in scene.agents)
    return digest((formulation, places, scene, *parts), without=NO_PART_OF_PROGRAMS)
