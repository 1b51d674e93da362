"""The best optima of designs: are they found from random starts, known ones and each other?"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from evodesign.nlp.landscape import Landscape, cost_of, spread_designs
from evodesign.nlp.program import Start
from evodesign.nlp.start_library import Gathering, gathered
from evodesign.nlp.start_training import chosen
from tests.nlp.test_start_training import WELLS, best, landscape

GATHERING = Gathering(designs=32, begun=8, random=12, neighbours=8, rounds=4)

Found = list[tuple[tuple[float, ...], Start]]


def designs(count: int = 200) -> Iterator[tuple[float, ...]]:
    """Between -3 and 3, no two of them equally far from a third."""
    return spread_designs(1, lambda point: (6.0 * point[0] ** 1.1 - 3.0,), lambda design: True, count)


@pytest.fixture(scope="module")
def found() -> Found:
    """Of the landscape of four wells."""
    return gathered(landscape(), designs(), GATHERING)


def depths(found: Found) -> np.ndarray:
    """Of the wells that the designs' optima are in."""
    wells = [min(WELLS, key=lambda well: abs(well - start["robot.joints"][0])) for _, start in found]
    return np.array(
        [-1.0 - np.cos(2.0 * np.pi * (w - d) / 6.0) for ((d,), _), w in zip(found, wells, strict=True)]
    )


class Undrawn(Landscape):
    """What is drawn leads nowhere, and nothing is fixed."""

    def random_start(self, rng: np.random.Generator) -> Start:
        """Always the same."""
        return {"robot.joints": np.array([-3.0])}


def undrawn() -> Undrawn:
    ground = landscape()
    return Undrawn(ground.solver, ground.beside, (), ground.relative, ground.absolute)


def test_nearly_every_design_keeps_the_deepest_of_all_wells(found: Found) -> None:
    assert [design for design, _ in found] == [*designs(32)]
    deepest = np.array([best(design) for (design,), _ in found])
    assert np.mean(depths(found) < deepest + 0.02) >= 0.9


def test_rounds_make_optima_better() -> None:
    """Designs that began in a shallow well are led to a deep one by their neighbours."""
    poor = replace(GATHERING, begun=4, random=1)
    before, after = (gathered(landscape(), designs(), replace(poor, rounds=rounds)) for rounds in (0, 4))
    assert depths(after).sum() < depths(before).sum() - 0.1


def test_each_design_is_solved_from_the_starts_that_are_its_own_and_a_few_from_all() -> None:
    wells = [{"robot.joints": np.array([well])} for well in WELLS]
    alone = replace(GATHERING, rounds=0, neighbours=0)
    every = gathered(undrawn(), designs(), alone, wells)
    few = gathered(undrawn(), designs(), alone, (), wells)
    deepest = np.array([best(design) for (design,), _ in every])
    np.testing.assert_allclose(depths(every), deepest, atol=0.02)
    np.testing.assert_allclose(depths(few)[: GATHERING.begun], deepest[: GATHERING.begun], atol=0.02)
    assert np.all(depths(few)[GATHERING.begun :] >= depths(every)[GATHERING.begun :] - 1e-3)
    assert np.any(depths(few)[GATHERING.begun :] > depths(every)[GATHERING.begun :] + 0.1)


def test_few_of_them_serve_other_designs(found: Found) -> None:
    """One in each well; a share that need not be served takes fewer."""
    starts, solved = [start for _, start in found], [design for design, _ in found]
    all_served = chosen(landscape(), starts, solved, 8)
    most_served = chosen(landscape(), starts, solved, 8, 0.7)
    assert len(most_served.starts) < len(all_served.starts) == len(WELLS)
    for (design,) in list(designs(80))[40:]:
        ends = [cost_of(landscape().solve((design,), start)) for start in all_served.starts]
        assert min(ends) == pytest.approx(best(design), abs=0.02)


def test_the_same_landscape_gets_the_same_optima(found: Found) -> None:
    again = gathered(landscape(), designs(), GATHERING)
    assert [(d, s["robot.joints"].tolist()) for d, s in again] == [
        (d, s["robot.joints"].tolist()) for d, s in found
    ]


def test_a_landscape_without_optima_has_none() -> None:
    assert gathered(landscape(limit=1.0, least=2.5), designs(), replace(GATHERING, designs=3)) == []
