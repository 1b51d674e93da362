"""The parts of the surrogate search against closed forms."""

import hashlib
import math
import os
import subprocess
import sys
from dataclasses import replace

import moocore
import numpy as np
import pytest
from scipy.optimize import minimize

from evodesign.records import SearchSettings
from evodesign.searches.base import ObjectivePart, Outcome
from evodesign.searches.registry import make_search
from evodesign.searches.surrogate.approximation import KEPT, Approximation, Known
from evodesign.searches.surrogate.evolution import Members
from evodesign.searches.surrogate.feasibility import Feasibility, margins_of_violations
from evodesign.searches.surrogate.global_model import GlobalModel
from evodesign.searches.surrogate.knowledge import Knowledge
from evodesign.searches.surrogate.local_residual import LocalResidual
from evodesign.searches.surrogate.selection import chosen

DIMENSION = 4
CONTINUOUS = np.zeros(DIMENSION, bool)


def curved(points):
    """Two outputs, and their gradients."""
    waves = 3.0 * points
    values = np.stack([np.sin(waves).sum(axis=1), ((points - 0.3) ** 2).sum(axis=1)], axis=1)
    gradients = np.stack([3.0 * np.cos(waves), 2.0 * (points - 0.3)], axis=1)
    return values, gradients


def known(count, *, gradients=True):
    points = np.random.default_rng(count).random((count, DIMENSION))
    values, slopes = curved(points)
    return Known(points, values, slopes if gradients else np.full_like(slopes, np.nan))


def model(designs):
    return Approximation(designs, CONTINUOUS, np.random.default_rng(2))


def test_sums_over_designs_are_those_of_the_regression_they_stand_for():
    """Normal equations from rows written out one by one, with differences for the features' gradients."""
    some, step = known(5), 1e-6
    found = GlobalModel(np.full(DIMENSION, 0.8), ~CONTINUOUS, 2, np.random.default_rng(1))
    found.add(some.points, some.targets, some.gradients)
    rows, right, weights = [found.features(some.points)], [some.targets], [np.ones(5)]
    for axis in range(DIMENSION):
        away = step * np.eye(DIMENSION)[axis]
        slope = (found.features(some.points + away) - found.features(some.points - away)) / (2.0 * step)
        rows.append(slope)
        right.append(some.gradients[:, :, axis])
        weights.append(np.full(5, 0.1))
    design, targets, weight = np.vstack(rows), np.vstack(right), np.concatenate(weights)
    precision = design.T @ (weight[:, None] * design) / 0.01 + np.eye(design.shape[1])
    expected = np.linalg.solve(precision, design.T @ (weight[:, None] * targets) / 0.01)
    fitted = found.solved(np.zeros(2), np.ones(2))
    assert fitted.at(some.points, fitted.weights) == pytest.approx(rows[0] @ expected, abs=1e-6)


def test_slopes_of_the_model_are_its_differences():
    designs, step = known(30), 1e-5
    found = GlobalModel(np.full(DIMENSION, 0.8), ~CONTINUOUS, 2, np.random.default_rng(1))
    found.add(designs.points, designs.targets, designs.gradients)
    fitted = found.solved(designs.targets.mean(axis=0), designs.targets.std(axis=0))
    slopes = fitted.slopes(designs.points)
    for axis in range(DIMENSION):
        away = step * np.eye(DIMENSION)[axis]
        ends = [fitted.at(designs.points + sign * away, fitted.weights) for sign in (1.0, -1.0)]
        assert slopes[:, :, axis] == pytest.approx((ends[0] - ends[1]) / (2.0 * step), abs=1e-6)


def test_gradients_make_the_model_better():
    asked = np.random.default_rng(9).random((200, DIMENSION))
    values, _ = curved(asked)
    errors = [
        np.abs(model(known(25, gradients=given)).expected()(asked) - values).mean() for given in (True, False)
    ]
    assert errors[0] < 0.6 * errors[1]


