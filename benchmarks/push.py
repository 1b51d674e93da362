"""Push margins of the designs of a run: time, half the step, other conditions, rankings, and who solves.

For the first feasible designs of a run the least push margin of the first hold is found, again with half the
step of the integration and with half of all steps, and under other friction, load mass and sensor delay.
Kendall's tau is that between all that the log of a run says of its first feasible designs, torques and
margins among them, and torques of a lift from the lowest to the highest hold. The quadratic programs that
come up after a push are solved by each library that is installed (`pip install quadprog piqp`).

    python -m benchmarks.push RUN [--designs 10] [--half] [--others] [--rankings 60 [--lifts]] [--solvers]
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from importlib.util import find_spec
from itertools import combinations
from pathlib import Path

import numpy as np
import scipy
from numpy.typing import NDArray

import evodesign.control.controller as controller
from evodesign.control.quadratic import QuadraticSolution, least_squares
from evodesign.evaluation.factory import evaluator_of
from evodesign.evaluation.lifts import Lifts
from evodesign.evaluation.progress import SILENT
from evodesign.evaluation.pushes import PERTURBED, pushed_holds
from evodesign.mechanics.agent import ROBOT
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.report.opened_design import open_design
from evodesign.runlog.run import read_run
from evodesign.simulation.controlled import Timing
from evodesign.simulation.push import Push
from evodesign.simulation.push_margin import Margin, least_margin
from evodesign.simulation.pushed_plan import PushConditions, PushedDesign
from evodesign.tasks import Lift

LIFT_SECONDS = 1.5
"""Of the lift whose torques are ranked [s]."""

Array = NDArray[np.float64]
Program = tuple[Array, Array, Array, Array, Array]


def first_hold(run: Path, design: int) -> PushedDesign:
    """Where the robot of a design is pushed."""
    opened = open_design(read_run(run), design, 1, SILENT)
    scenes, robot = opened.rebuilt.problem.scenes, opened.scene_set().robot
    return PushedDesign(tuple(pushed_holds(scenes, robot, opened.cases[:1])))


def margin(pushed: PushedDesign, conditions: PushConditions) -> tuple[Margin, float]:
    """The least one, and the processor time that it takes [s]."""
    began = time.process_time()
    found = least_margin(pushed.tests(conditions), ROBOT, pushed.mass)
    assert found is not None
    return found, time.process_time() - began


def designs(run: Path, count: int, conditions: Mapping[str, PushConditions]) -> None:
    """Print the margins of the first feasible designs under each of the conditions."""
    feasible = [each for each in read_run(run).evaluations if each.assessment.violation == 0.0][:count]
    for each in feasible:
        pushed = first_hold(run, each.number)
        found = {name: margin(pushed, other) for name, other in conditions.items()}
        weakest = found["as planned"][0]
        changes = (
            f"{name} {m.impulse:.2f} N s ({100.0 * (m.impulse / weakest.impulse - 1.0):+.1f} %, {s:.1f} s)"
            for name, (m, s) in found.items()
        )
        print(
            f"design {each.number}, {pushed.mass:.1f} kg: {', '.join(changes)}; "
            f"to {np.degrees(weakest.direction):.0f} degrees: {weakest.reason}",
            flush=True,
        )


def rankings(run: Path, count: int, *, lifted: bool) -> None:
    """Print Kendall's tau between all that the log says of its first feasible designs.

    Args:
        run: with objectives and torques in its log.
        count: of designs.
        lifted: whether each design also lifts the load from its lowest to its highest hold.
    """
    log = read_run(run)
    feasible = [each.assessment for each in log.evaluations if each.assessment.violation == 0.0][:count]
    lift = torques_in_lifts(build_problem(log.header.problem)) if lifted else lambda _: {}
    rows = []
    for found in feasible:
        norms = [case.robot_torque_norm for case in found.cases if case.robot_torque_norm is not None]
        held = {**found.objectives, **found.constrained, "robot torque": float(np.mean(norms))}
        rows.append({**held, **lift(found.design)})
    names = max(rows, key=len)
    rows = [row for row in rows if len(row) == len(names)]
    print(f"{len(rows)} of {len(feasible)} feasible designs")
    for one, other in combinations(names, 2):
        tau = scipy.stats.kendalltau([row[one] for row in rows], [row[other] for row in rows])
        print(f"tau of {one} and {other}: {tau.statistic:.2f} (p = {tau.pvalue:.2g})")


def torques_in_lifts(problem: DesignProblem) -> Callable[[Mapping[str, float]], dict[str, float]]:
    """From a design's parameters to mean torque norms in a lift [N m]; none where it was not found."""
    heights = [height for task in problem.tasks for height in task.heights]
    asked = Lift(min(heights), max(heights), LIFT_SECONDS)
    evaluator = evaluator_of(problem, 1, SILENT, [asked])
    lifts = Lifts(evaluator, evaluator.known)

    def torques(design: Mapping[str, float]) -> dict[str, float]:
        found = [*lifts.solve(problem.space.values_of(design), asked).values()]
        if not all(each.solved for each in found):
            return {}
        means = {name: [each.efforts[name].mean_torque for each in found] for name in found[0].efforts}
        return {f"{name} torque in a lift": float(np.mean(each)) for name, each in means.items()}

    return torques


