"""What one design costs.

Medians per solve on one core, with compiled functions and on CasADi's virtual machine: reach from the
problem's starts, both agents symmetrically and whole from their fixed starts. Then whole evaluations: designs
per second and core, the share of the time spent outside IPOPT, two workers against one, and the paper's own
formulation of the same posture problem. Processor time is given beside wall time, since a machine may be
shared. Results go to benchmarks/results/inner_speed.json and are printed as Markdown tables.

    python -m benchmarks.inner_speed [--designs 40] [--evaluations 96] [--paper 3]
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from typing import Any
from unittest import mock

import numpy as np

from benchmarks.inner_problem import HERE, Design, known_at, problem_at, random_designs
from benchmarks.paper_formulation import measure, measure_ours, reaching_designs
from evodesign.evaluation.evaluate import AssessmentFactory, Evaluator
from evodesign.nlp.program import Start
from evodesign.nlp.solver import RawSolution, Solver
from evodesign.pool.joblib_pool import JoblibPool
from evodesign.posture.formulations.base import Setting
from evodesign.posture.formulations.reach import HIGHEST, LOWEST, ReachProblem
from evodesign.posture.postures import PostureProblem, Symmetry
from evodesign.posture.precompute.precomputed import Precomputed
from evodesign.posture.seeking.landscape import Landscape
from evodesign.problem.build import DesignProblem
from evodesign.records import Hold, Status

HOLD = Hold(height_m=1.0)
DEFAULT_HEIGHTS = (0.8, 1.0, 1.2)


def main() -> None:
    """Measure, write and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--designs", type=int, default=40)
    parser.add_argument("--evaluations", type=int, default=96)
    parser.add_argument("--paper", type=int, default=3)
    options = parser.parse_args()
    problem = problem_at(DEFAULT_HEIGHTS)
    known = known_at(problem, 2)
    designs = random_designs(problem, options.evaluations)
    solves = [
        _per_solve(name, compiled, landscape, starts, designs[: options.designs])
        for compiled in (True, False)
        for name, landscape, starts in _landscapes(problem, known, compiled)
    ]
    whole = _evaluations(problem, known, designs)
    workers = _workers(problem, known, designs)
    paper = _paper(problem, known, options.paper)
    target = HERE / "results" / "inner_speed.json"
    result = {**vars(options), "solves": solves, "evaluations": whole, "workers": workers, "paper": paper}
    target.write_text(json.dumps(result, indent=2) + "\n")
    print("\n\n".join([_table(solves), _table([{**whole, **workers}]), _table(paper)]))


def _landscapes(
    problem: DesignProblem, known: Precomputed, compiled: bool
) -> Iterator[tuple[str, Landscape, Sequence[Start]]]:
    """The programs with their starts."""
    options = replace(problem.options, compiled=compiled)
    setting = Setting(problem.scene, problem.space, problem.weights, options)
    reach = ReachProblem(setting, symmetric=True)
    yield "highest load", reach.landscape(HIGHEST), known.highest.starts
    yield "lowest load", reach.landscape(LOWEST), known.lowest.starts
    for name, symmetry in (("both, symmetric, 1.0 m", Symmetry.ON), ("both, whole, 1.0 m", Symmetry.OFF)):
        joint = PostureProblem(setting, symmetry).landscape(HOLD)
        yield name, joint, joint.starts


def _per_solve(
    name: str, compiled: bool, landscape: Landscape, starts: Sequence[Start], designs: Sequence[Design]
) -> dict[str, Any]:
    """Medians over all designs and starts."""
    rows = []
    for design in designs:
        for start in starts:
            wall, processor = time.perf_counter(), time.process_time()
            end = landscape.solve(design, start)
            spent = time.perf_counter() - wall, time.process_time() - processor
            rows.append((*spent, end.iterations, end.status is Status.SOLVED))
    wall_s, processor_s, iterations, solved = np.array(rows, float).T
    return {
        "program": name,
        "functions": "compiled" if compiled else "virtual machine",
        "wall_ms": 1e3 * float(np.median(wall_s)),
        "processor_ms": 1e3 * float(np.median(processor_s)),
        "iterations": float(np.median(iterations)),
        "solved_share": float(solved.mean()),
    }