def test_the_model_passes_through_what_is_known_with_its_slopes():
    designs = known(25)
    expected = model(designs).expected()
    assert expected(designs.points) == pytest.approx(designs.targets, abs=1e-6)
    near = designs.points + 1e-3
    first_order = designs.targets + 1e-3 * designs.gradients.sum(axis=2)
    assert expected(near) == pytest.approx(first_order, abs=2e-5)


def test_far_from_everything_no_residual_is_left():
    one = LocalResidual(np.zeros((1, 2)), np.ones(2), np.array([[5.0]]), np.array([[[1.0, 0.0]]]))
    assert one(np.array([[1e-5, 0.0], [4.0, 0.0]])) == pytest.approx(np.array([[5.0], [0.0]]), abs=1e-4)


def test_adding_designs_equals_beginning_with_them_but_for_their_scaling():
    whole = known(40)
    grown = model(whole.part(np.arange(39)))
    before = grown.expected()(whole.points[39:])
    grown.add(whole.part(np.arange(39, 40)))
    after = grown.expected()(whole.points[39:])
    assert after == pytest.approx(whole.targets[39:], abs=1e-6)
    assert np.abs(before - whole.targets[39:]).max() > 1e-3


def test_draws_agree_where_designs_are_and_differ_elsewhere():
    found, generator = model(known(20, gradients=False)), np.random.default_rng(4)
    draws = [found.drawn(generator) for _ in range(8)]
    near, far = known(20).points, generator.random((50, DIMENSION))
    known_well, unknown = (np.std([draw(each) for draw in draws], axis=0).mean() for each in (near, far))
    assert known_well < 0.1 * found._known.targets.std()
    assert unknown > 3.0 * known_well


def test_no_output_is_expected_much_beyond_what_is_known_of_it():
    designs, far = known(20), np.full((1, DIMENSION), 30.0)
    low, high = designs.targets.min(axis=0), designs.targets.max(axis=0)
    found = model(designs)
    for function, share in ((found.expected(), 0.05), (found.drawn(np.random.default_rng(4)), 0.1)):
        beyond = share * (high - low)
        assert ((function(far) >= low - beyond - 1e-9) & (function(far) <= high + beyond + 1e-9)).all()
    assert found.smooth()(far).max() > 2.0 * high.max()


def test_an_objective_is_the_mean_of_its_parts():
    designs, points = known(30), np.random.default_rng(3).random((5, DIMENSION))
    means = np.array([[1.0, 0.0], [0.0, 0.5], [0.0, 0.5]])
    several = Known(designs.points, *(each[:, [0, 1, 1]] for each in (designs.targets, designs.gradients)))
    found = Approximation(several, CONTINUOUS, np.random.default_rng(2), means=means)
    assert found.expected()(points) == pytest.approx(model(designs).expected()(points), abs=1e-9)


def test_another_value_of_a_part_that_has_had_one_only_is_not_ruled_out():
    designs, far = known(30, gradients=False), np.random.default_rng(3).random((50, DIMENSION))
    still = np.stack([designs.targets[:, 0], np.full(30, 2.0)], axis=1)
    generator, halves = np.random.default_rng(2), np.full((2, 1), 0.5)
    model = Approximation(
        Known(designs.points, still, designs.gradients), CONTINUOUS, generator, means=halves
    )
    mean, scale = model._moments()
    assert scale[1] == pytest.approx(0.2)
    beyond = 0.1 * 4.0 * scale[1]
    low, high = still[:, 0].min(), still[:, 0].max()
    margin = 0.1 * max(high - low, 4.0 * 0.1 * abs(mean[0]))
    found = np.stack([model.drawn(generator)(far)[:, 0] for _ in range(40)])
    assert found.max() <= 0.5 * (high + margin + 2.0 + beyond) + 1e-9
    assert found.min() >= 0.5 * (low - margin + 2.0 - beyond) - 1e-9
    apart = model._together(model._fitted(), [model._fitted()[0].drawn(generator)], far)[:, 1]
    assert np.ptp(apart) > 1e-3


