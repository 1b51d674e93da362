"""Does evolution escape the local minima of the paper's gradient-based problem?

Four ways minimise the same scalar cost, that of Sartore et al. 2022, Eq. 14, on problems/sartore2022.toml,
with ten seeds each and the same number of solves over all heights: a start of the joint problem is one, a
design evaluated height by height is one, and a polish is one.

    joint      the joint problem from many starts: the named designs, then quasi-random ones
    cma-es     CMA-ES over designs, postures solved inside
    nsga2      NSGA-II over designs with the one objective, postures solved inside
    polished   CMA-ES; after each generation its three best designs become starts of the joint problem, from
               the postures that they have

A trace holds one row per solve: cost, torques and processor time so far. Building and compiling the programs
are not counted. Results go to benchmarks/results/evolution_vs_gradient.json
and are printed as Markdown tables.

    python benchmarks/evolution_vs_gradient.py [--seeds 10] [--solves 120] [--jobs 2]
"""

from __future__ import annotations

import argparse
import itertools
import json
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import cache
from pathlib import Path

import msgspec
import numpy as np

from evodesign.analysis.hypervolume import hypervolume
from evodesign.evaluation.baseline import Baseline
from evodesign.evaluation.evaluate import Evaluator
from evodesign.evaluation.factory import cached_precomputed
from evodesign.pool.registry import make_pool
from evodesign.posture.formulations.codesign import JointSolution
from evodesign.posture.precompute.precomputed import Precomputed
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.source import read_source
from evodesign.quantities.design_result import DesignResult
from evodesign.quantities.objectives import objective_values
from evodesign.records import Assessment, Evaluation, Genome, Objective, SearchSettings, Sense, Status
from evodesign.searches.base import JOINT_STARTS, Outcome
from evodesign.searches.cma_instances import default_population
from evodesign.searches.registry import make_search

HERE = Path(__file__).parent
PROBLEM = HERE.parent / "problems" / "sartore2022.toml"
COST, TORQUES = "paper_cost", ("robot_torque", "human_torque")
FRONT = tuple(Objective(name=name, sense=Sense.MINIMISE, unit="N m") for name in TORQUES)
SHOWN = (Objective(name=COST, sense=Sense.MINIMISE, unit="(10 N m)^2"), *FRONT)
REFERENCE = dict.fromkeys(TORQUES, 20.0)
"""Corner of the hypervolume [N m], beyond every design of use."""
POLISHES = 3
SHARE = 1.01
FEW = 50
"""Starts of the paper's side in the comparison at equal processor time."""

Row = dict[str, float | None]
Step = tuple[Genome, dict[str, float], float | None, float, DesignResult | None]


def _known(problem: DesignProblem) -> Precomputed:
    """Starts, from the cache or worked out now."""
    with make_pool("joblib", 2) as pool:
        return cached_precomputed(problem, pool)


class Bench:
    """The inner problems, built once per process."""

    def __init__(self) -> None:
        source = read_source(PROBLEM)
        source = msgspec.structs.replace(
            source, text=source.text.replace("[baseline]\n", "[baseline]\ncompile = true\n")
        )
        self.problem: DesignProblem = build_problem(source)
        people = _known(self.problem)
        self.evaluator = Evaluator(self.problem, people)
        self.baseline = Baseline(self.problem)

    def evaluated(self, genome: Genome) -> Step:
        """A design solved height by height."""
        values = self.problem.space.values(genome)
        began = time.process_time()
        result = self.evaluator.solve(values)
        spent = time.process_time() - began
        assessment = self.evaluator.assessment(values, result)
        if assessment.violation != 0.0:
            return genome, {}, assessment.violation, spent, None
        return genome, objective_values(SHOWN, result), 0.0, spent, result

    def joint(self, solve: Callable[[], JointSolution], genome: Genome) -> Step:
        """A start of the joint problem, or a polish."""
        began = time.process_time()
        solution = solve()
        spent = time.process_time() - began
        if not solution.solved:
            return genome, {}, None, spent, None
        values = objective_values(SHOWN, self.baseline.result(solution))
        found = tuple(self.problem.space.genome(solution.design))
        return found, values, 0.0, spent, None


@cache
def bench() -> Bench:
    """This process's bench."""
    return Bench()


def settings(algorithm: str, population: int, seed: int) -> SearchSettings:
    """Settings of a search with one objective."""
    known = bench().problem.settings(algorithm, population, seed)
    return msgspec.structs.replace(known, objectives=1)


