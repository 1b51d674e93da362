"""How low and how high a person can hold a load, whoever holds the other side.

The person's side of the reach problem: a person does not depend on the robot, so this is found once per
person and load, as the best of many starts. Together with a robot's reach it gives the heights at which robot
and everyone can hold the load.
"""

from __future__ import annotations

from evodesign.mechanics.scene import Scene
from evodesign.nlp.solver import IpoptOptions, Solver
from evodesign.posture.formulations.reach import HEIGHT, HIGHEST, LOWEST, reach_program
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
    solver = Solver(reach_program(form, form.agent.tree, scene, {}), options)
    ends: dict[float, float] = {}
    for sense in (LOWEST, HIGHEST):
        solves = [
            solver.solve({"mass": scene.payload.mass, "sense": sense}, {**start, HEIGHT: [height]})
            for height in HEIGHTS
            for start in person_starts(solver.program)
        ]
        heights = [float(raw.values[HEIGHT][0]) for raw in solves if raw.status is Status.SOLVED]
        if not heights:
            return None
        ends[sense] = min(heights) if sense == LOWEST else max(heights)
    return PersonReach(ends[LOWEST], ends[HIGHEST])
