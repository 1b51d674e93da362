"""How long the paper's own formulation takes over a posture problem that ours solves, in the same run.

Both solve the same posture problem (`paper_posture` says what that means) for the same random designs at one
height. The paper's runs on CasADi's virtual machine with IPOPT's exact Hessian (without it, a first try ended
after 855 iterations in a failure of IPOPT's), from one start per design. Ours runs as in a search, from
seeds, and as the symmetric and the whole program, from two fixed starts; compiled, and on the virtual
machine. Times are the processor's in this process, so that waiting for other programs is not counted.

    python -m benchmarks.paper_formulation [--designs 3] [--height 1.0] [--iterations 300] [--seconds 300]
"""

from __future__ import annotations

import argparse
import statistics
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import islice
from pathlib import Path

import numpy as np

from benchmarks.paper_posture import PaperPostures
from evodesign.evaluation.factory import cached_precomputed
from evodesign.nlp.method import SolverOptions
from evodesign.pool.worker import SerialPool
from evodesign.posture.check import AgentModel, Checker
from evodesign.posture.formulations.base import Setting
from evodesign.posture.formulations.reach import ReachProblem
from evodesign.posture.postures import PostureProblem, Symmetry
from evodesign.posture.precompute.precomputed import NOTHING_PRECOMPUTED, Precomputed
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.source import read_source
from evodesign.records import Hold, Status

PROBLEM = Path(__file__).parent.parent / "problems" / "point_grasp.toml"

BOUNDED = SolverOptions(iterations=300, seconds=300.0)
"""Limits of one solve of the paper's program."""

TOLERANCE = 1e-4
"""Largest residual (SI units) of a posture of the paper's program that counts as solved: ten times ours,
because the damping of the pseudo-inverse alone leaves 1e-5."""

LOOKED_AT = 20
"""Random designs looked at for each one that is asked for."""


@dataclass(frozen=True, slots=True)
class Figures:
    """What solving cost.

    Args:
        seconds_per_iteration: processor time of all solves over all their iterations [s].
        iterations: median over the solves.
        solved: heights with a posture that the solver and the independent check accept.
        tried: heights.
        seconds_per_solved_height: all processor time over the heights solved [s]; infinite if there are none.
    """

    seconds_per_iteration: float
    iterations: float
    solved: int
    tried: int
    seconds_per_solved_height: float


def measure(
    problem: DesignProblem,
    designs: Sequence[Sequence[float]],
    height: float,
    options: SolverOptions = BOUNDED,
) -> Figures:
    """What the paper's formulation costs.

    Args:
        problem: whose posture problem is solved.
        designs: one number per design parameter each; they should reach the height.
        height: of the load's centre [m].
        options: limits of each solve; building the program, some 10 s, is not among the times.
    """
    paper = PaperPostures(problem, options)
    seconds, iterations, solved = 0.0, [], 0
    for values in designs:
        began = time.process_time()
        raw = paper.solve(values, height)
        seconds += time.process_time() - began
        iterations.append(raw.iterations)
        solved += raw.status is Status.SOLVED and paper.residual(raw, values, height) <= TOLERANCE
    return _figures(seconds, iterations, solved, len(designs))


def measure_ours(
    problem: DesignProblem, known: Precomputed, designs: Sequence[Sequence[float]], height: float
) -> Figures:
    """What our posture problem costs, every start and the check of the best included; as for `measure`."""
    scene, space = problem.scene, problem.space
    ours = PostureProblem(Setting(scene, space, problem.weights, problem.options), problem.symmetry, known)
    human = AgentModel.of(scene.human, scene.human.tree)
    ours.landscape(Hold(height_m=height))  # builds the program
    seconds, iterations, solved = 0.0, [], 0
    for values in designs:
        checker = Checker(scene, AgentModel.of(scene.robot, space.resized(scene.robot.tree, values)), human)
        began = time.process_time()
        solution = ours.solve(values, Hold(height_m=height), checker)
        seconds += time.process_time() - began
        iterations += [attempt.iterations for attempt in solution.attempts]
        solved += solution.solved
    return _figures(seconds, iterations, solved, len(designs))


def _figures(seconds: float, iterations: Sequence[int], solved: int, tried: int) -> Figures:
    return Figures(
        seconds_per_iteration=seconds / max(1, sum(iterations)),
        iterations=statistics.median(iterations) if iterations else 0.0,
        solved=solved,
        tried=tried,
        seconds_per_solved_height=seconds / solved if solved else float("inf"),
    )


def reaching_designs(problem: DesignProblem, height: float, count: int) -> list[tuple[float, ...]]:
    """Uniformly random designs that reach a height [m], the same ones every time; fewer if few reach it."""
    symmetric = problem.symmetry is not Symmetry.OFF
    setting = Setting(problem.scene, problem.space, problem.weights, problem.options)
    reach = ReachProblem(setting, symmetric=symmetric, known=NOTHING_PRECOMPUTED)
    rng = np.random.default_rng(1)
    genomes = rng.uniform(size=(LOOKED_AT * count, len(problem.space.parameters))).tolist()
    designs = (problem.space.values(tuple(genome)) for genome in genomes)
    return list(islice((d for d in designs if reach.solve(d).distance(height) == 0.0), count))


def main() -> None:
    """Measure and print."""
    options = _options()
    problem = build_problem(read_source(PROBLEM))
    compiled = replace(problem, options=replace(problem.options, compiled=True))
    plain = replace(problem, options=replace(problem.options, compiled=False))
    with SerialPool() as pool:
        known = cached_precomputed(problem, pool)
    designs = reaching_designs(plain, options.height, options.designs)
    if len(designs) < options.designs:
        sys.exit(
            f"only {len(designs)} of {options.designs} designs that reach {options.height:g} m were found"
        )
    sys.stderr.write("solving the paper's formulation\n")
    limits = SolverOptions(iterations=options.iterations, seconds=options.seconds)
    rows = {"the paper's formulation": measure(problem, designs, options.height, limits)}
    for name, chosen in (("compiled", compiled), ("not compiled", plain)):
        whole = replace(chosen, symmetry=Symmetry.OFF)
        rows |= {
            f"ours, as searched, {name}": measure_ours(chosen, known, designs, options.height),
            f"ours, symmetric, {name}": measure_ours(chosen, NOTHING_PRECOMPUTED, designs, options.height),
            f"ours, whole, {name}": measure_ours(whole, NOTHING_PRECOMPUTED, designs, options.height),
        }
    print(_table(rows))


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description="The paper's formulation against ours.")
    parser.add_argument("--designs", type=int, default=3)
    parser.add_argument("--height", type=float, default=1.0)
    parser.add_argument("--iterations", type=int, default=BOUNDED.iterations)
    parser.add_argument("--seconds", type=float, default=BOUNDED.seconds)
    return parser.parse_args()


def _table(rows: dict[str, Figures]) -> str:
    paper = next(iter(rows.values()))
    lines = [
        "| | ms per iteration | iterations | solved | s per solved height | the paper's takes |",
        "|---|---|---|---|---|---|",
    ]
    lines += [
        f"| {name} | {1e3 * row.seconds_per_iteration:.3g} | {row.iterations:g} | {row.solved}/{row.tried} "
        f"| {row.seconds_per_solved_height:.3g} "
        f"| {paper.seconds_per_solved_height / row.seconds_per_solved_height:.3g} times as long |"
        for name, row in rows.items()
    ]
    return "\n".join(lines)


if __name__ == "__main__":
    main()
