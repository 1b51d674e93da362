"""Are the searches better than random sampling where densities come from a catalogue?

As `search_quality`, on `problems/icub_materials.toml`: lengths within bounds, densities of materials. Every
evaluated design is compared with the catalogue first. Results go to benchmarks/results/catalogue_quality.json
and are printed as a Markdown table.

    python -m benchmarks.catalogue_quality [--evaluations 480] [--population 48] [--seeds 3] [--jobs 2]
"""

from __future__ import annotations

import sys

from benchmarks.search_quality import HERE, read_options, report, search_all
from evodesign.runlog.run import RunLog

PROBLEM = HERE.parent / "problems" / "icub_materials.toml"


def main() -> None:
    """Run all searches, hold their densities against the catalogue, compare, write and print."""
    options = read_options("Searches against random sampling, with densities from a catalogue.")
    runs = search_all(PROBLEM, options)
    for (algorithm, seed), run in runs.items():
        strangers = _strangers(run)
        if strangers:
            sys.exit(f"{algorithm}, seed {seed}: densities of no material: {strangers}")
    report(PROBLEM, runs, options, "catalogue_quality.json")


def _strangers(run: RunLog) -> list[float]:
    """Densities of evaluated designs that are none of their parameter's materials."""
    return [
        value
        for evaluation in run.evaluations
        for parameter in run.header.parameters
        if parameter.choices
        and (value := evaluation.assessment.design[parameter.name]) not in parameter.choices
    ]


if __name__ == "__main__":
    main()
