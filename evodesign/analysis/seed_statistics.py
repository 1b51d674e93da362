"""What the seeds of a search tell together: surfaces that a share attains, and whether searches differ.

A point of the objective space is attained by a run when a design of the run is nowhere worse. The surface of
a level of 50 % bounds what at least half of the seeds attain: the median front of a search that depends on
chance. The 100 % surface bounds what every seed attains, the lowest level what any one does. Surfaces are
drawn for two objectives at a time, whatever the others are.

A search's figure (its hypervolume) depends on the seed, so that searches are compared over several seeds, by
ranks: no distribution is assumed.

- Two searches: Mann and Whitney's U, two-sided; its p exact when no two figures are equal, else by the normal
  approximation with tie correction. The effect is the share of pairs of seeds in which the first is better,
  equal ones counting half (Vargha and Delaney's A).
- Three searches or more: every pair as above, its p corrected by Holm's method for testing many pairs; and
  before them all Kruskal and Wallis' H, from five seeds each on, where the chi-square approximation holds.

With n and m seeds the exact p of two searches is never below 2 / C(n + m, n), times the number of pairs when
it is corrected. Where that is above 5 %, no figures whatever would be evidence, and no test is made: a
sentence says how many seeds it takes.

Source: Grunert da Fonseca, Fonseca and Hall 2001, computed by moocore (Fonseca et al. 2011);
Mann and Whitney 1947; Kruskal and Wallis 1952; Holm 1979; Vargha and Delaney 2000.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import moocore
import numpy as np
from scipy.stats import kruskal, mannwhitneyu

from evodesign.analysis.front import comparable, front, to_minimise
from evodesign.records import Evaluation, Objective

LEVEL = 0.05
"""Chance of seeing a difference where there is none that is thought bearable."""

FEWEST_FOR_CHI_SQUARE = 5


@dataclass(frozen=True, slots=True)
class AttainmentSurface:
    """Corners of the staircase that a share of the runs attains.

    Args:
        share: of the runs, from 0 (exclusive) to 1.
        corners: natural values of the two objectives, in rising order of the first.
    """

    share: float
    corners: tuple[tuple[float, float], ...]


def attainment_surfaces(
    pair: tuple[Objective, Objective], runs: Sequence[Sequence[Evaluation]]
) -> tuple[AttainmentSurface, ...]:
    """Surfaces that one run, half of the runs and all of them attain; equal shares once.

    Args:
        pair: the two objectives.
        runs: the front of each run, in all of its objectives; a run without one attains nothing.
    Returns:
        None is empty: a surface that nothing attains is left out.
    """
    fronts = [[values for _, values in comparable(pair, front(pair, run))] for run in runs]
    filled = [points for points in fronts if points]
    if not filled:
        return ()
    counts = sorted({1, -(-len(runs) // 2), len(runs)})
    points = np.array([point for run in filled for point in run])
    sets = np.repeat(np.arange(len(filled)), [len(run) for run in filled])
    surfaces = []
    for count in counts:
        if count <= len(filled):
            corners = moocore.eaf(points, sets, percentiles=[100.0 * count / len(filled)])[:, :2]
            surfaces.append(AttainmentSurface(count / len(runs), _natural(pair, corners.tolist())))
    return tuple(surfaces)


def _natural(
    pair: tuple[Objective, Objective], corners: Sequence[Sequence[float]]
) -> tuple[tuple[float, float], ...]:
    turned = [(to_minimise(pair[0], first), to_minimise(pair[1], second)) for first, second in corners]
    return tuple(sorted(turned))


@dataclass(frozen=True, slots=True)
class RankTest:
    """One test, made or not.

    Args:
        samples: names of what was compared.
        name: of the test, with how its p was found.
        p: corrected if there were several pairs; None if the test was not made.
        effect: how often the first is better than the second; None for more than two.
        reason: why it was not made; empty if it was.
    """

    samples: tuple[str, ...]
    name: str
    p: float | None
    effect: float | None
    reason: str = ""

    @property
    def finding(self) -> str:
        """What it says, in words."""
        if self.p is None:
            return f"not tested: {self.reason}"
        if self.p > LEVEL:
            return "no difference is shown"
        if self.effect is None:
            return "they differ"
        better = self.samples[0] if self.effect > 0.5 else self.samples[1]
        return f"{better} is better"


def rank_tests(samples: Mapping[str, Sequence[float]]) -> tuple[RankTest, ...]:
    """Tests between samples of figures of which more is better.

    Args:
        samples: one figure per seed, by the name of the search.
    """
    names = list(samples)
    count = math.comb(len(names), 2)
    pairs = [_pair((a, b), samples[a], samples[b], count) for a, b in itertools.combinations(names, 2)]
    overall = (_overall(samples),) if len(names) > 2 else ()
    return (*overall, *_corrected(pairs))


def _pair(names: tuple[str, str], first: Sequence[float], second: Sequence[float], pairs: int) -> RankTest:
    tied = len({*first, *second}) < len(first) + len(second)
    name = f"Mann-Whitney U, two-sided, {'normal approximation' if tied else 'exact'}"
    reason = _why_not(len(first), len(second), pairs)
    if len({*first, *second}) < 2:
        reason = reason or "all figures are equal"
    if reason:
        return RankTest(names, name, None, None, reason)
    found = mannwhitneyu(first, second, alternative="two-sided", method="asymptotic" if tied else "exact")
    effect = float(found.statistic) / (len(first) * len(second))
    return RankTest(names, name, float(found.pvalue), effect)


def _why_not(first: int, second: int, pairs: int) -> str:
    """Why two samples of these sizes cannot be compared; empty if they can."""
    least = _least_p(first, second, pairs)
    if least <= LEVEL:
        return ""
    needed = next(count for count in itertools.count(2) if _least_p(count, count, pairs) <= LEVEL)
    return (
        f"with {first} and {second} seeds p cannot fall below {min(least, 1.0):.2g}, whatever the figures; "
        f"{needed} seeds each are needed"
    )


def _least_p(first: int, second: int, pairs: int) -> float:
    return pairs * 2.0 / math.comb(first + second, first)


def _overall(samples: Mapping[str, Sequence[float]]) -> RankTest:
    name = "Kruskal-Wallis H, chi-square approximation"
    fewest = min(len(figures) for figures in samples.values())
    if fewest < FEWEST_FOR_CHI_SQUARE:
        reason = f"the approximation needs {FEWEST_FOR_CHI_SQUARE} seeds each, and a search has {fewest}"
        return RankTest(tuple(samples), name, None, None, reason)
    if len({figure for figures in samples.values() for figure in figures}) < 2:
        return RankTest(tuple(samples), name, None, None, "all figures are equal")
    return RankTest(tuple(samples), name, float(kruskal(*samples.values()).pvalue), None)


def _corrected(pairs: Sequence[RankTest]) -> tuple[RankTest, ...]:
    """Holm's correction: the least p times the number of tests, the next times one less, never falling."""
    made = sorted((pair.p, place) for place, pair in enumerate(pairs) if pair.p is not None)
    raised = np.maximum.accumulate([p * (len(made) - rank) for rank, (p, _) in enumerate(made)])
    corrected = list(pairs)
    note = ", Holm's correction" if len(made) > 1 else ""
    for value, (_, place) in zip(raised.tolist(), made, strict=True):
        pair = pairs[place]
        corrected[place] = RankTest(pair.samples, pair.name + note, min(value, 1.0), pair.effect)
    return tuple(corrected)
