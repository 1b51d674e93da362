"""Robot torque against human torque over an allocation parameter, with rigid grasps and the unscaled robot.

For each height and value of the parameter the best of many starts of the symmetric program, among them the
optimum at the value before; every posture passes the independent check. Torque norms are printed in N m.

    python -m benchmarks.sharing [--allocation effort_ratio] [--moment 7] [--mass 10] [--starts 8]
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from benchmarks.inner_problem import problem_at
from evodesign.design.parameter import ALLOCATIONS, EFFORT_RATIO, ROBOT_SHARE, DesignParameter, ParameterKind
from evodesign.design.space import DesignSpace
from evodesign.mechanics.agent import HUMAN, ROBOT
from evodesign.mechanics.balance import GRAVITY
from evodesign.mechanics.payload import Grasp
from evodesign.posture.allocation import EffortWeights, shared_scene
from evodesign.posture.check import TOLERANCE, AgentModel, Checker, sizes
from evodesign.posture.formulations.base import Setting
from evodesign.posture.postures import PostureProblem, Symmetry
from evodesign.posture.symmetry import symmetric_forms
from evodesign.posture.warm_start import instants_of, layout_of
from evodesign.problem.build import DesignProblem
from evodesign.records import Hold, Status

HEIGHTS = (0.4, 0.6, 0.8, 1.0, 1.2, 1.3)
VALUES = {
    ROBOT_SHARE: (0.0, 0.1, 0.25, 0.4, 0.5, 0.6, 0.75, 0.9, 1.0),
    EFFORT_RATIO: (-4.0, -2.0, -1.0, 0.0, 1.0, 2.0, 4.0),
}

Point = tuple[float, float, float]
"""Robot torque, human torque [N m] and the robot's share of the load [-]."""


def sweep(problem: DesignProblem, allocation: str, height: float, starts: int) -> Iterator[Point | None]:
    """A point for each value of an allocation parameter; None where nothing was found."""
    scene = problem.scene
    bounds = ALLOCATIONS[allocation]
    parameter = DesignParameter(ParameterKind.ALLOCATION, allocation, (), bounds.lowest, bounds.highest)
    space = DesignSpace((parameter,))
    postures = PostureProblem(Setting(scene, space, EffortWeights(), problem.options), Symmetry.ON)
    landscape, rng = postures.landscape(Hold(height_m=height)), np.random.default_rng(1)
    tried = [*landscape.starts, *(landscape.free_start(rng) for _ in range(starts))]
    person = AgentModel.of(scene.human, scene.human.tree)
    for value in VALUES[allocation]:
        ends = [landscape.solve((value,), start) for start in tried]
        solved = [end for end in ends if end.status is Status.SOLVED]
        if not solved:
            yield None
            continue
        best = min(solved, key=lambda end: end.cost)
        tried.append(best.values)
        layout = layout_of(landscape.seeker.program)
        instant = instants_of(layout, symmetric_forms(scene), scene, best.values)[0]
        found = instant.postures
        checker = Checker(
            shared_scene(scene, space, (value,)), AgentModel.of(scene.robot, scene.robot.tree), person
        )
        if max(sizes(checker.residuals(instant, height)).values()) > TOLERANCE:
            raise AssertionError(f"the check refuses {allocation} {value:g} at {height:g} m")
        carried = -sum(found[ROBOT].wrenches[hand.name][2] for hand in scene.robot.hands)
        share = carried / (GRAVITY * scene.payload.mass)
        yield found[ROBOT].torque_norm, found[HUMAN].torque_norm, float(share)


def main() -> None:
    """Sweep and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--allocation", default=EFFORT_RATIO, choices=list(VALUES))
    parser.add_argument("--moment", type=float, default=math.inf, help="that a hand can transmit [N m]")
    parser.add_argument("--mass", type=float, default=10.0, help="of the load [kg]")
    parser.add_argument("--starts", type=int, default=8)
    asked = parser.parse_args()
    problem = problem_at(HEIGHTS)
    load = replace(problem.scene.payload, mass=asked.mass, grasp=Grasp.RIGID, hand_moment=asked.moment)
    problem = replace(problem, scenes=(replace(problem.scene, payload=load),))
    rows = {height: list(sweep(problem, asked.allocation, height, asked.starts)) for height in HEIGHTS}
    print(
        f"{asked.allocation}: robot / human torque [N m] (the robot's share); {asked.moment:g} N m per hand"
    )
    for position, value in enumerate(VALUES[asked.allocation]):
        points = [rows[height][position] for height in HEIGHTS]
        cells = ["-" if p is None else f"{p[0]:.1f} / {p[1]:.1f} ({p[2]:.2f})" for p in points]
        mean = np.mean([p for p in points if p is not None], axis=0)
        print(f"{value:6g} | mean {mean[0]:.1f} / {mean[1]:.1f} | " + " | ".join(cells), flush=True)


if __name__ == "__main__":
    main()