def _evaluations(problem: DesignProblem, known: Precomputed, designs: Sequence[Design]) -> dict[str, float]:
    """Whole evaluations in this process."""
    evaluator = Evaluator(problem, known)
    genomes = [problem.space.genome(design) for design in designs]
    evaluator.assess(genomes[0])
    inside = {"wall": 0.0, "processor": 0.0}
    with _timed_solves(inside):
        wall, processor = time.perf_counter(), time.process_time()
        for genome in genomes:
            evaluator.assess(genome)
        spent = {"wall": time.perf_counter() - wall, "processor": time.process_time() - processor}
    return {
        "designs": len(genomes),
        "designs_per_second_wall": len(genomes) / spent["wall"],
        "designs_per_second_processor": len(genomes) / spent["processor"],
        "outside_ipopt_wall": 1.0 - inside["wall"] / spent["wall"],
        "outside_ipopt_processor": 1.0 - inside["processor"] / spent["processor"],
    }


@contextmanager
def _timed_solves(inside: dict[str, float]) -> Iterator[None]:
    """Add the time of every solve to `inside`."""
    solve = Solver.solve

    def timed(self: Solver, parameters: Sequence[float], start: Mapping[str, Any]) -> RawSolution:
        wall, processor = time.perf_counter(), time.process_time()
        end = solve(self, parameters, start)
        inside["wall"] += time.perf_counter() - wall
        inside["processor"] += time.process_time() - processor
        return end

    with mock.patch.object(Solver, "solve", timed):
        yield


def _workers(problem: DesignProblem, known: Precomputed, designs: Sequence[Design]) -> dict[str, float]:
    """Throughput of two workers over that of one, and what lies between workers' work and the wall."""
    genomes = [problem.space.genome(design) for design in designs]
    rates, busy = {}, {}
    for jobs in (1, 2):
        factory = AssessmentFactory(f"benchmark {jobs}", problem, known)
        with JoblibPool(jobs) as pool:
            list(pool.run(factory, genomes[: 2 * jobs]))  # workers start and build
            began = time.perf_counter()
            spent = sum(finished.seconds for finished in pool.run(factory, genomes))
            wall = time.perf_counter() - began
        rates[jobs], busy[jobs] = len(genomes) / wall, spent / (jobs * wall)
    return {"two_workers_over_one": rates[2] / rates[1], "busy_share_of_two_workers": busy[2]}


def _paper(problem: DesignProblem, known: Precomputed, count: int) -> list[dict[str, Any]]:
    """The paper's formulation and ours at 1.0 m, in processor time."""
    designs = reaching_designs(problem, 1.0, count)
    paper, ours = measure(problem, designs, 1.0), measure_ours(problem, known, designs, 1.0)
    return [
        {
            "formulation": name,
            "ms_per_iteration": 1e3 * figures.seconds_per_iteration,
            "iterations": figures.iterations,
            "solved": f"{figures.solved} of {figures.tried}",
            "seconds_per_solved_height": figures.seconds_per_solved_height,
            "ratio": paper.seconds_per_solved_height / figures.seconds_per_solved_height,
        }
        for name, figures in (("the paper's", paper), ("ours", ours))
    ]


def _table(rows: Sequence[Mapping[str, Any]]) -> str:
    names = list(rows[0])
    lines = [f"| {' | '.join(names)} |", "|" + "---|" * len(names)]
    for row in rows:
        cells = [f"{row[name]:.3g}" if isinstance(row[name], float) else str(row[name]) for name in names]
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


if __name__ == "__main__":
    main()
