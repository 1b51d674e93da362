"""Writes docs/gallery.md and its pictures: `python -m docs.write_gallery [--jobs N] [NAME...]`.

Each entry is one search of 120 designs. Its run is kept in runs/gallery and is not searched again while it
is there; with names, only those are searched and drawn, and the page is written from all runs that are there.
The robots of other make come with the extra `robots`.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import evodesign
from evodesign.api.run import Run
from evodesign.problem.build import build_problem
from evodesign.records import Objective
from evodesign.report.page.marks import unscaled
from tests.robots import HUMANOIDS

DOCS = Path(__file__).parent
PAGE = DOCS / "gallery.md"
PICTURES = DOCS / "pictures" / "gallery"
RUNS = DOCS.parent / "runs" / "gallery"
COMMAND = [sys.executable, "-m", "evodesign"]
SEARCH = ["--algorithm", "surrogate", "--population", "8", "--evaluations", "120", "--seed", "1"]

HEAD = """# Gallery

Ten problems and their fronts, each from one search of 120 designs:

```
evodesign search PROBLEM {search}
```

This page and its pictures are written by `python -m docs.write_gallery`. A front of 120 designs shows what
a problem trades for what; it is not yet one to build from ([choosing.md](choosing.md#how-far-a-search-is)
says how far a search is). Each large dot is a robot that no other one dominates; the two
objectives that differ most along the front are the axes and the third is the colour. Small dots are
feasible robots that are dominated. The star is the unscaled robot, where it is feasible.
"""


@dataclass(frozen=True, slots=True)
class Entry:
    """A problem of the gallery.

    Args:
        name: of its picture and run.
        source: a problem's name, or a robot of `tests/robots.py` for which a problem is guessed.
        text: what the problem asks.
    """

    name: str
    source: str
    text: str

    @property
    def picture(self) -> Path:
        """Of its front."""
        return PICTURES / f"{self.name}.png"

    @property
    def lines(self) -> tuple[str, ...]:
        """The commands that a reader types for it, but for the options of the search."""
        if self.source in HUMANOIDS:
            robot = HUMANOIDS[self.source].name
            return f"evodesign init {robot} --to {self.name}.toml", f"evodesign search {self.name}.toml"
        return (f"evodesign search {self.source}",)


ENTRIES = (
    Entry("point_grasp", "point-grasp", "Point grasps: lengths and densities of the iCub."),
    Entry(
        "icub_materials",
        "icub-materials",
        "Each link of one of several [materials](materials.md), and its mass as an objective.",
    ),
    Entry(
        "icub_hardware",
        "icub-hardware",
        "[Actuators](hardware.md) sized by what lift, squat and one leg ask of them.",
    ),
    Entry(
        "shared_lifting",
        "shared-lifting",
        "Rigid grasps, four people, disturbances; the [allocation](sharing.md) of the load is a parameter.",
    ),
    Entry(
        "three_people_three_loads",
        "three-people-three-loads",
        "Three [people](people.md), three loads and three heights; the worst of the 27 cases counts.",
    ),
    Entry(
        "sartore2023_motors",
        "sartore2023-motors",
        "The setting of the sequel: one of three motors in arms, legs and torso.",
    ),
    Entry("g1", "g1", "Unitree's G1, a problem [guessed from its URDF](your_robot.md)."),
    Entry("talos", "talos", "PAL Robotics' Talos, guessed likewise."),
    Entry("icub", "icub", "The iCub 2.5 as its makers publish it, with meshes, guessed likewise."),
    Entry("romeo", "romeo", "Aldebaran's Romeo, guessed likewise."),
)


def searched(entry: Entry, jobs: int) -> Run:
    """The entry's run, searched where it is not there."""
    run, problem = RUNS / entry.name, entry.source
    if entry.source in HUMANOIDS:
        problem = str(RUNS / f"{entry.name}.toml")
        if not Path(problem).exists():
            RUNS.mkdir(parents=True, exist_ok=True)
            subprocess.run([*COMMAND, "init", str(HUMANOIDS[entry.source]), "--to", problem], check=True)
    if not run.exists():
        pool = ["--jobs", str(jobs), "--pool", "joblib" if jobs > 1 else "serial"]
        subprocess.run([*COMMAND, "search", problem, "--run", str(run), *SEARCH, *pool], check=True)
    return evodesign.open_run(run)


def label(objective: Objective) -> str:
    """As an axis says it."""
    unit = "" if objective.unit == "1" else f" [{objective.unit}]"
    return objective.name.replace("_", " ") + unit


def spread(run: Run, objective: Objective) -> float:
    """Interquartile range over the median's size: how much the front's designs differ in an objective."""
    low, middle, high = np.quantile(
        [each.objectives[objective.name] for each in run.front], (0.25, 0.5, 0.75)
    )
    return float((high - low) / (abs(middle) or 1.0))


def draw(run: Run, picture: Path) -> None:
    """The front of a run with two or three objectives."""
    first, second, *more = sorted(run.objectives, key=lambda each: -spread(run, each))
    values = {design.number: design.objectives for design in run.designs if design.feasible}
    on_front = [design.number for design in run.front]

    def column(numbers: Iterable[int], objective: Objective) -> list[float]:
        return [values[number][objective.name] for number in numbers]

    figure = Figure(figsize=(4.6, 3.1), layout="constrained")
    axes = figure.add_subplot(xlabel=label(first), ylabel=label(second))
    beaten = [number for number in values if number not in on_front]
    axes.scatter(column(beaten, first), column(beaten, second), s=8, c="#b8bec6")
    tints = column(on_front, more[0]) if more else "#1f4e79"
    dots = axes.scatter(
        column(on_front, first), column(on_front, second), s=30, c=tints, edgecolors="#333333"
    )
    if more:
        figure.colorbar(dots, label=label(more[0]))
    marks = unscaled(build_problem(run.log.header.problem), run.log.evaluations)
    stars = [mark.number for mark in marks if mark.number in values]
    axes.scatter(column(stars, first), column(stars, second), s=130, marker="*", c="#c0392b")
    picture.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(picture, dpi=110, metadata={"Software": None})


def section(entry: Entry, run: Run) -> str:
    """An entry of the page."""
    rows = [f"| {label(each)} | {each.sense} | {_range(run, each)} |" for each in run.objectives]
    feasible = sum(design.feasible for design in run.designs)
    return "\n".join(
        (
            f"\n## {run.name}\n",
            f"{entry.text} {len(run)} designs, {feasible} of them feasible, {len(run.front)} on the front.\n",
            f"![Front of {run.name}](pictures/gallery/{entry.picture.name})\n",
            "```",
            *entry.lines,
            "```\n",
            "| objective | sense | over the front |\n|---|---|---|",
            *rows,
            "",
        )
    )


def _range(run: Run, objective: Objective) -> str:
    values = [design.objectives[objective.name] for design in run.front]
    return f"{min(values):.4g} to {max(values):.4g}"


def main(arguments: Sequence[str] | None = None) -> None:
    """Search and draw, then write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", choices=[*(each.name for each in ENTRIES), []], metavar="NAME")
    parser.add_argument("--jobs", type=int, default=1)
    given = parser.parse_args(arguments)
    for entry in ENTRIES:
        if not given.names or entry.name in given.names:
            draw(searched(entry, given.jobs), entry.picture)
    there = [entry for entry in ENTRIES if (RUNS / entry.name).exists()]
    sections = (section(entry, evodesign.open_run(RUNS / entry.name)) for entry in there)
    PAGE.write_text(HEAD.format(search=" ".join(SEARCH)) + "".join(sections), encoding="utf-8")


if __name__ == "__main__":
    main()
