"""Libraries of optima: does a design begin at those of the designs most like it, and is what is told true?"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from evodesign.nlp.landscape import Landscape, cost_of, spread_designs
from evodesign.nlp.program import Start
from evodesign.nlp.start_library import Gathering, start_library
from evodesign.nlp.start_portfolio import Coverage, Neighbourhood, StartPortfolio
from tests.nlp.test_start_training import WELLS, best, landscape

GATHERING = Gathering(designs=32, begun=8, random=12, neighbours=8, rounds=4, tried=8)


def designs(count: int = 200) -> Iterator[tuple[float, ...]]:
    """Between -3 and 3, no two of them equally far from a third."""
    return spread_designs(1, lambda point: (6.0 * point[0] ** 1.1 - 3.0,), lambda design: True, count)


@pytest.fixture(scope="module")
def library() -> StartPortfolio:
    """Of the landscape of four wells."""
    return start_library(landscape(), designs(), GATHERING)


def depth(design: float, start: Start) -> float:
    """Of the well that a start is in."""
    well = min(WELLS, key=lambda well: abs(well - start["robot.joints"][0]))
    return -1.0 - float(np.cos(2.0 * np.pi * (well - design) / 6.0))


def test_nearly_every_design_keeps_the_deepest_of_all_wells(library: StartPortfolio) -> None:
    pairs = zip(designs(), library.starts, strict=False)
    missed = [depth(design, start) - best(design) for (design,), start in pairs]
    assert np.mean(np.array(missed) < 0.02) >= 0.9


def test_few_neighbours_lead_other_designs_to_their_deepest_well(library: StartPortfolio) -> None:
    assert library.neighbourhood is not None
    assert library.count == library.neighbourhood.tried < len(library.starts)
    others = [design for (design,) in list(designs(80))[40:]]
    found = [min(cost_of(landscape().solve((d,), s)) for s in library.near((d,))) for d in others]
    assert np.mean([cost <= best(d) + 0.02 for cost, d in zip(found, others, strict=True)]) >= 0.9


def test_it_tells_how_many_designs_their_neighbours_serve(library: StartPortfolio) -> None:
    """Solved again, each design from the optima of the others."""
    assert library.neighbourhood is not None
    served, places = 0, np.array(library.neighbourhood.places)
    for place, (design, own) in enumerate(zip(designs(), library.starts, strict=False)):
        apart = np.abs(places - places[place])[:, 0]
        nearest = [other for other in np.argsort(apart, kind="stable") if other != place][: library.count]
        ends = [cost_of(landscape().solve(design, library.starts[other])) for other in nearest]
        served += min(ends) <= 0.99 * depth(*design, own)
    assert library.coverage.designs == len(places)
    assert library.coverage.good == served


def test_a_design_is_solved_from_where_a_similar_landscape_is() -> None:
    """From the similar one's library alone: what is drawn leads nowhere."""
    rich = start_library(landscape(), designs(), GATHERING)

    class Undrawn(Landscape):
        def random_start(self, rng: np.random.Generator) -> Start:
            return {"robot.joints": np.array([-3.0])}

    ground = landscape()
    undrawn = Undrawn(ground.solver, ground.beside, (), ground.relative, ground.absolute)
    alone, beside = (
        start_library(undrawn, designs(), replace(GATHERING, rounds=0), similar) for similar in ([], [rich])
    )
    depths = [
        sum(depth(design, start) for (design,), start in zip(designs(), found.starts, strict=False))
        for found in (alone, beside, rich)
    ]
    assert depths[0] > depths[1] + 1.0
    assert depths[1] == pytest.approx(depths[2], abs=1e-3)


def test_the_same_landscape_gets_the_same_library(library: StartPortfolio) -> None:
    again = start_library(landscape(), designs(), GATHERING)
    assert again.neighbourhood == library.neighbourhood
    assert [start["robot.joints"].tolist() for start in again.starts] == [
        start["robot.joints"].tolist() for start in library.starts
    ]


def test_a_landscape_without_optima_has_no_library() -> None:
    found = start_library(landscape(limit=1.0, least=2.5), designs(), replace(GATHERING, designs=3))
    assert found == StartPortfolio((), Coverage(0, 0, 0.0))


def test_the_nearest_come_first_by_the_metric() -> None:
    """A parameter that moves no joint does not count, however large its numbers are."""
    near = Neighbourhood(metric=((1.0,), (0.0,)), places=((0.0,), (1.0,), (3.0,)), tried=2)
    starts = tuple({"robot.joints": np.array([place])} for (place,) in near.places)
    portfolio = StartPortfolio(starts, Coverage(0, 0, 0.0), near)
    assert [start["robot.joints"][0] for start in portfolio.near((2.8, 1e6))] == [3.0, 1.0]
    assert replace_neighbourhood(portfolio).near((2.8, 1e6)) == starts


def replace_neighbourhood(portfolio: StartPortfolio) -> StartPortfolio:
    """The same without: all starts serve all designs."""
    return StartPortfolio(portfolio.starts, portfolio.coverage)