def starts(seed: int) -> Iterator[Step]:
    """The joint problem from many starts."""
    here = bench()
    search = make_search(settings(JOINT_STARTS, 10, seed))
    while True:
        genomes = search.ask()
        for genome in genomes:
            yield here.joint(lambda genome=genome: here.baseline.solve(genome), genome)
        search.tell([Outcome(objectives=None, violation=None)] * len(genomes))


def evolved(algorithm: str, population: int, seed: int, *, polishes: int) -> Iterator[Step]:
    """A search, with a polish of so many of each generation's best designs."""
    here = bench()
    search = make_search(settings(algorithm, population, seed))
    while True:
        born = []
        for genome in search.ask():
            born.append(here.evaluated(genome))
            yield born[-1]
        solved = [step for step in born if step[4] is not None]
        for step in sorted(solved, key=lambda step: step[1][COST])[:polishes]:
            yield here.joint(lambda result=step[4]: here.baseline.polish(result), step[0])
        search.tell([Outcome(_costs(values), violation) for _, values, violation, _, _ in born])


def _costs(values: dict[str, float]) -> tuple[float, ...] | None:
    return (values[COST],) if COST in values else None


ARMS: dict[str, Callable[[int], Iterator[Step]]] = {
    "joint": starts,
    "cma-es": lambda seed: evolved("cma-es", default_population(16), seed, polishes=0),
    "nsga2": lambda seed: evolved("nsga2", 24, seed, polishes=0),
    "polished": lambda seed: evolved("cma-es", default_population(16), seed, polishes=POLISHES),
}


def trace(task: tuple[str, int, int]) -> tuple[str, int, list[Row], float | None]:
    """One arm with one seed: its rows, and what the joint problem's best early design costs anew."""
    arm, seed, solves = task
    rows: list[Row] = []
    steps, spent = [], 0.0
    for step in itertools.islice(ARMS[arm](seed), solves):
        steps.append(step)
        spent += step[3]
        rows.append({"cost": step[1].get(COST), **{n: step[1].get(n) for n in TORQUES}, "seconds": spent})
    again = None
    if arm == "joint":
        solved = [step for step in steps[:FEW] if COST in step[1]]
        if solved:
            again = bench().evaluated(min(solved, key=lambda step: step[1][COST])[0])[1].get(COST)
    return arm, seed, rows, again


def main() -> None:
    """Run all arms with all seeds, compare, write and print."""
    options = _options()
    bench()  # compiles once, before the workers look
    tasks = [(arm, seed, options.solves) for seed in range(1, options.seeds + 1) for arm in ARMS]
    runs: dict[tuple[str, int], list[Row]] = {}
    again: dict[int, float | None] = {}
    with ProcessPoolExecutor(options.jobs) as pool:
        for arm, seed, rows, value in pool.map(trace, tasks):
            runs[arm, seed] = rows
            if arm == "joint":
                again[seed] = value
            best = best_after(rows, len(rows))
            print(f"{arm} seed {seed}: {best:.4f} in {rows[-1]['seconds']:.0f} s", flush=True)
    result = summary(runs, again, options.solves)
    result["traces"] = {f"{arm} {seed}": improvements(rows) for (arm, seed), rows in runs.items()}
    target = HERE / "results" / "evolution_vs_gradient.json"
    target.write_text(json.dumps(result, indent=1) + "\n")
    print(markdown(result))


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description="Evolution against the gradient-based joint problem.")
    for name, default in (("seeds", 10), ("solves", 120), ("jobs", 2)):
        parser.add_argument(f"--{name}", type=int, default=default)
    return parser.parse_args()


def best_after(rows: Sequence[Row], solves: int) -> float:
    """Least cost of the first solves; infinite without any."""
    return min((row["cost"] for row in rows[:solves] if row["cost"] is not None), default=float("inf"))


def best_within(rows: Sequence[Row], seconds: float) -> float:
    """Least cost within so much processor time."""
    return best_after([row for row in rows if (row["seconds"] or 0.0) <= seconds], len(rows))


def improvements(rows: Sequence[Row]) -> list[list[float]]:
    """Solves, seconds and cost wherever the best cost fell."""
    found: list[list[float]] = []
    for number, row in enumerate(rows, 1):
        if row["cost"] is not None and (not found or row["cost"] < found[-1][2]):
            found.append([number, round(row["seconds"] or 0.0, 3), row["cost"]])
    return found


