"""Several runs side by side: on a shared reference, after equally many evaluations, seeds as samples.

Runs with the same objectives can be compared, also of different problems. Those of one problem, algorithm and
population are one search with several seeds. The reference is somewhat worse than all feasible evaluations of
all these runs; hypervolumes also come as shares of that which all runs together dominate, without a unit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import msgspec

from evodesign.analysis.decision_making import knees
from evodesign.analysis.front import front, to_minimise
from evodesign.analysis.hypervolume import Curve, best, curve, hypervolume, reference_point
from evodesign.analysis.seed_statistics import AttainmentSurface, RankTest, attainment_surfaces, rank_tests
from evodesign.records import Evaluation, Objective, RunHeader
from evodesign.runlog.run import RunLog

MOST_KNEES = 5
"""Knees of the common front that are named."""


@dataclass(frozen=True, slots=True)
class Compared:
    """One run of a comparison.

    Args:
        run: as it was read.
        search: name of its search.
        front: of its first evaluations, as many as every run has: the counted ones.
        hypervolume: of the counted ones; None for a run without any, or if no run has a feasible design.
        share: of the hypervolume that all counted ones together dominate; None likewise.
        best: best counted natural value of each objective.
        curve: its history, to its own end.
    """

    run: RunLog
    search: str
    front: tuple[Evaluation, ...]
    hypervolume: float | None
    share: float | None
    best: dict[str, float]
    curve: Curve | None


@dataclass(frozen=True, slots=True)
class Attainment:
    """Attainment surfaces of one search in two objectives."""

    search: str
    objectives: tuple[Objective, Objective]
    surfaces: tuple[AttainmentSurface, ...]


@dataclass(frozen=True, slots=True)
class Comparison:
    """Runs with the same objectives.

    Args:
        objectives: of all of them.
        reference: shared; None if no run has a feasible design.
        evaluations: how many of each run were counted; a run without any does not hold the others back.
        runs: in the order given.
        tests: between the searches' hypervolumes.
        attainments: of each search in each pair of objectives.
        notes: a sentence for everything that limits the comparison.
    """

    objectives: tuple[Objective, ...]
    reference: dict[str, float] | None
    evaluations: int
    runs: tuple[Compared, ...]
    tests: tuple[RankTest, ...]
    attainments: tuple[Attainment, ...]
    notes: tuple[str, ...]

    @property
    def searches(self) -> dict[str, tuple[Compared, ...]]:
        """The runs by search, in the order given."""
        return _by_search(self.runs)


def compare(runs: Sequence[RunLog]) -> tuple[Comparison, ...]:
    """Comparisons of runs, one for each set of objectives, in the order given."""
    kinds = dict.fromkeys(run.header.objectives for run in runs)
    names = _names([run.header for run in runs])
    return tuple(
        _comparison(
            objectives,
            [
                (run, name)
                for run, name in zip(runs, names, strict=True)
                if run.header.objectives == objectives
            ],
        )
        for objectives in kinds
    )


def search_name(header: RunHeader) -> str:
    """A search's name: its algorithm and population."""
    return f"{header.search.algorithm} {header.search.population}"


def _names(headers: Sequence[RunHeader]) -> list[str]:
    """A name for each run's search; runs share it when all but seed and budget agree."""
    kinds = [_kind(header) for header in headers]
    several = len({header.problem_name for header in headers}) > 1
    plain = [f"{h.problem_name}: {search_name(h)}" if several else search_name(h) for h in headers]
    variants: dict[str, list[RunHeader]] = {}
    names = []
    for kind, name in zip(kinds, plain, strict=True):
        known = variants.setdefault(name, [])
        if kind not in known:
            known.append(kind)
        place = known.index(kind)
        names.append(name if place == 0 else f"{name} ({place + 1})")
    return names


def _kind(header: RunHeader) -> RunHeader:
    """What makes a search: a header without seed, budget and what differs from session to session."""
    return msgspec.structs.replace(
        header,
        problem=msgspec.structs.replace(header.problem, path=""),
        search=msgspec.structs.replace(header.search, seed=0),
        budget=0,
        versions={},
        git=None,
        started="",
    )


