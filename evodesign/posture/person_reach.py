"""How low and how high a person can hold a load, whoever holds the other side.

The person's side of the reach problem: a person does not depend on the robot, so this is found once per
person and load, as the best of many starts. Together with a robot's reach it gives the heights at which robot
and everyone can hold the load.
"""

from __future__ import annotations

import casadi as ca

from evodesign.mechanics.scene import Scene
from evodesign.nlp.program import IpoptOptions, Solver
from evodesign.posture.formulations.reach import HIGHEST, LOWEST, reach_program
from evodesign.posture.precompute.precomputed import PersonReach
from evodesign.posture.starts import person_starts
from evodesign.posture.symmetry import symmetric_forms, whole
from evodesign.records import Status

__all__ = ["person_reach"]

HEIGHTS = (1.0, 0.6)
"""Where the load is in the starts [m]."""


def person_reach(scene: Scene, options: IpoptOptions, *, symmetric: bool) -> PersonReach | None:
    """The interval of a scene's person; None when no posture was found."""
    form = symmetric_forms(scene)[1] if symmetric else whole(scene.human)
    solver = Solver(reach_program(form, form.agent.tree, scene, ca.SX.zeros(0)), options)
    ends: dict[float, float] = {}
    for sense in (LOWEST, HIGHEST):
        solves = [
            solver.solve([scene.payload.mass, sense], {**start, "height": [height]})
            for height in HEIGHTS
            for start in person_starts(solver)
        ]
        heights = [float(raw.values["height"][0]) for raw in solves if raw.status is Status.SOLVED]
        if not heights:
            return None
        ends[sense] = min(heights) if sense == LOWEST else max(heights)
    return PersonReach(ends[LOWEST], ends[HIGHEST])
