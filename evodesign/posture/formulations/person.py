"""How a person alone holds a load: the posture under a given force between the hands.

    minimise    w_h |tau_h|^2 + regularisation
    subject to  every term of the person and the load, and the internal force X

The other agent is a pair of free hands. With point grasps and a symmetric scene the load's balance leaves one
number between the two: the internal force X.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import Any

import casadi as ca

from evodesign.mechanics.agent import HUMAN, ROBOT
from evodesign.mechanics.scene import Scene
from evodesign.nlp.method import SolverOptions
from evodesign.nlp.program import Array, ConstraintBlock, Program
from evodesign.nlp.solver import RawSolution, Solver, SolverCache
from evodesign.posture.assemble import CaseSymbols, Embodied, Party, assemble, free_hands_beside, total
from evodesign.posture.check import TOLERANCE, AgentModel, near_bodies
from evodesign.posture.formulations.base import program_key
from evodesign.posture.parting import parted
from evodesign.posture.seeking.measured_starts import measured_starts
from evodesign.posture.seeking.seeker import Seeker
from evodesign.posture.seeking.starts import person_starts
from evodesign.posture.symmetry import Form
from evodesign.posture.terms.load import any_load, push_on_load
from evodesign.posture.terms.measured_posture import any_person, person_parameters
from evodesign.posture.terms.registry import TERMS
from evodesign.posture.warm_start import instants_of, layout_of
from evodesign.records import Status

PUSH_UNIT = 10.0  # [N] per unit of the row that fixes the push


class PersonProblem:
    """The person's posture program, for the scene's load at any height and under any push.

    Args:
        form: of the person.
        scene: with the load.
        weight: of the person's effort.
        options: of the solver.
        solvers: of other scenes.
    """

    def __init__(
        self, form: Form, scene: Scene, weight: float, options: SolverOptions, solvers: SolverCache
    ) -> None:
        self._form, self._scene = form, scene
        key = program_key("person", scene, form, weight)
        self.solver: Solver = solvers.solver(key, lambda: person_program(form, scene, weight), options)

    @property
    def program(self) -> Program:
        """What is solved."""
        return self.solver.program

    def parameters(self, height: float, push: float) -> Mapping[str, Any]:
        """The program's, for a height [m] and a push [N]."""
        given = {"height": height, "mass": self._scene.payload.mass, "internal_force": push}
        return {**given, **person_parameters(self._scene)}

    def solve(self, height: float, push: float, start: Mapping[str, Array]) -> RawSolution:
        """The person's posture at a height [m] under a push [N], from one start."""
        parameters = self.parameters(height, push)
        return Seeker(self.solver).settled(parameters, self.solver.solve(parameters, start))

    def best_of_many(self, height: float, push: float) -> RawSolution | None:
        """The person's posture at a height [m] under a push [N], from many starts, always the same.

        A measured posture has few optima, near its mean: three starts do. None where every posture has bodies
        in each other, or none is found.
        """
        measured = measured_starts(self.program, self._form, self._scene, (height,))
        ends = [self.solve(height, push, each) for each in measured or person_starts(self.program)]
        solved = sorted((end for end in ends if end.status is Status.SOLVED), key=lambda end: end.cost)
        return next((end for end in solved if self._keeps_clear(height, end)), None)

    def _keeps_clear(self, height: float, raw: RawSolution) -> bool:
        layout = layout_of(self.program, HUMAN)
        (instant,) = instants_of(layout, (self._form,), self._scene.undisturbed, raw.values)
        near = near_bodies((self._person,), instant.postures, self._scene.payload.size, height)
        return all(gap.distance >= -TOLERANCE for gap in near)

    @cached_property
    def _person(self) -> AgentModel:
        return AgentModel.of(self._form.agent, self._form.agent.tree)


def person_program(form: Form, scene: Scene, weight: float, *, switched: bool = False) -> Program:
    """The person's program; its parameters are the load's height and mass, the internal force, and who."""
    given_scene = scene
    scene, mass = any_load(scene)
    scene, person = any_person(scene)
    height, internal = ca.SX.sym("height"), ca.SX.sym("internal_force")
    parties: list[Party] = [Embodied(form, form.agent.tree), *free_hands_beside(form, scene)]
    assembly = assemble(parties, TERMS.values(), CaseSymbols(scene, (height,)), switched=switched)
    load_case = assembly.undisturbed
    given = (push_on_load(load_case.hands[ROBOT]) - internal) / PUSH_UNIT
    return Program(
        name="person",
        variables=assembly.variables,
        constraints=(*assembly.constraints, ConstraintBlock("load.given_internal_force", given, 0.0, 0.0)),
        cost=total([load_case.effort({HUMAN: weight}), *load_case.regularisation]),
        parameters={
            "height": height,
            "mass": mass,
            "internal_force": internal,
            **person,
            **assembly.given,
        },
        switches=parted(assembly.parted, lambda: person_program(form, given_scene, weight, switched=True)),
    )