def _comparison(objectives: tuple[Objective, ...], named: Sequence[tuple[RunLog, str]]) -> Comparison:
    count = min((len(run.evaluations) for run, _ in named if run.evaluations), default=0)
    everything = [evaluation for run, _ in named for evaluation in run.evaluations]
    reference = reference_point(objectives, everything)
    fronts = [front(objectives, run.evaluations[:count]) for run, _ in named]
    union = [evaluation for members in fronts for evaluation in members]
    whole = None if reference is None else hypervolume(objectives, union, reference)
    runs = tuple(
        _compared(objectives, run, name, members, reference, whole)
        for (run, name), members in zip(named, fronts, strict=True)
    )
    searches = _by_search(runs)
    samples = {name: _figures(members) for name, members in searches.items()}
    return Comparison(
        objectives=objectives,
        reference=reference,
        evaluations=count,
        runs=runs,
        tests=rank_tests(samples) if reference is not None else (),
        attainments=tuple(
            Attainment(name, pair, attainment_surfaces(pair, [each.front for each in members]))
            for pair in combinations(objectives, 2)
            for name, members in searches.items()
        ),
        notes=_notes(runs, count),
    )


def _compared(
    objectives: tuple[Objective, ...],
    run: RunLog,
    name: str,
    members: tuple[Evaluation, ...],
    reference: dict[str, float] | None,
    whole: float | None,
) -> Compared:
    volume = None
    if reference is not None and run.evaluations:
        volume = hypervolume(objectives, members, reference)
    return Compared(
        run=run,
        search=name,
        front=members,
        hypervolume=volume,
        share=volume / whole if whole and volume is not None else None,
        best=best(objectives, members),
        curve=None if reference is None else curve(objectives, run.evaluations, reference),
    )


def _by_search(runs: Sequence[Compared]) -> dict[str, tuple[Compared, ...]]:
    return {
        name: tuple(each for each in runs if each.search == name)
        for name in dict.fromkeys(each.search for each in runs)
    }


def _figures(members: Sequence[Compared]) -> list[float]:
    """Hypervolumes of a search, one per seed."""
    by_seed: dict[int, float] = {}
    for each in members:
        if each.hypervolume is not None:
            by_seed.setdefault(each.run.header.search.seed, each.hypervolume)
    return list(by_seed.values())


def _notes(runs: Sequence[Compared], count: int) -> tuple[str, ...]:
    notes = [
        f"{each.run.directory}: holds no evaluation and is left out"
        for each in runs
        if not each.run.evaluations
    ]
    longer = [each for each in runs if len(each.run.evaluations) > count]
    if longer:
        notes.append(
            f"only the first {count} evaluations of each run are compared: "
            f"{len(longer)} of {len(runs)} have more"
        )
    seen: set[tuple[str, int]] = set()
    for each in (each for each in runs if each.run.evaluations):
        key = (each.search, each.run.header.search.seed)
        if key in seen:
            notes.append(f"{each.run.directory}: seed {key[1]} of {key[0]} came before, and counts once")
        seen.add(key)
    return tuple(notes)


@dataclass(frozen=True, slots=True)
class BestDesign:
    """A design to look at first.

    Args:
        reason: what it is best at, in words.
        run: that found it.
        evaluation: its number is that of its run.
    """

    reason: str
    run: Compared
    evaluation: Evaluation


def best_designs(comparison: Comparison) -> tuple[BestDesign, ...]:
    """The best designs of a comparison's runs, after the evaluations that are counted."""
    found = [(run, evaluation) for run in comparison.runs for evaluation in run.front]
    if not found:
        return ()
    numbered = [
        msgspec.structs.replace(evaluation, number=place) for place, (_, evaluation) in enumerate(found)
    ]
    objectives = comparison.objectives
    places = [(f"best {each.name}", _best_in(each, numbered)) for each in objectives]
    common = front(objectives, numbered)
    places += [("knee", knee.number) for knee in knees(objectives, common)[:MOST_KNEES]]
    return tuple(BestDesign(reason, *found[place]) for reason, place in places)


def _best_in(objective: Objective, numbered: Sequence[Evaluation]) -> int:
    """Place of the design that is best in an objective."""
    values = {each.number: each.assessment.objectives[objective.name] for each in numbered}
    return min(values, key=lambda place: to_minimise(objective, values[place]))
