"""Do people who stand as measured people do hold loads at every height, and how do they stand?

A woman of 1.52 m and 55 kg and a man of 1.88 m and 90 kg hold a load of 10 or 15 kg together with robots of
long limbs (lengths drawn uniformly: limbs 1.2 to 1.8, trunk 1.0 to 1.3 times the iCub's), every 0.1 m from
0.3 to 1.4 m, in point and in rigid grasps, with bodies that are kept apart and with free ones. Nothing else
is asked of the robot. Told are the holds within the robot's reach: how many were found and passed the check,
and of those that were not, what 25 random starts of IPOPT on the same program say. Of the people, in degrees:
how far the trunk (from the hip joints to the shoulders) leans back at most, how far one lumbar joint bends
against another one, and how far from where the head points the load is. A row of
benchmarks/results/measured_people.json is replaced for each combination that is run.

    python -m benchmarks.measured_people [--grasps point rigid] [--masses 10 15] [--bodies apart free]
        [--designs 3] [--starts 25] [--jobs 2]
"""

from __future__ import annotations

import argparse
import json
import math
import time
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import msgspec
import numpy as np
import tomli_w

from benchmarks.inner_problem import HERE, Design, processors
from evodesign.body.placement import Placement
from evodesign.evaluation.factory import evaluator_of
from evodesign.mechanics.agent import HUMAN
from evodesign.nlp.method import MethodName
from evodesign.posture.design_checkers import DesignCheckers
from evodesign.posture.formulations.base import Setting
from evodesign.posture.postures import PostureProblem
from evodesign.posture.precompute.meetings import with_meetings
from evodesign.posture.precompute.precomputed import Precomputed
from evodesign.posture.results import AgentPosture, Array, CaseSolution
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.person_posture import HEAD
from evodesign.problem.source import read_source
from evodesign.quantities.design_result import DesignResult
from evodesign.records import Status
from evodesign.tree.frames import link_frames
from evodesign.tree.model import Tree

PROBLEM = "icub-lifting"
RESULTS = HERE / "results" / "measured_people.json"
PEOPLE = (
    {"name": "woman", "stature_m": 1.52, "mass_kg": 55.0, "sex": "female"},
    {"name": "man", "stature_m": 1.88, "mass_kg": 90.0, "sex": "male"},
)
HEIGHTS = tuple(round(0.3 + 0.1 * place, 1) for place in range(12))
LIMBS, TRUNK = (1.2, 1.8), (1.0, 1.3)
OF_TRUNK = frozenset({"length.torso_1", "length.torso_2", "length.chest"})
LEFT_OUT = ("disturbance", "constraints", "load_case", "hardware")
LUMBAR = ("jL5S1_roty", "jL4L3_roty", "jL1T12_roty")


@dataclass(frozen=True)
class Held:
    """How a person stands in one hold; angles [degrees].

    Args:
        leans: of the trunk, forward.
        against: the smaller flexion of two lumbar joints that bend opposite ways; 0 where none do.
        gaze: between where the head points and the load.
    """

    leans: float
    against: float
    gaze: float


def problem_of(grasp: str, mass: float, bodies: str) -> DesignProblem:
    """The default problem's robot beside these people."""
    source = read_source(PROBLEM)
    tables: dict[str, Any] = tomllib.loads(source.text)
    for name in (*LEFT_OUT, *(() if bodies == "apart" else ("collisions",))):
        tables.pop(name, None)
    tables |= {
        "human": list(PEOPLE),
        "payload": {"size_m": tables["payload"]["size_m"], "mass_kg": mass, "grasp": grasp},
        "task": {"heights_m": list(HEIGHTS)},
        "design": {"length": tables["design"]["length"]},
        "objectives": {"minimise": ["robot_torque", "human_torque"]},
        "search": {"algorithm": "nsga2", "evaluations": 10},
    }
    return build_problem(msgspec.structs.replace(source, text=tomli_w.dumps(tables)))


def long_limbed(problem: DesignProblem) -> Iterator[Design]:
    """Designs of long limbs, the same ones every time."""
    rng = np.random.default_rng(3)
    bounds = np.array([TRUNK if each.name in OF_TRUNK else LIMBS for each in problem.space.parameters])
    while True:
        yield tuple(rng.uniform(*bounds.T).tolist())


