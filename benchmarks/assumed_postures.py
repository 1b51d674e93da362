"""How much a front depends on postures that nobody measured.

What is assumed of postures is moved by one standard deviation at a time, and designs of a run's front are
evaluated anew beside the people who result. Results go to benchmarks/results/assumed_postures.json, and a
table is printed: changes of the mean over designs, pairs of designs that change their order by the person's
torque, and designs that another one of them dominates.

    between rows: mean(0.4885 H) = the mean of both neighbouring rows +- s, of one feature
    interpolation: people are upright from 0.4885 H, or stooped up to there
    assumed rows: mean +- s of one feature in all rows whose support is "assumption"
    women: mean +- s of one feature of trunk or legs, at all heights, for women alone

The numbers by which a person differs from the mean are a parameter of programs
(`posture.terms.measured_posture`), so that each group is one program: its directions L say what the parameter
moves.

    python -m benchmarks.assumed_postures RUN [--designs 40] [--heights 0.75 0.9]
"""

from __future__ import annotations

import argparse
import json
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray
from scipy.stats import kendalltau

from benchmarks.inner_problem import HERE
from evodesign.analysis.front import front, minimised
from evodesign.evaluation.evaluate import Evaluator
from evodesign.evaluation.factory import cached_precomputed
from evodesign.human.measured_posture import (
    ASSUMPTION,
    FEATURES,
    MEAN_PERSON,
    Gaussians,
    posture_rows,
    unmeasured_heights,
)
from evodesign.mechanics.scene import Scene
from evodesign.nlp.solver import SolverCache
from evodesign.pool.registry import make_pool
from evodesign.posture.precompute.precomputed import Precomputed
from evodesign.posture.seeking.start_portfolio import StartPortfolio
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.records import Assessment, Case, Hold, ProblemSource, Status, Task
from evodesign.runlog.run import read_run

MORE = ("l5s1_moment", "back_compression")
"""Quantities beside the problem's objectives."""

QUANTITIES = ("human_torque", "robot_torque", *MORE)
OF_WOMEN = ("trunk_low", "trunk_up", "knee", "shank")
COUNTS = ("dominated", "unsolved")
GROUPS = ("between rows", "interpolation", "assumed rows", "women")
"""In the order of the table."""

Array = NDArray[np.float64]
Rows = Sequence[Mapping[str, float]]


@dataclass(frozen=True, slots=True)
class Directed(Gaussians):
    """Gaussians of which a person's numbers move only what is assumed.

    Args:
        directions: L at each knot, as rows, in place of the root of the covariance.
    """

    directions: tuple[tuple[tuple[float, ...], ...], ...]

    @property
    def roots(self) -> Array:
        """L at each knot, shape (knots, features, features)."""
        return np.array(self.directions)


@dataclass(frozen=True, slots=True)
class Variant:
    """People who differ from the mean in what is assumed.

    Args:
        group: what is moved.
        name: of the variant.
        given: the Gaussians of people who hold a load.
        drawn: by which numbers they differ.
        women: whether women alone do.
    """

    group: str
    name: str
    given: Gaussians
    drawn: tuple[float, ...] = MEAN_PERSON
    women: bool = False

    def scene(self, scene: Scene) -> Scene:
        """A scene with one of these people."""
        measured = scene.human.measured
        if measured is None:
            raise SystemExit(f"{scene.label}: wanted a person with a measured posture")
        drawn = MEAN_PERSON if self.women and "female" not in scene.human.label else self.drawn
        return scene.with_agents(
            replace(scene.human, measured=replace(measured, hold=self.given, drawn=drawn))
        )


def with_knot(given: Gaussians, eta: float, like: int | None = None) -> Gaussians:
    """The same with one more knot: between its neighbours, or equal to the knot of a number."""
    place = int(np.searchsorted(given.knots, eta))
    low, high = given.knots[place - 1 : place + 1]
    share = (eta - low) / (high - low)
    found = []
    for values in (np.array(given.means), np.array(given.precisions)):
        between = (1.0 - share) * values[place - 1] + share * values[place]
        new = between if like is None else values[like]
        found.append(np.insert(values, place, new, axis=0).tolist())
    means, precisions = found
    return Gaussians(
        (*given.knots[:place], eta, *given.knots[place:]),
        tuple(map(tuple, means)),
        tuple(tuple(map(tuple, each)) for each in precisions),
    )


