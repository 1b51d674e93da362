"""What genes of joints and sections cost: `python -m benchmarks.geometry_cost [--designs N]`.

Random designs of `icub_geometry.toml` are evaluated with their gradients, as a search evaluates them, and as
many of the problem without `[[design.section]]` and `[[design.joint]]`, in turns in one process. Told are
processor seconds a design, means, and their ratio.
"""

from __future__ import annotations

import argparse
import re
import time

import msgspec
import numpy as np

from evodesign.evaluation.factory import evaluator_of
from evodesign.problem.build import build_problem
from evodesign.problem.source import read_source

GENES = ("[[design.section]]", "[[design.joint]]")


def main() -> None:
    """Print means and ratio."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--designs", type=int, default=30)
    count = parser.parse_args().designs
    source = read_source("icub-geometry")
    tables = re.split(r"(?m)^(?=\[)", source.text)
    plain = "".join(table for table in tables if not table.startswith(GENES))
    sources = source, msgspec.structs.replace(source, text=plain)
    evaluators = [evaluator_of(build_problem(each), 2) for each in sources]
    seconds = np.empty((count + 1, len(evaluators)))
    for number in range(count + 1):
        for place, evaluator in enumerate(evaluators):
            generator = np.random.default_rng(number)
            genome = tuple(generator.random(len(evaluator.problem.space.counts)).tolist())
            began = time.process_time()
            evaluator.assess_with_gradients(genome)
            seconds[number, place] = time.process_time() - began
    whole, without = seconds[1:].mean(axis=0)  # the first compiles
    print(f"{whole:.3f} s a design, {without:.3f} s without {' and '.join(GENES)}: {without / whole:.2f}")


if __name__ == "__main__":
    main()