def recorded(run: Path, design: int) -> list[Program]:
    """Programs of all answers after a push."""
    found: list[Program] = []

    def kept(*program: Array, yielding: int = 0) -> QuadraticSolution:
        found.append(program)
        return least_squares(*program, yielding=yielding)

    (test,) = first_hold(run, design).tests(PushConditions()).values()
    controller.least_squares = kept
    test.pushed(Push(15.0, 0.0))
    controller.least_squares = least_squares
    return found


def by_daqp(*program: Array) -> Array:
    """The controller's own."""
    return least_squares(*program).x


def by_quadprog(a: Array, b: Array, c: Array, lower: Array, upper: Array) -> Array:
    """Goldfarb and Idnani."""
    import quadprog

    rows, ends = np.vstack([c, -c]), np.concatenate([lower, -upper])
    there = np.isfinite(ends)
    return np.asarray(quadprog.solve_qp(a.T @ a, a.T @ b, rows[there].T, ends[there])[0])


def by_piqp(a: Array, b: Array, c: Array, lower: Array, upper: Array) -> Array:
    """A proximal interior point."""
    import piqp

    solver = piqp.DenseSolver()
    solver.settings.eps_abs = solver.settings.eps_rel = 1e-9
    solver.setup(a.T @ a, -(a.T @ b), None, None, c, lower, upper)
    solver.solve()
    return np.asarray(solver.result.x)


SOLVERS: Mapping[str, Callable[..., Array]] = {"daqp": by_daqp, "quadprog": by_quadprog, "piqp": by_piqp}


def solvers(run: Path) -> None:
    """Print the time of each library, and how far its answers are from DAQP's."""
    design = next(each.number for each in read_run(run).evaluations if each.assessment.violation == 0.0)
    programs = recorded(run, design)
    known = [by_daqp(*program) for program in programs]
    print(f"{len(programs)} programs of {sorted({program[0].shape[1] for program in programs})} unknowns")
    for name, solve in SOLVERS.items():
        if find_spec(name) is None:
            continue
        off, spent = [], []
        for program, answer in zip(programs, known, strict=True):
            began = time.perf_counter()
            found = solve(*program)
            spent.append(1e3 * (time.perf_counter() - began))
            off.append(np.abs(found - answer).max() / max(1.0, np.abs(answer).max()))
        print(f"{name}: {np.median(spent):.3f} ms in the median, off by {max(off):.1e} at most")


def main() -> None:
    """Parse and run."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("run", type=Path)
    parser.add_argument("--designs", type=int, default=0)
    parser.add_argument("--half", action="store_true")
    parser.add_argument("--others", action="store_true")
    parser.add_argument("--rankings", type=int, default=0)
    parser.add_argument("--lifts", action="store_true")
    parser.add_argument("--solvers", action="store_true")
    given = parser.parse_args()
    usual = Timing()
    conditions = {"as planned": PushConditions()}
    if given.half:
        conditions["half the step"] = PushConditions(timing=replace(usual, substeps=2 * usual.substeps))
        conditions["half of all steps"] = PushConditions(timing=replace(usual, step=usual.step / 2.0))
    if given.others:
        conditions["friction"] = PushConditions(friction=PERTURBED["friction"])
        conditions["load mass"] = PushConditions(mass=PERTURBED["mass"])
        conditions["sensor delay"] = PushConditions(timing=replace(usual, delay=int(PERTURBED["delay"])))
    if given.solvers:
        solvers(given.run)
    if given.rankings:
        rankings(given.run, given.rankings, lifted=given.lifts)
    if given.designs:
        designs(given.run, given.designs, conditions)


if __name__ == "__main__":
    main()