def directed(given: Gaussians, deviations: Mapping[float, Mapping[str, float]]) -> Directed:
    """Directions that move features [their units] at some knots alone."""
    found = np.zeros((len(given.knots), len(FEATURES), len(FEATURES)))
    for eta, by_name in deviations.items():
        for name, deviation in by_name.items():
            place = FEATURES.index(name)
            found[given.knots.index(eta), place, place] = deviation
    rows = tuple(tuple(map(tuple, each)) for each in found.tolist())
    return Directed(given.knots, given.means, given.precisions, rows)


def variants(given: Gaussians) -> list[Variant]:
    """The mean people, then all variants, those of one program in a row."""
    low, high = unmeasured_heights()
    middle = (low + high) / 2.0
    places = [given.knots.index(eta) for eta in (low, high)]
    deviations = np.sqrt([np.diag(np.linalg.inv(np.array(given.precisions[place]))) for place in places])
    gap = directed(
        with_knot(given, middle),
        {middle: dict(zip(FEATURES, deviations.mean(axis=0).tolist(), strict=True))},
    )
    assumed: dict[float, dict[str, float]] = {}
    for row in posture_rows():
        if row.support == ASSUMPTION and row.task in ("both", "hold") and not math.isnan(row.eta):
            unit = 1.0 if row.quantity == "sideways" else math.radians(1.0)
            assumed.setdefault(row.eta, {})[row.quantity] = unit * row.deviation
    names = [name for name in FEATURES if any(name in by_name for by_name in assumed.values())]
    found = [Variant("", "mean people", given)]
    found += each_way("women", given, OF_WOMEN, women=True)
    found += each_way("between rows", gap, FEATURES)
    found += each_way("assumed rows", directed(given, assumed), names)
    upright, stooped = (with_knot(given, middle, like) for like in reversed(places))
    found.append(Variant("interpolation", f"upright from {middle:.3f} H", upright))
    found.append(Variant("interpolation", f"stooped up to {middle:.3f} H", stooped))
    return found


def each_way(group: str, given: Gaussians, names: Iterable[str], *, women: bool = False) -> list[Variant]:
    """One feature after the other, one deviation up and down."""
    return [
        Variant(
            group,
            f"{name} {sign:+.0f} s",
            given,
            tuple(sign if each == name else 0.0 for each in FEATURES),
            women,
        )
        for name in names
        for sign in (1.0, -1.0)
    ]


def elsewhere(known: Precomputed, tasks: Sequence[Hold]) -> Precomputed:
    """What is known of a problem, for other heights: a solve begins at the starts of the nearest one."""

    def moved(by_case: Mapping[Case, StartPortfolio]) -> dict[Case, StartPortfolio]:
        heights = {case: case.task.height_m for case in by_case if isinstance(case.task, Hold)}
        found = {}
        for pair in {case.pair for case in heights}:
            own = [case for case in heights if case.pair == pair]
            for task in tasks:
                nearest = min(own, key=lambda case: abs(heights[case] - task.height_m))
                found[Case(person=pair[0], payload=pair[1], task=task)] = by_case[nearest]
        return found

    return replace(known, postures=moved(known.postures))


def evaluate(
    problem: DesignProblem, known: Precomputed, designs: Sequence[Sequence[float]]
) -> list[tuple[Variant, list[Assessment]]]:
    """All designs beside all variants of people."""
    measured = problem.scene.human.measured
    if measured is None:
        raise SystemExit(f"{problem.name}: wanted people with measured postures")
    found, solvers, latest = [], SolverCache(), ""
    for variant in variants(measured.hold):
        if variant.group != latest:
            solvers, latest = SolverCache(), variant.group
        scenes = tuple(map(variant.scene, problem.scenes))
        evaluator = Evaluator(replace(problem, scenes=scenes), known, solvers)
        found.append((variant, [evaluator.assess_values(values).assessment for values in designs]))
        print(f"{variant.group or 'as given'}: {variant.name}", flush=True)
    return found


def compared(
    problem: DesignProblem, before: Sequence[Assessment], now: Sequence[Assessment]
) -> dict[str, Any]:
    """What a variant of people changes, over designs that are solved with both."""
    both = [
        (a.objectives, b.objectives)
        for a, b in zip(before, now, strict=True)
        if a.status is b.status is Status.SOLVED
    ]
    changes = {name: np.array([b[name] / a[name] - 1.0 for a, b in both]) for name in QUANTITIES}
    return {
        "unsolved": sum(each.status is not Status.SOLVED for each in now),
        "change": {name: round(float(change.mean()), 4) for name, change in changes.items()},
        "largest": {name: round(float(np.abs(change).max()), 4) for name, change in changes.items()},
        "pairs_swapped": {
            name: round(
                (1.0 - kendalltau(*zip(*((a[name], b[name]) for a, b in both), strict=True)).statistic) / 2.0,
                4,
            )
            for name in QUANTITIES
        },
        "dominated": dominated_designs(problem, now),
    }