def test_margins_of_violations_are_negative_inside():
    assert margins_of_violations(np.array([0.0, 2.0, 4.0]))[:, 0].tolist() == [-3.0, 2.0, 4.0]


def test_infeasibility_adds_violations_and_expected_failures():
    def one(points):
        return points[:, :1] - 0.5

    def other(points):
        return points[:, 1:] - 0.5

    def failure(points):
        return np.where(points[:, :1] > 0.9, 1.0, -1.0)

    points = np.array([[0.1, 0.1], [0.7, 0.6], [0.95, 0.0]])
    assert Feasibility([one, other], failure, 0.0)(points) == pytest.approx([0.0, 0.3, 1.45])


def test_the_chosen_add_most_together():
    """Areas of one and of two rectangles, by hand."""
    generator = np.random.default_rng(3)
    objectives = generator.random((12, 2))
    members = Members(generator.random((12, 3)), objectives, np.zeros(12))
    first, second = chosen(members, np.empty((0, 2)), 2, generator)
    sides = 1.0 - objectives
    areas = sides.prod(axis=1)
    assert first == int(np.argmax(areas))
    together = areas + areas[first] - np.minimum(sides, sides[first]).prod(axis=1)
    assert second == int(np.argmax(together))


def settings(**others):
    given = {"dimension": 6, "objectives": 2, "population": 8, "seed": 3} | others
    return SearchSettings(algorithm="surrogate", **given)


def sloped(genome, signs=(1.0, 1.0)):
    """Two bowls with their gradients."""
    point = np.array(genome)
    centres = (0.25, 0.6)
    values = tuple(float(((point - centre) ** 2).sum()) for centre in centres)
    rows = tuple(tuple((2.0 * (point - centre)).tolist()) for centre in centres)
    return Outcome(values, 0.0, gradients=rows)


def searched(search, generations, outcome):
    found = []
    for _ in range(generations):
        outcomes = [outcome(genome) for genome in search.ask()]
        found += [each.objectives for each in outcomes]
        search.tell(outcomes)
    return found


def test_gradients_are_worth_evaluations():
    with_gradients = searched(make_search(settings()), 6, sloped)
    without = searched(make_search(settings()), 6, lambda genome: Outcome(sloped(genome).objectives, 0.0))
    volumes = [moocore.hypervolume(np.array(each), ref=(1.0, 1.0)) for each in (with_gradients, without)]
    assert volumes[0] > volumes[1]


def test_a_gradient_that_is_missing_is_no_zero():
    """Without one of its rows a design counts with its values alone, so that it changes what is asked."""

    def gap(genome):
        outcome = sloped(genome)
        return Outcome(outcome.objectives, 0.0, gradients=(outcome.gradients[0], None))

    def flat(genome):
        outcome = sloped(genome)
        return Outcome(outcome.objectives, 0.0, gradients=(outcome.gradients[0], (0.0,) * 6))

    gaps = searched(make_search(settings()), 6, gap)
    zeros = searched(make_search(settings()), 6, flat)
    volumes = [moocore.hypervolume(np.array(each), ref=(1.0, 1.0)) for each in (gaps, zeros)]
    assert volumes[0] > volumes[1]


