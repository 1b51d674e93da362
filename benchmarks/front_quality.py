"""How much of the best known front does a search find with a budget?

Every algorithm searches `problems/point_grasp.toml` with every seed, in this process, without a log. What
counts is the share of the hypervolume of all fronts found so far together, 15.423, against the reference
point 30 N m, 7.2 N m, 1.2 m. Our searches begin with the designs that the problem names; pymoo's have their
own defaults. Processor time is that of proposing designs and of evaluating them, gradients included, per
evaluation. Results go to benchmarks/results/front_quality.json and are printed as a Markdown table.

    python -m benchmarks.front_quality [--evaluations 960] [--seeds 5] [--jobs 2] [--only surrogate ...]
"""

from __future__ import annotations

import argparse
import json
import time
import warnings
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from statistics import median

import moocore
import msgspec
import numpy as np
from pymoo.algorithms.moo.nsga3 import NSGA3
from pymoo.algorithms.moo.sms import SMSEMOA
from pymoo.config import Config
from pymoo.core.problem import Problem
from pymoo.core.termination import NoTermination
from pymoo.util.ref_dirs import get_reference_directions

from evodesign.problem.build import build_problem
from evodesign.problem.factory import evaluator_of
from evodesign.problem.source import read_source
from evodesign.records import Evaluation, SearchSettings
from evodesign.runlog.header import header_of
from evodesign.searches.base import Outcome
from evodesign.searches.ranking import with_outcomes
from evodesign.searches.registry import make_search
from evodesign.session import search_outcome

HERE = Path(__file__).parent
PROBLEM = HERE.parent / "problems" / "point_grasp.toml"
RESULTS = HERE / "results" / "front_quality.json"

REFERENCE = (30.0, 7.2, -1.2)
"""Robot torque [N m], human torque [N m], minus the reach [m]."""

BEST_KNOWN = 15.423
BUDGETS = (120, 240, 480, 960, 1920)

POPULATIONS = {"surrogate": 8, "surrogate, told the reference": 8, "nsga2": 48, "cma-es": 48, "random": 48}
PYMOO = ("pymoo NSGA-III", "pymoo SMS-EMOA")
ALGORITHMS = (*POPULATIONS, *PYMOO)


@dataclass(frozen=True, slots=True)
class Row:
    """One search: shares [%] by number of evaluations, and milliseconds per evaluation."""

    algorithm: str
    seed: int
    shares: dict[int, float]
    proposing_ms: float
    evaluating_ms: float


class PymooSearch:
    """An algorithm of pymoo by ask and tell, with its defaults."""

    def __init__(self, name: str, settings: SearchSettings) -> None:
        Config.warnings["not_compiled"] = False
        directions = get_reference_directions("das-dennis", settings.objectives, n_partitions=12)
        self._algorithm = NSGA3(directions) if name == "pymoo NSGA-III" else SMSEMOA()
        problem = Problem(settings.dimension, settings.objectives, n_ieq_constr=1, xl=0.0, xu=1.0)
        self._algorithm.setup(problem, termination=NoTermination(), seed=settings.seed)
        self._objectives = settings.objectives
        self._asked = self._algorithm.ask()

    def ask(self) -> list[tuple[float, ...]]:
        """The next designs."""
        return [tuple(row) for row in self._asked.get("X").tolist()]

    def tell(self, outcomes: list[Outcome]) -> None:
        """What they were worth."""
        with_outcomes(self._asked, outcomes, self._objectives)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # comparisons of objectives that do not exist
            self._algorithm.tell(infills=self._asked)
            self._asked = self._algorithm.ask()


def main() -> None:
    """Run all searches, write and print."""
    parser = argparse.ArgumentParser(description="Shares of the best known hypervolume.")
    for name, default in (("evaluations", 960), ("seeds", 5), ("jobs", 2)):
        parser.add_argument(f"--{name}", type=int, default=default)
    parser.add_argument("--only", nargs="*", default=ALGORITHMS)
    options = parser.parse_args()
    keys = [(name, seed) for seed in range(1, options.seeds + 1) for name in options.only]
    known = json.loads(RESULTS.read_text())["rows"] if RESULTS.exists() else []
    kept = [row for row in known if (row["algorithm"], row["seed"]) not in keys]
    with ProcessPoolExecutor(options.jobs, mp_context=get_context("spawn")) as pool:
        for row in pool.map(partial(searched, evaluations=options.evaluations), keys):
            kept.append(asdict(row) | {"shares": {str(key): share for key, share in row.shares.items()}})
            _write(kept)
            print(row, flush=True)
    print(table(kept))


def searched(key: tuple[str, int], evaluations: int) -> Row:
    """One search of an algorithm with a seed."""
    name, seed = key
    problem = build_problem(read_source(PROBLEM))
    evaluator = evaluator_of(problem, 1)
    algorithm, _, told = name.partition(",")
    ours = algorithm in POPULATIONS
    settings = problem.settings(algorithm if ours else "random", POPULATIONS.get(name), seed)
    if told:
        settings = msgspec.structs.replace(settings, reference=REFERENCE)
    header = header_of(problem, settings, evaluations)
    assess = evaluator.assess_with_gradients if settings.with_gradients else evaluator.assess
    assess((0.5,) * settings.dimension)  # nothing is compiled or built while time is taken
    clocks = {"proposing": 0.0, "evaluating": 0.0}

    def timed(what: str, call: Callable[[], object]) -> object:
        began = time.process_time()
        found = call()
        clocks[what] += time.process_time() - began
        return found

    search = timed("proposing", lambda: make_search(settings) if ours else PymooSearch(name, settings))
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
    return Row(name, seed, shares, each["proposing"], each["evaluating"])


def share_of(values: list[tuple[float, ...]]) -> float:
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
            cells.append(f"{median(found):.1f} ({min(found):.1f} to {max(found):.1f})" if found else "")
        times = [f"{median(row[key] for row in own):.1f}" for key in ("proposing_ms", "evaluating_ms")]
        lines.append(f"| {name} | {len(own)} | " + " | ".join([*cells, *times]) + " |")
    return "\n".join(lines)


def _write(rows: list[dict[str, object]]) -> None:
    result = {"problem": PROBLEM.name, "reference": REFERENCE, "best_known": BEST_KNOWN, "rows": rows}
    RESULTS.write_text(json.dumps(result, indent=2) + "\n")


if __name__ == "__main__":
    main()
