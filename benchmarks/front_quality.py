"""How much of the best known front does a search find with a budget?

Every algorithm searches `problems/point_grasp.toml` with every seed, in this process, without a log. What
counts is the share of a hypervolume of 15.423, against the reference point 30 N m, 7.2 N m, 1.2 m: that of
all fronts together that were known when searches were first compared. Our searches begin with the designs
that the problem names; those of other libraries have their own defaults. Processor time is that of proposing
designs and of evaluating them, gradients included, per evaluation. Results go to
benchmarks/results/front_quality.json, with the front of everything ever found, and are printed as a Markdown
table; --picture draws docs/pictures/front_quality.png from them and searches nothing.

    python -m benchmarks.front_quality [--evaluations 1920] [--seeds 41 42 43 44 45] [--only NAME ...]
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from statistics import median

import matplotlib.pyplot as plt
import moocore
import msgspec
import numpy as np

from benchmarks.baseline_searches import BASELINES, BOTORCH
from evodesign.evaluation.factory import evaluator_of
from evodesign.problem.build import build_problem
from evodesign.problem.source import read_source
from evodesign.records import Evaluation
from evodesign.runlog.header import header_of
from evodesign.searches.registry import make_search
from evodesign.session import search_outcome

HERE = Path(__file__).parent
PROBLEM = HERE.parent / "problems" / "point_grasp.toml"
RESULTS = HERE / "results" / "front_quality.json"
PICTURE = HERE.parent / "docs" / "pictures" / "front_quality.png"

REFERENCE = (30.0, 7.2, -1.2)
"""Robot torque [N m], human torque [N m], minus the reach [m]."""

BEST_KNOWN = 15.423
BUDGETS = (120, 240, 480, 960, 1920)

OURS = ("surrogate", "surrogate, no reference", "nsga2", "cma-es", "random")
ALGORITHMS = (*OURS, *BASELINES)


@dataclass(frozen=True, slots=True)
class Row:
    """One search: shares [%] by number of evaluations, and milliseconds per evaluation."""

    algorithm: str
    seed: int
    shares: dict[int, float]
    proposing_ms: float
    evaluating_ms: float


def main() -> None:
    """Run all searches, write and print."""
    parser = argparse.ArgumentParser(description="Shares of the best known hypervolume.")
    for name, default in (("evaluations", 1920), ("jobs", 2)):
        parser.add_argument(f"--{name}", type=int, default=default)
    parser.add_argument("--seeds", type=int, nargs="*", default=[41, 42, 43, 44, 45])
    parser.add_argument("--only", nargs="*", default=[name for name in ALGORITHMS if name != BOTORCH])
    parser.add_argument("--picture", action="store_true")
    options = parser.parse_args()
    known = json.loads(RESULTS.read_text())
    if options.picture:
        draw(known["rows"])
        return
    keys = [(name, seed) for seed in options.seeds for name in options.only]
    rows = [row for row in known["rows"] if (row["algorithm"], row["seed"]) not in keys]
    with ProcessPoolExecutor(options.jobs, mp_context=get_context("spawn")) as pool:
        for row, front in pool.map(partial(searched, evaluations=options.evaluations), keys):
            rows.append(asdict(row) | {"shares": {str(key): share for key, share in row.shares.items()}})
            known |= {"rows": rows, "front": _front([*known["front"], *front])}
            known["front_hypervolume"] = share_of(known["front"]) * BEST_KNOWN / 100.0
            RESULTS.write_text(json.dumps(known, indent=1) + "\n")
            print(row, flush=True)
    print(table(rows))


def searched(key: tuple[str, int], evaluations: int) -> tuple[Row, list[list[float]]]:
    """One search of an algorithm with a seed, and its front."""
    name, seed = key
    problem = build_problem(read_source(PROBLEM))
    evaluator = evaluator_of(problem, 1)
    algorithm, _, untold = name.partition(",")
    ours = algorithm in OURS
    settings = problem.settings(algorithm if ours else "random", 8 if algorithm == "surrogate" else 48, seed)
    settings = msgspec.structs.replace(settings, reference=msgspec.UNSET if untold else REFERENCE)
    header = header_of(problem, settings, evaluations)
    assess = evaluator.assess_with_gradients if settings.with_gradients else evaluator.assess
    assess((0.5,) * settings.dimension)  # nothing is compiled or built while time is taken
    clocks = {"proposing": 0.0, "evaluating": 0.0}

    def timed(what: str, call: Callable[[], object]) -> object:
        began = time.process_time()
        found = call()
        clocks[what] += time.process_time() - began
        return found

    search = timed("proposing", lambda: make_search(settings) if ours else BASELINES[name](name, settings))
    values: list[tuple[float, ...]] = []
    shares: dict[int, float] = {}
    count = 0
    while count < evaluations:
        outcomes = []
        for genome in timed("proposing", search.ask):
            assessed = timed("evaluating", partial(assess, genome))
            found = Evaluation(count, 0, genome, assessed.assessment, 0.0, "")
            outcomes.append(search_outcome(header, found))
            if outcomes[-1].feasible:
                values.append(outcomes[-1].objectives)
            count += 1
            if count in BUDGETS and count <= evaluations:
                shares[count] = share_of(values)
        timed("proposing", partial(search.tell, outcomes))
    each = {what: 1000.0 * seconds / count for what, seconds in clocks.items()}
    return Row(name, seed, shares, each["proposing"], each["evaluating"]), _front(values)


def _front(values: Sequence[Sequence[float]]) -> list[list[float]]:
    """The values within the reference that no other dominates, to six decimals."""
    points = np.unique(np.round(np.array(values), 6), axis=0)
    points = points[(points < REFERENCE).all(axis=1)]
    return points[moocore.is_nondominated(points)].tolist()


def share_of(values: Sequence[Sequence[float]]) -> float:
    """Share of the best known hypervolume that minimised objectives have [%]."""
    points = np.array(values)
    inside = points[(points < REFERENCE).all(axis=1)]
    return 100.0 * float(moocore.hypervolume(inside, ref=REFERENCE)) / BEST_KNOWN if len(inside) else 0.0


def table(rows: list[dict[str, object]]) -> str:
    """Medians over seeds, with the worst and the best."""
    budgets = sorted({int(budget) for row in rows for budget in row["shares"]})
    lines = ["| search | seeds | " + " | ".join(map(str, budgets)) + " | proposing, ms | evaluating, ms |"]
    lines.append("|---|---|" + "---|" * (len(budgets) + 2))
    for name in ALGORITHMS:
        own = [row for row in rows if row["algorithm"] == name]
        if not own:
            continue
        cells = []
        for budget in budgets:
            found = [row["shares"][str(budget)] for row in own if str(budget) in row["shares"]]
            several = f" ({min(found):.1f} to {max(found):.1f})" if len(found) > 1 else ""
            cells.append(f"{median(found):.1f}{several}" if found else "")
        times = [f"{median(row[key] for row in own):.1f}" for key in ("proposing_ms", "evaluating_ms")]
        lines.append(f"| {name} | {len(own)} | " + " | ".join([*cells, *times]) + " |")
    return "\n".join(lines)


def draw(rows: list[dict[str, object]]) -> None:
    """Medians by number of evaluations, with the range of all seeds."""
    figure, axes = plt.subplots(figsize=(7.0, 4.4), layout="constrained")
    for name in ALGORITHMS:
        own = [row["shares"] for row in rows if row["algorithm"] == name]
        budgets = sorted({int(budget) for shares in own for budget in shares})
        found = [[shares[str(budget)] for shares in own if str(budget) in shares] for budget in budgets]
        if found:
            (line,) = axes.plot(
                budgets, [median(each) for each in found], marker="o", markersize=3, label=name
            )
            low, high = ([end(each) for each in found] for end in (min, max))
            axes.fill_between(budgets, low, high, color=line.get_color(), alpha=0.12, linewidth=0)
    axes.set_xscale("log", base=2)
    axes.set_xticks(BUDGETS, [str(budget) for budget in BUDGETS])
    axes.set_xlabel("evaluations")
    axes.set_ylabel("share of the hypervolume of 15.423 [%]")
    axes.legend(fontsize="x-small", ncols=2)
    figure.savefig(PICTURE, dpi=130)


if __name__ == "__main__":
    main()
