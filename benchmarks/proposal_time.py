"""What a proposal of the surrogate search costs, up to ten thousand evaluations.

A synthetic problem stands for a robot: 16 parameters, three conflicting objectives with gradients, a front
of hundreds of designs. Processor time of asking and telling is divided by the designs, in windows of 240
evaluations; a search is told generations of eight.

    python -m benchmarks.proposal_time [--evaluations 10000] [--without-gradients]
"""

from __future__ import annotations

import argparse
import time

import numpy as np

from evodesign.records import Genome, SearchSettings
from evodesign.searches.base import Outcome
from evodesign.searches.registry import make_search

DIMENSION, POPULATION, WINDOW = 16, 8, 240
ENDS = (480, 960, 2000, 5000, 10_000)


def outcome(genome: Genome, *, gradients: bool) -> Outcome:
    """Distances from three points, bent by waves, with their gradients."""
    point = np.array(genome)
    values, slopes = [], []
    for index in range(3):
        centre = np.where(np.arange(DIMENSION) % 3 == index, 0.9, 0.3)
        away, angle = point - centre, 6.0 * point + index
        values.append(float((away**2).sum() + 0.1 * np.sin(angle).sum()))
        slopes.append(tuple((2.0 * away + 0.6 * np.cos(angle)).tolist()))
    return Outcome(tuple(values), 0.0, gradients=tuple(slopes) if gradients else ())


def main() -> None:
    """Print milliseconds per evaluation in the window that ends at each number of evaluations."""
    parser = argparse.ArgumentParser(description="Processor time per proposal.")
    parser.add_argument("--evaluations", type=int, default=10_000)
    parser.add_argument("--without-gradients", action="store_true")
    options = parser.parse_args()
    search = make_search(SearchSettings("surrogate", DIMENSION, 3, POPULATION, 1))
    done, spent = 0, [(0, 0.0)]
    while done < options.evaluations:
        began = time.process_time()
        genomes = search.ask()
        asked = time.process_time() - began
        told = [outcome(genome, gradients=not options.without_gradients) for genome in genomes]
        began = time.process_time()
        search.tell(told)
        done += len(genomes)
        spent.append((done, spent[-1][1] + asked + time.process_time() - began))
        if done in ENDS:
            before = next(entry for entry in spent if entry[0] >= done - WINDOW)
            each = 1000.0 * (spent[-1][1] - before[1]) / (done - before[0])
            print(f"{done:6d} evaluations: {each:.1f} ms each", flush=True)


if __name__ == "__main__":
    main()