def test_objectives_are_learnt_by_their_parts():
    """The first is the mean of two that are cut off at other places; parts that are missing do no harm."""

    def whole(genome):
        point = np.array(genome)
        near, far = 4.0 * point.mean(), 4.0 * (1.0 - point.mean())
        values = [min(max(near - 1.0, 0.0), 1.0), max(far - 2.5, 0.0)]
        rows = [4.0 / 6.0 * (0.0 < values[0] < 1.0), -4.0 / 6.0 * (values[1] > 0.0)]
        parts = tuple(ObjectivePart(value, (row,) * 6) for value, row in zip(values, rows, strict=True))
        other = ((point - 0.5) ** 2).sum()
        gradients = ((sum(rows) / 2.0,) * 6, tuple(2.0 * (point - 0.5)))
        return Outcome((sum(values) / 2.0, other), 0.0, gradients=gradients, parts=(parts, ()))

    knowledge, generator = Knowledge(settings()), np.random.default_rng(7)
    points = generator.random((40, 6)).tolist()
    for place, genome in enumerate(points):
        outcome = whole(genome)
        knowledge.add(tuple(genome), replace(outcome, parts=()) if place % 10 == 9 else outcome)
    model = knowledge.modelled(generator)
    asked = generator.random((50, 6))
    expected = np.array([whole(genome).objectives for genome in asked.tolist()])
    assert model._known.targets.shape == (40, 3)
    told = [whole(genome).objectives for genome in points]
    assert model.expected()(np.array(points)) == pytest.approx(np.array(told), abs=1e-5)
    assert np.abs(model.expected()(asked) - expected).mean() < 0.05


def test_a_margin_is_learnt_from_the_designs_in_which_it_is_known():
    """The second is unknown where the first is violated, and would be far off there."""

    def outcome(genome, second):
        point = np.array(genome)
        first = float(point[0] - 0.5)
        margins = (first, None if first > 0.0 else second(point))
        violation = max(first, 0.0) + max(margins[1] or 0.0, 0.0)
        return Outcome(sloped(genome).objectives if violation == 0.0 else None, violation, margins=margins)

    def true(point):
        return float(point[1] - 0.7)

    generator = np.random.default_rng(8)
    knowledge, points = Knowledge(settings()), generator.random((60, 6)).tolist()
    for genome in points:
        knowledge.add(tuple(genome), outcome(genome, true))
    asked = generator.random((200, 6))
    expected = np.maximum(asked[:, 0] - 0.5, 0.0) + np.maximum(asked[:, 1] - 0.7, 0.0)
    found = knowledge.feasibility(generator)(asked)
    assert np.abs(found - expected).mean() < 0.03
    assert np.corrcoef(found, expected)[0, 1] > 0.95


def test_what_lies_beyond_a_given_reference_is_left_alone():
    limited = settings(reference=(0.15, None))
    late = [np.array(searched(make_search(each), 12, sloped))[-32:, 0] for each in (limited, settings())]
    assert (late[0] < 0.2).mean() > (late[1] < 0.2).mean()


def test_ends_are_found_that_lie_beyond_the_reference_of_the_first_designs():
    """The end of the first objective is far worse in the second than nine in ten of the first designs."""

    def steep(genome):
        point = np.array(genome)
        first, second = point.mean(), math.exp(12.0 * (0.5 - point.mean())) + ((point - 0.5) ** 2).sum()
        slope = -2.0 * math.exp(12.0 * (0.5 - point.mean()))
        return Outcome((first, second), 0.0, gradients=((1 / 6,) * 6, tuple(slope + 2.0 * (point - 0.5))))

    least = [
        np.array(searched(make_search(settings(reference=given)), 12, steep))[:, 0].min()
        for given in ((None, None), (None, 30.0))
    ]
    assert least[0] < 0.02, "no genome has less than 0"
    assert least[1] > 0.15, "where a reference is given, 0.5 - ln(30) / 12 = 0.22 is the end"


