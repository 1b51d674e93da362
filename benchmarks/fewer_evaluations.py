"""After how many evaluations has the surrogate search what CMA-ES has after its budget?

On `problems/icub_materials.toml`, whose densities are materials, on `problems/point_grasp.toml` with a
greatest height of 1.48 m, which a fifth of all designs cannot reach, and on `problems/shared_lifting.toml`.
Hypervolumes are measured against the worst feasible values of quasi-random sampling, made worse by a tenth of
its range; the surrogate search is not told. Results go to benchmarks/results/fewer_evaluations.json and are
printed as a Markdown table.

    python -m benchmarks.fewer_evaluations [--evaluations 240] [--seeds 11 12 13]
"""

from __future__ import annotations

import argparse
import json
from dataclasses import replace
from pathlib import Path
from statistics import median

import moocore
import msgspec
import numpy as np
from numpy.typing import NDArray

from evodesign.evaluation.factory import evaluator_of
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.source import read_source
from evodesign.records import Evaluation
from evodesign.runlog.header import header_of
from evodesign.searches.registry import make_search
from evodesign.session import search_outcome

HERE = Path(__file__).parent
PROBLEMS = HERE.parent / "problems"
RESULTS = HERE / "results" / "fewer_evaluations.json"

HIGH = 1.48
"""The greatest height [m] of the second problem."""

ALGORITHMS = ("random", "cma-es", "surrogate")


def main() -> None:
    """Search all problems, write and print."""
    parser = argparse.ArgumentParser(description="Evaluations until a search has what CMA-ES has.")
    parser.add_argument("--evaluations", type=int, default=240)
    parser.add_argument("--seeds", type=int, nargs="*", default=[11, 12, 13])
    options = parser.parse_args()
    rows: dict[str, list[dict[str, float]]] = {}
    for name, problem in problems().items():
        rows[name] = []
        for seed in options.seeds:
            found = {each: values(problem, each, seed, options.evaluations) for each in ALGORITHMS}
            rows[name].append({"seed": seed} | compared(found))
            RESULTS.write_text(
                json.dumps({"evaluations": options.evaluations, "rows": rows}, indent=2) + "\n"
            )
            print(name, rows[name][-1], flush=True)
    print(table(rows))


def problems() -> dict[str, DesignProblem]:
    """By what is said of them."""
    names = ("icub_materials.toml", "point_grasp.toml", "shared_lifting.toml")
    catalogue, lifting, shared = (build_problem(read_source(PROBLEMS / name)) for name in names)
    tasks = (*lifting.tasks[:-1], msgspec.structs.replace(lifting.tasks[-1], height_m=HIGH))
    search = msgspec.structs.replace(lifting.search, reference={})
    high = replace(lifting, tasks=tasks, search=search, start=())
    return {"materials": catalogue, "a fifth infeasible": high, "shared load": shared}


def values(problem: DesignProblem, algorithm: str, seed: int, evaluations: int) -> NDArray[np.float64]:
    """Objectives in the order of evaluation, minimised; nan of infeasible designs."""
    settings = problem.settings(algorithm, 8 if algorithm == "surrogate" else 24, seed)
    header = header_of(problem, settings, evaluations)
    evaluator = evaluator_of(problem, 1)
    assess = evaluator.assess_with_gradients if settings.with_gradients else evaluator.assess
    search = make_search(settings)
    found: list[tuple[float, ...]] = []
    while len(found) < evaluations:
        outcomes = [
            search_outcome(header, Evaluation(place, 0, genome, assess(genome).assessment, 0.0, ""))
            for place, genome in enumerate(search.ask(), len(found))
        ]
        search.tell(outcomes)
        gap = (np.nan,) * settings.objectives
        found += [outcome.objectives if outcome.feasible else gap for outcome in outcomes]
    return np.array(found[:evaluations], dtype=float)


def compared(found: dict[str, NDArray[np.float64]]) -> dict[str, float]:
    """The share of infeasible designs, hypervolumes, and the evaluations until the surrogate has CMA-ES's."""
    sampled = found["random"]
    worst, best = np.nanmax(sampled, axis=0), np.nanmin(sampled, axis=0)
    reference = worst + 0.1 * (worst - best)

    def volume(name: str, count: int) -> float:
        told = found[name][:count]
        inside = told[(told < reference).all(axis=1)]
        return float(moocore.hypervolume(inside, ref=reference)) if len(inside) else 0.0

    budget = len(sampled)
    wanted = volume("cma-es", budget)
    needed = next((count for count in range(1, budget + 1) if volume("surrogate", count) >= wanted), None)
    return {
        "infeasible": float(np.isnan(sampled[:, 0]).mean()),
        "random": volume("random", budget),
        "cma-es": wanted,
        "surrogate": volume("surrogate", budget),
        "needed": needed or np.inf,
    }


def table(rows: dict[str, list[dict[str, float]]]) -> str:
    """Medians, with the least and the largest."""
    lines = ["| problem | infeasible | CMA-ES / random | surrogate / random | evaluations needed |"]
    lines.append("|---|---|---|---|---|")
    for name, own in rows.items():
        needed = [row["needed"] for row in own]
        ratios = [median(row[each] / row["random"] for row in own) for each in ALGORITHMS[1:]]
        lines.append(
            f"| {name} | {median(row['infeasible'] for row in own):.0%} | {ratios[0]:.2f} | {ratios[1]:.2f} "
            f"| {median(needed):.0f} ({min(needed):.0f} to {max(needed):.0f}) |"
        )
    return "\n".join(lines)


if __name__ == "__main__":
    main()