def dominated_designs(problem: DesignProblem, found: Sequence[Assessment]) -> int:
    """How many designs another of them dominates in the objectives of the problem itself."""
    mine = [each for each in problem.objectives if each.name not in MORE]
    values = [minimised(mine, each) for each in found if each.status is Status.SOLVED]
    return sum(dominated(np.array(values)))


def dominated(values: Array) -> list[bool]:
    """Which rows another row is nowhere worse and somewhere better than; all are to be made small."""
    return [bool(np.any(np.all(values <= row, axis=1) & np.any(values < row, axis=1))) for row in values]


def with_more(source: ProblemSource) -> ProblemSource:
    """The problem with more objectives, so that their values are computed."""
    key = "minimise = ["
    added = key + "".join(f'"{name}", ' for name in MORE)
    return msgspec.structs.replace(source, text=source.text.replace(key, added, 1))


def palms(scene: Scene, tasks: Iterable[Task]) -> list[float]:
    """Heights of the person's palms in holds, over stature."""
    stature = scene.human.measured.stature if scene.human.measured else math.nan
    grasp = scene.payload.grasp_point(scene.human, scene.human.hands[0])[2]
    return [(task.height_m + grasp) / stature for task in tasks if isinstance(task, Hold)]


def table(rows: Sequence[tuple[Variant, dict[str, Any]]]) -> str:
    """By group: the lowest and highest of each change of a mean and of each count, and most pairs swapped."""
    lines = [
        "| what is moved | variants | "
        + " | ".join(QUANTITIES)
        + " | pairs in other order | dominated | unsolved |",
        "|---" * (len(QUANTITIES) + 5) + "|",
    ]
    for group in GROUPS:
        own = [row for variant, row in rows if variant.group == group]
        spans = [[row["change"][name] for row in own] for name in QUANTITIES]
        cells = [f"{min(span):+.1%} to {max(span):+.1%}" for span in spans]
        swapped = max(row["pairs_swapped"]["human_torque"] for row in own)
        worst = [f"{min(row[key] for row in own)} to {max(row[key] for row in own)}" for key in COUNTS]
        lines.append("| " + " | ".join([group, str(len(own)), *cells, f"{swapped:.1%}", *worst]) + " |")
    return "\n".join(lines)


def main() -> None:
    """Evaluate, write and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("run", type=Path)
    parser.add_argument("--designs", type=int, default=40)
    parser.add_argument("--heights", type=float, nargs="+", help="in place of those of the run's problem [m]")
    options = parser.parse_args()
    run = read_run(options.run)
    problem = build_problem(with_more(run.header.problem))
    with make_pool("joblib", 1) as pool:
        known = cached_precomputed(problem, pool)
    if options.heights:
        holds = tuple(Hold(height_m=height) for height in options.heights)
        problem, known = replace(problem, tasks=holds), elsewhere(known, holds)
    best = sorted(
        front(run.header.objectives, run.evaluations),
        key=lambda each: each.assessment.objectives["robot_torque"],
    )
    places = np.unique(np.linspace(0, len(best) - 1, options.designs).round().astype(int))
    names = [parameter.name for parameter in problem.space.parameters]
    designs = [[best[place].assessment.design[name] for name in names] for place in places]
    (_, before), *others = evaluate(problem, known, designs)
    rows = [(variant, compared(problem, before, now)) for variant, now in others]
    result = {
        "designs": len(designs),
        "palms_over_stature": {
            scene.human.label: [round(eta, 3) for eta in palms(scene, problem.tasks)]
            for scene in problem.scenes
        },
        "mean_people": {
            name: [round(each.objectives[name], 3) for each in before if name in each.objectives]
            for name in QUANTITIES
        },
        "dominated_with_mean_people": dominated_designs(problem, before),
        "variants": [{"group": v.group, "name": v.name, **row} for v, row in rows],
    }
    target = HERE / "results" / "assumed_postures.json"
    figures = json.loads(target.read_text()) if target.is_file() else {}
    figures[", ".join(task.name for task in problem.tasks)] = result
    target.write_text(json.dumps(figures, indent=2) + "\n")
    for scene in problem.scenes:
        print(scene.human.label, *(f"{eta:.3f}" for eta in palms(scene, problem.tasks)))
    print(f"{len(designs)} designs, {result['dominated_with_mean_people']} dominated with mean people")
    print(table(rows))


if __name__ == "__main__":
    main()