def test_ends_are_found_of_what_is_no_worse_than_the_first_start():
    """The least value of each bowl where no other is above the start's, by another method."""
    centres = np.random.default_rng(4).random((4, 6))
    middle = centres.mean(axis=0)
    start = tuple(np.clip(middle + 0.22 * np.array([1, 1, 1, -1, 1, 1]), 0.0, 1.0).tolist())

    def bowls(genome):
        away = np.array(genome) - centres
        return Outcome(tuple((away**2).sum(axis=1)), 0.0, gradients=tuple(map(tuple, 2.0 * away)))

    def short(starts):
        """The share of what may be gained that a search missed, of each bowl."""
        search = make_search(settings(objectives=4, start=starts, seed=2))
        found = np.array(searched(search, 16, bowls))
        return (found[(found <= values).all(axis=1)].min(axis=0) - least) / (values - least)

    values = np.array(bowls(start).objectives)
    limit = {"type": "ineq", "fun": lambda point: values - ((point - centres) ** 2).sum(axis=1)}
    least = np.array(
        [
            minimize(
                lambda p, c=c: ((p - c) ** 2).sum(), middle, bounds=[(0, 1)] * 6, constraints=[limit]
            ).fun
            for c in centres
        ]
    )
    assert short((start, (0.5,) * 6)).max() < 0.2
    assert short(((0.5,) * 6, start)).max() > 0.4, "where another start comes first, nobody asked for it"


def test_a_model_of_many_designs_is_made_of_a_thousand():
    knowledge, generator = Knowledge(settings()), np.random.default_rng(5)
    for genome in generator.random((3000, 6)).tolist():
        knowledge.add(tuple(genome), sloped(genome))
    found = knowledge.modelled(generator)
    assert len(found._known.points) == KEPT
    front, values = knowledge.front()
    kept = {tuple(point) for point in found._known.points.tolist()}
    assert all(tuple(point) in kept for point in front.tolist())
    assert len(values) == len(front)


def test_what_was_told_is_not_copied_for_every_proposal():
    """So that a proposal does not take longer the more designs there are."""
    knowledge, generator = Knowledge(settings()), np.random.default_rng(6)
    told = generator.random((300, 6)).tolist()
    for count, genome in enumerate(told, 1):
        knowledge.add(tuple(genome), sloped(genome))
        assert len(knowledge.points) == len(knowledge) == count
    assert np.shares_memory(knowledge.points, knowledge.points)
    assert knowledge.points.tolist() == told
    best = moocore.is_nondominated(np.array([sloped(genome).objectives for genome in told]))
    assert knowledge.front()[0].tolist() == np.array(told)[best].tolist()
    knowledge.add((0.0,) * 6, Outcome((-1.0, -1.0), 0.0))
    assert knowledge.front()[0].tolist() == [[0.0] * 6]


@pytest.mark.slow
def test_proposals_do_not_depend_on_the_number_of_threads():
    """In processes whose BLAS has one thread and two, which add up in another order."""
    digests = set()
    for threads in ("1", "2"):
        given = os.environ | {"OPENBLAS_NUM_THREADS": threads, "OMP_NUM_THREADS": threads}
        done = subprocess.run(
            [sys.executable, "-m", __spec__.name], env=given, capture_output=True, text=True, check=True
        )
        digests.add(done.stdout)
    assert len(digests) == 1
    assert "" not in digests


def digest_of_proposals():
    """What a search in 16 dimensions asks for."""
    search, digest = make_search(settings(dimension=16)), hashlib.sha256()
    for _ in range(9):
        digest.update(np.array(search.ask()).tobytes())
        search.tell([sloped(genome) for genome in search.ask()])
    return digest.hexdigest()


if __name__ == "__main__":
    sys.stdout.write(digest_of_proposals())


def test_cosines_in_single_precision_give_the_same_outputs_to_four_digits() -> None:
    generator = np.random.default_rng(3)
    points = generator.random((120, 3))
    targets = np.sin(6.0 * points @ np.array([1.0, 0.5, -0.7]))[:, None]
    model = GlobalModel(np.full(3, 0.4), np.ones(3, dtype=bool), 1, generator)
    model.add(points, targets, np.full((120, 1, 3), np.nan))
    fitted = model.solved(targets.mean(axis=0), targets.std(axis=0))
    weights = np.hstack([fitted.drawn(generator) for _ in range(4)])
    places = generator.random((200, 3))
    exact = fitted.at(places, weights)
    assert exact.std() > 0.1
    np.testing.assert_allclose(fitted.roughly_at(places, weights), exact, atol=1e-4)
