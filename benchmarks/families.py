"""How many kinds of robots does a search find, and how good is the best of each?

Kinds are 20 by 20 cells: length of legs (thigh + shank) by length of arms (upper arm + forearm), each a sum
of multipliers from 1.2 to 3.6; the best of a kind has the least robot torque. Every search goes over the
default problem with every seed but 1, by which the search's constants were chosen, in this process, without
a log. The QD score is the sum over filled cells of 60 N m minus the robot torque. "pyribs" is plain MAP-
Elites: its grid and its IsoLineEmitter at their defaults, from the same first generation. Results go to
benchmarks/results/families.json.

    python -m benchmarks.families [--evaluations 2000] [--seeds 3] [--only map-elites ...]
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from statistics import median

import msgspec
import numpy as np
from ribs.archives import GridArchive
from ribs.emitters import IsoLineEmitter

from evodesign.analysis.conditions import described
from evodesign.evaluation.factory import evaluator_of
from evodesign.problem.build import build_problem
from evodesign.problem.source import read_source
from evodesign.records import Descriptor, Evaluation, Genome, SearchSettings
from evodesign.runlog.header import header_of
from evodesign.searches.base import Outcome
from evodesign.searches.quasi_random import SobolStream, first_generation
from evodesign.searches.registry import make_search
from evodesign.session import search_outcome

HERE = Path(__file__).parent
PROBLEM = HERE.parent / "problems" / "point_grasp.toml"
RESULTS = HERE / "results" / "families.json"

GRID = tuple(
    Descriptor(name, 1.2, 3.6, 20)
    for name in ("length.thigh + length.shank", "length.upper_arm + length.forearm")
)
WORST = 60.0
POPULATION = 48
BUDGETS = (480, 960, 2000)
WITH_GRADIENTS = "map-elites, with gradients"
SEARCHES = ("map-elites", WITH_GRADIENTS, "pyribs", "cma-es", "nsga2", "random")


class PlainMapElites:
    """The grid and the emitter of pyribs by ask and tell."""

    def __init__(self, settings: SearchSettings) -> None:
        self._archive = GridArchive(
            solution_dim=settings.dimension,
            dims=[each.cells for each in GRID],
            ranges=[(each.lower, each.upper) for each in GRID],
            seed=settings.seed,
        )
        (seed,) = np.random.SeedSequence(settings.seed).spawn(1)
        self._first = np.array(first_generation(settings, SobolStream(settings.counts, seed)))
        bounds = [(0.0, 1.0)] * settings.dimension
        self._emitter = IsoLineEmitter(
            self._archive,
            initial_solutions=self._first,
            bounds=bounds,
            batch_size=settings.population,
            seed=settings.seed,
        )

    def ask(self) -> list[Genome]:
        """The next designs."""
        self._asked = self._emitter.ask()
        return [tuple(row) for row in self._asked.tolist()]

    def tell(self, outcomes: list[Outcome]) -> None:
        """What they were worth."""
        kept = [place for place, outcome in enumerate(outcomes) if outcome.feasible]
        self._archive.add(
            self._asked[kept],
            [-outcomes[place].objectives[0] for place in kept],
            [outcomes[place].descriptors for place in kept],
        )


def searched(name: str, seed: int, evaluations: int) -> dict[str, object]:
    """Coverage and score of a search with a seed, by number of evaluations."""
    problem = build_problem(read_source(PROBLEM))
    evaluator = evaluator_of(problem, 1)
    algorithm = {"pyribs": "random", WITH_GRADIENTS: "map-elites"}.get(name, name)
    settings = problem.settings(algorithm, POPULATION, seed)
    given = name == WITH_GRADIENTS
    settings = msgspec.structs.replace(settings, descriptors=GRID, gradients=True if given else msgspec.UNSET)
    header = header_of(problem, settings, evaluations)
    search = PlainMapElites(settings) if name == "pyribs" else make_search(settings)
    assess = evaluator.assess_with_gradients if given else evaluator.assess
    best: dict[tuple[int, ...], float] = {}
    filled: dict[str, int] = {}
    scores: dict[str, float] = {}
    count = 0
    while count < evaluations:
        outcomes = []
        for genome in search.ask():
            found = Evaluation(count, 0, genome, assess(genome).assessment, 0.0, "")
            outcome = search_outcome(header, found)
            outcomes.append(outcome)
            count += 1
            if outcome.feasible:
                cell = tuple(
                    min(
                        max(int((value - axis.lower) / (axis.upper - axis.lower) * axis.cells), 0),
                        axis.cells - 1,
                    )
                    for axis, value in zip(GRID, described(header, found), strict=True)
                )
                best[cell] = min(best.get(cell, np.inf), outcome.objectives[0])
            if count in BUDGETS and count <= evaluations:
                filled[str(count)] = len(best)
                scores[str(count)] = sum(max(0.0, WORST - torque) for torque in best.values())
        search.tell(outcomes)
    return {"search": name, "seed": seed, "filled": filled, "scores": scores}


def place(axis: Descriptor, value: float) -> int:
    """The cell along a descriptor."""
    return min(max(int((value - axis.lower) / (axis.upper - axis.lower) * axis.cells), 0), axis.cells - 1)


def main() -> None:
    """Run all searches, write and print."""
    parser = argparse.ArgumentParser(description="Kinds of robots that searches find.")
    for name, default in (("evaluations", 2000), ("seeds", 3)):
        parser.add_argument(f"--{name}", type=int, default=default)
    parser.add_argument("--only", nargs="*", default=SEARCHES)
    options = parser.parse_args()
    known = json.loads(RESULTS.read_text())["rows"] if RESULTS.exists() else []
    for seed in range(2, options.seeds + 2):
        for name in options.only:
            row = searched(name, seed, options.evaluations)
            known = [each for each in known if (each["search"], each["seed"]) != (name, seed)] + [row]
            result = {"problem": PROBLEM.name, "worst": WORST, "cells": 400, "rows": known}
            RESULTS.write_text(json.dumps(result, indent=2) + "\n")
            print(row, flush=True)
    print(table(known))


def table(rows: list[dict[str, object]]) -> str:
    """Medians over seeds, with the least and the largest."""
    heads = [f"{what} after {budget}" for budget in BUDGETS for what in ("kinds", "QD score")]
    lines = ["| search | seeds | " + " | ".join(heads) + " |", "|---|---|" + "---|" * len(heads)]
    for name in SEARCHES:
        own = [row for row in rows if row["search"] == name]
        cells = [
            f"{median(found):.0f} ({min(found):.0f} to {max(found):.0f})"
            for budget in BUDGETS
            for key in ("filled", "scores")
            if (found := [row[key][str(budget)] for row in own if str(budget) in row[key]])
        ]
        if own:
            lines.append(f"| {name} | {len(own)} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


if __name__ == "__main__":
    main()