def standing(tree: Tree, posture: AgentPosture, height: float) -> Held:
    """How a person stands whose load's centre is at a height [m]."""
    root = Placement.from_xyz_rpy(posture.base_position.tolist(), posture.base_angles.tolist())
    placed = link_frames(tree, root, posture.joints)

    def middle(part: str) -> Array:
        left, right = (np.array(placed[f"{side}{part}"].translation, float) for side in ("Left", "Right"))
        return np.asarray((left + right) / 2.0)

    spine = middle("UpperArm") - middle("UpperLeg")
    head, bends = placed[HEAD], [math.degrees(posture.joints[joint]) for joint in LUMBAR]
    away = np.array([0.0, 0.0, height]) - np.array(head.apply(tree.link_by_name[HEAD].inertia.center))
    ahead: Array = np.array(head.rotation, float)[:, 0]
    return Held(
        math.degrees(math.atan2(spine[0], spine[2])),
        max(0.0, min(max(bends), -min(bends))),
        math.degrees(math.acos(ahead @ away / np.linalg.norm(away))),
    )


class Judge:
    """Asks IPOPT whether a hold that was not found exists.

    Args:
        problem: of the holds.
        known: of it.
        starts: random ones of each hold.
    """

    def __init__(self, problem: DesignProblem, known: Precomputed, starts: int) -> None:
        options = replace(problem.options, method=MethodName.IPOPT, compiled=False)
        self._starts = starts
        scenes = [with_meetings(scene, known.meetings) for scene in problem.scenes]
        self._checkers = {each.pair: DesignCheckers(each, problem.space) for each in scenes}
        self._postures = {
            each.pair: PostureProblem(
                Setting(each, problem.space, problem.weights, options), problem.symmetry, Precomputed()
            )
            for each in scenes
        }

    def found(self, design: Design, solution: CaseSolution) -> int:
        """From how many starts a hold is found that passes the check."""
        pair, rng = solution.case.pair, np.random.default_rng(0)
        landscape = self._postures[pair].landscape(solution.case.task, self._checkers[pair].of)
        ends = (landscape.solve(design, landscape.free_start(rng)) for _ in range(self._starts))
        return sum(end.status is Status.SOLVED for end in ends)


def combination(
    grasp: str, mass: float, bodies: str, designs: int, starts: int, jobs: int
) -> Mapping[str, Any]:
    """One row of the table."""
    problem = problem_of(grasp, mass, bodies)
    evaluator = evaluator_of(problem, jobs)
    began, asked, held, misses, used = time.process_time(), 0, [], [], 0
    judge = Judge(problem, evaluator.known, starts)
    for design in long_limbed(problem):
        if used == designs:
            break
        result = evaluator.solve(design)
        if result.reach.highest is None or result.reach.lowest is None:
            continue
        used += 1
        for solution in result.cases:
            if result.reach.distance(solution.case.task.heights[0]) != 0.0:
                continue
            asked += 1
            if solution.solved:
                held.append(_held(result, solution))
            else:
                misses.append(_missed(used, solution, judge.found(design, solution)))
    return {
        "designs": used,
        "asked": asked,
        "held": len(held),
        "leans_back_deg": round(max(0.0, -min(each.leans for each in held)), 1),
        "lumbar_against_deg": round(max(each.against for each in held), 2),
        "gaze_deg": round(max(each.gaze for each in held), 1),
        "processor_seconds": round(time.process_time() - began, 1),
        "misses": misses,
    }


def _held(result: DesignResult, solution: CaseSolution) -> Held:
    tree = result.scene_of(solution.case).human.tree
    return standing(tree, solution.postures[HUMAN], solution.case.task.heights[0])


def _missed(design: int, solution: CaseSolution, found: int) -> Mapping[str, Any]:
    case = solution.case
    return {
        "design": design,
        "person": case.person,
        "height_m": case.task.heights[0],
        "status": str(solution.status),
        "reason": solution.reason,
        "found_by_ipopt": found,
    }


def main() -> None:
    """Run the combinations that were asked for, one after the other; write and print each."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--grasps", nargs="+", default=["point", "rigid"])
    parser.add_argument("--masses", nargs="+", type=float, default=[10.0, 15.0])
    parser.add_argument("--bodies", nargs="+", default=["free", "apart"])
    parser.add_argument("--designs", type=int, default=3)
    parser.add_argument("--starts", type=int, default=25)
    parser.add_argument("--jobs", type=int, default=processors())
    options = parser.parse_args()
    for bodies, grasp, mass in product(options.bodies, options.grasps, options.masses):
        row = combination(grasp, mass, bodies, options.designs, options.starts, options.jobs)
        rows = json.loads(RESULTS.read_text()) if RESULTS.exists() else {}
        name = f"{grasp}, {mass:g} kg, bodies {bodies}"
        RESULTS.write_text(json.dumps({**rows, name: row}, indent=2) + "\n")
        print(name, json.dumps(row, indent=2), flush=True)


if __name__ == "__main__":
    main()