def summary(runs: dict[tuple[str, int], list[Row]], again: dict[int, float | None], solves: int) -> dict:
    """Everything that the tables show."""
    known = min(best_after(rows, solves) for rows in runs.values())
    seeds = sorted({seed for _, seed in runs})
    arms = {}
    for arm in ARMS:
        own = [runs[arm, seed] for seed in seeds]
        arms[arm] = {
            f"after {count} solves": figures([best_after(rows, count) for rows in own], known)
            for count in sorted({solves // 2, FEW, solves})
        }
        arms[arm]["hypervolume"] = spread([_volume(rows) for rows in own])
        arms[arm]["seconds per solve"] = spread([(rows[-1]["seconds"] or 0.0) / len(rows) for rows in own])
        arms[arm]["failed share"] = float(np.mean([[row["cost"] is None for row in rows] for rows in own]))
    time_of = {seed: runs["joint", seed][FEW - 1]["seconds"] or 0.0 for seed in seeds}
    few = {seed: best_after(runs["joint", seed], FEW) for seed in seeds}
    equal = {
        arm: {
            "best": [best_within(runs[arm, seed], time_of[seed]) for seed in seeds],
            "as good as the joint problem": sum(
                best_within(runs[arm, seed], time_of[seed]) <= few[seed] * (1.0 + 1e-6) for seed in seeds
            ),
        }
        for arm in ARMS
    }
    return {
        "problem": PROBLEM.name,
        "seeds": len(seeds),
        "solves": solves,
        "best_known": known,
        "arms": arms,
        "equal_time": {
            "starts": FEW,
            "seconds": list(time_of.values()),
            "joint": list(few.values()),
            "joint_design_evaluated_anew": [again[seed] for seed in seeds],
            "arms": equal,
        },
    }


def _volume(rows: Sequence[Row]) -> float:
    evaluations = [
        Evaluation(
            number=number,
            generation=0,
            genome=(),
            assessment=Assessment(
                design={},
                objectives={name: float(row[name] or "nan") for name in TORQUES},
                violation=0.0,
                status=Status.SOLVED,
                reason="solved",
            ),
            seconds=0.0,
            worker="",
        )
        for number, row in enumerate(rows)
        if row["cost"] is not None
    ]
    return hypervolume(FRONT, evaluations, REFERENCE)


def spread(values: Sequence[float]) -> dict[str, float]:
    """Median and quartiles."""
    low, middle, high = np.percentile(values, [25, 50, 75]).tolist()
    return {"median": middle, "quartile_1": low, "quartile_3": high}


def figures(costs: Sequence[float], known: float) -> dict:
    """Spread, extremes, and the share of seeds within a hundredth of the best known."""
    near = sum(cost <= SHARE * known for cost in costs) / len(costs)
    return {**spread(costs), "least": min(costs), "most": max(costs), "within_1_percent": near}


def markdown(result: dict) -> str:
    """The tables of docs/benchmarks.md."""
    lines = [
        "| arm | solves | median | quartiles | least | within 1 % of best known |",
        "|---|---|---|---|---|---|",
    ]
    for arm, of in result["arms"].items():
        for label, row in of.items():
            if label.startswith("after"):
                quartiles = f"{row['quartile_1']:.3f} to {row['quartile_3']:.3f}"
                lines.append(
                    f"| {arm} | {label.split()[1]} | {row['median']:.3f} | {quartiles} | "
                    f"{row['least']:.3f} | {row['within_1_percent']:.0%} |"
                )
    lines += ["", "| arm | hypervolume, median | s per solve | failed or infeasible |", "|---|---|---|---|"]
    for arm, of in result["arms"].items():
        lines.append(
            f"| {arm} | {of['hypervolume']['median']:.1f} | {of['seconds per solve']['median']:.3f} | "
            f"{of['failed share']:.0%} |"
        )
    equal = result["equal_time"]
    lines += [
        "",
        f"| in the time of {equal['starts']} starts | as good as the joint problem | median |",
        "|---|---|---|",
    ]
    for arm, of in equal["arms"].items():
        good = f"{of['as good as the joint problem']} of {result['seeds']}"
        lines.append(f"| {arm} | {good} | {np.median(of['best']):.3f} |")
    return "\n".join(lines)


if __name__ == "__main__":
    main()
