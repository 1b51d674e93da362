"""Seeds lead every design to its best optimum, on a landscape whose optima are known in closed form."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from types import SimpleNamespace

import casadi as ca
import numpy as np
import pytest

from evodesign.design.spread import spread_designs
from evodesign.evaluation.evaluate import Evaluator
from evodesign.nlp.method import SolverOptions
from evodesign.nlp.program import ConstraintBlock, Program, Start, Variable
from evodesign.nlp.solver import RawSolution, Solver
from evodesign.posture.precompute.precomputed import Precomputed
from evodesign.posture.seeking.landscape import REFUSED, Landscape
from evodesign.posture.seeking.seeker import Seeker
from evodesign.posture.seeking.start_portfolio import Coverage
from evodesign.posture.seeking.start_training import Training, _cover, start_portfolio
from evodesign.problem.build import DesignProblem
from evodesign.records import Status

FIXED = ({"robot.joints": [0.0]}, {"robot.joints": [0.5]})
WELLS = (-2.0, -0.5, 1.0, 2.5)
UNIVERSAL = tuple({"robot.joints": [place]} for place in np.arange(-2.8, 3.0, 0.4))
TRAINING = Training(designs=12, begun=12, random=0, portfolio=6)


def best(design: float) -> float:
    """The deepest of the wells; the design decides which."""
    return min(-1.0 - np.cos(2.0 * np.pi * (well - design) / 6.0) for well in WELLS)


def landscape(limit: float = 3.0, least: float = -3.0) -> Landscape:
    """A product of squares with a zero in each well, beside a depth that depends on the design."""
    design = ca.SX.sym("design")
    joints = replace(Variable.column("robot.joints", [-limit], [limit], [0.0], 1.0), drawn=True)
    x = joints.value[0]
    cost = -sum(
        (1.0 + ca.cos(2.0 * np.pi * (well - design) / 6.0)) * ca.exp(-40.0 * (x - well) ** 2)
        for well in WELLS
    )
    bound = ConstraintBlock("bound", x, least, 9.0)
    program = Program("wells", (joints,), (bound,), cost, {"design": design})
    solver = Solver(program, SolverOptions())
    return Landscape(Seeker(solver), {}, FIXED, 0.01, 1e-6, universal=UNIVERSAL)


def designs(count: int = 200) -> Iterator[tuple[float, ...]]:
    return spread_designs(1, lambda point: (6.0 * point[0] - 3.0,), lambda design: True, count)


def test_a_portfolio_finds_every_well_that_is_somebodys_deepest() -> None:
    found = start_portfolio(landscape(), designs(), TRAINING)
    wells = {min(WELLS, key=lambda well: abs(well - seed["robot.joints"][0])) for seed in found.starts}
    assert wells == set(WELLS)
    assert len(found.starts) == len(WELLS)
    assert found.coverage.share == 1.0
    for (design,) in list(designs(40)):
        ends = [landscape().solve((design,), seed).cost for seed in found.starts]
        assert min(ends) == pytest.approx(best(design), abs=0.02)


def test_a_single_start_may_miss_the_best_optimum() -> None:
    """What the portfolio is for: from zero most designs end in another well than their deepest."""
    ends = [(design, landscape().solve((design,), {"robot.joints": [0.0]}).cost) for (design,) in designs(40)]
    assert np.mean([cost > best(design) + 0.02 for design, cost in ends]) > 0.3


def test_a_small_portfolio_tells_what_it_misses() -> None:
    found = start_portfolio(landscape(), designs(), replace(TRAINING, portfolio=1))
    assert len(found.starts) == 1
    assert found.coverage.good < found.coverage.designs
    assert found.coverage.worst > 0.1
    assert found.coverage.share == found.coverage.good / found.coverage.designs


class SeekerOfOne:
    """All starts lead to the same optimum, in as many iterations as they say."""

    program = landscape().seeker.program

    @property
    def solver(self) -> SeekerOfOne:
        """Who solves."""
        return self

    def settled(self, parameters: dict, raw: SimpleNamespace, gain: float = 0.0) -> SimpleNamespace:
        """No rows are switched off."""
        return raw

    bettered = settled

    def solve(self, parameters: dict, start: dict) -> SimpleNamespace:
        """The same optimum from everywhere."""
        (work,) = start["robot.joints"]
        return SimpleNamespace(status=Status.SOLVED, cost=1.0, iterations=work, values=start)


def test_the_same_landscape_gets_the_same_seeds() -> None:
    one, other = (start_portfolio(landscape(), designs(), TRAINING) for _ in range(2))
    assert [seed["robot.joints"].tolist() for seed in one.starts] == [
        seed["robot.joints"].tolist() for seed in other.starts
    ]


def test_a_landscape_without_optima_has_no_seeds() -> None:
    found = start_portfolio(landscape(limit=1.0, least=2.5), designs(), replace(TRAINING, designs=2))
    assert found.starts == ()
    assert found.coverage.designs == 0


def test_random_starts_keep_to_the_joints_ranges() -> None:
    ground, rng = landscape(limit=2.0), np.random.default_rng(1)
    drawn = np.array([ground.random_start(rng)["robot.joints"][0] for _ in range(200)])
    assert drawn.min() < -1.8
    assert drawn.max() > 1.8
    assert np.abs(drawn).max() <= 2.0


def test_seeds_of_the_default_problem_lead_other_designs_well(known: Precomputed) -> None:
    for found in (known.highest, known.lowest, *known.postures.values()):
        assert 1 <= len(found.starts) <= 6
        assert found.coverage.designs >= 12
        assert found.coverage.share >= 0.9


def test_an_evaluation_says_which_seed_led_to_it(problem: DesignProblem, evaluator: Evaluator) -> None:
    result = evaluator.solve(problem.space.unscaled(problem.scene.robot.tree))
    for height in result.cases:
        assert height.attempt in height.attempts
        assert {attempt.formulation for attempt in height.attempts} == {"symmetric"}
        assert all(attempt.start.startswith("start") for attempt in height.attempts)
        won = height.attempt
        assert won.cost <= min(attempt.cost for attempt in height.attempts)


def test_without_seeds_solves_begin_at_the_fixed_starts(problem: DesignProblem, known: Precomputed) -> None:
    plain = Evaluator(problem)
    result = plain.solve(problem.space.unscaled(problem.scene.robot.tree))
    assert [attempt.name for attempt in result.cases[0].attempts] == [
        "symmetric: fixed start 1",
        "symmetric: fixed start 2",
    ]


def test_seeds_reach_higher_than_fixed_starts(
    problem: DesignProblem, evaluator: Evaluator, known: Precomputed
) -> None:
    """Arms raised sideways over the head hold a load higher than arms held forward."""
    values = problem.space.unscaled(problem.scene.robot.tree)
    seeded = evaluator.solve(values).reach.highest
    fixed = Evaluator(problem).solve(values).reach.highest
    assert seeded is not None
    assert fixed is not None
    assert seeded > fixed + 0.05


def well_of(start: Start) -> float:
    return min(WELLS, key=lambda well: abs(well - start["robot.joints"][0]))


def test_as_few_starts_are_kept_as_serve_every_design() -> None:
    found = start_portfolio(landscape(), [(1.0,)] * 4, TRAINING)
    one = min(WELLS, key=lambda well: -np.cos(2.0 * np.pi * (well - 1.0) / 6.0))
    assert [well_of(start) for start in found.starts] == [one]
    assert found.coverage == Coverage(2, 2, 0.0)


def test_there_are_no_starts_without_designs() -> None:
    assert start_portfolio(landscape(), [], TRAINING).starts == ()


def test_of_starts_that_serve_as_many_those_with_the_least_work_are_kept() -> None:
    """Of three by the work that they are: the first serves all, the others half of them each for less."""
    good = np.array([[True, True, False], [True, True, False], [True, False, True], [True, False, True]])
    assert _cover(good, np.array([9.0, 2.0, 2.0]), 6) == [1, 2]
    assert _cover(good, np.array([3.0, 2.0, 2.0]), 6) == [0]
    assert _cover(good, np.array([9.0, 2.0, 2.0]), 1) == [1]


def test_a_solution_that_is_not_accepted_counts_as_none() -> None:
    def cleared(design: tuple[float, ...], raw: RawSolution) -> RawSolution:
        if raw.values["robot.joints"][0] > 0.0:
            return raw
        return replace(raw, status=Status.NUMERICAL_FAILURE, reason=REFUSED)

    above = replace(landscape(), cleared=cleared)
    assert above.solve((0.0,), {"robot.joints": [1.0]}).status is Status.SOLVED
    refused = above.solve((0.0,), {"robot.joints": [-0.5]})
    assert refused.status is Status.NUMERICAL_FAILURE
    assert refused.reason == REFUSED
    found = start_portfolio(above, designs(), TRAINING)
    assert {well_of(start) for start in found.starts} == {1.0, 2.5}


def test_optima_are_offered_until_every_design_is_served() -> None:
    """One universal start leads to one well, several to all; few are offered where that is said."""
    one = replace(landscape(), universal=({"robot.joints": [-2.0]},))
    assert {well_of(start) for start in start_portfolio(one, designs(), TRAINING).starts} == {-2.0}
    few = start_portfolio(landscape(), designs(), replace(TRAINING, offers=2))
    assert len(few.starts) == 2
    assert few.coverage.share < 1.0


def test_random_starts_find_what_universal_ones_do_not() -> None:
    one = replace(landscape(), universal=({"robot.joints": [-2.0]},))
    found = start_portfolio(one, designs(), replace(TRAINING, random=6))
    assert {well_of(start) for start in found.starts} == set(WELLS)


def test_designs_that_are_not_begun_are_served_as_well() -> None:
    found = start_portfolio(landscape(), designs(), replace(TRAINING, designs=24, begun=6))
    assert {well_of(start) for start in found.starts} == set(WELLS)
    assert found.coverage.designs == 12


def test_ends_of_one_cost_are_settled_once() -> None:
    """Fifteen starts end in four wells: no two ends of one design that are settled cost the same.

    Nor where those of one well lead nowhere.
    """
    asked: dict[tuple[float, ...], list[float]] = {}
    lost: float | None = None

    class Counting(Landscape):
        def settled(self, design: tuple[float, ...], end: RawSolution) -> RawSolution:
            asked.setdefault(design, []).append(end.cost)
            found = Landscape.settled(self, design, end)
            return replace(found, status=Status.INFEASIBLE) if well_of(end.values) == lost else found

    counting = Counting(landscape().seeker, {}, FIXED, 0.01, 1e-6, universal=UNIVERSAL)
    found = start_portfolio(counting, designs(), TRAINING)
    plain = start_portfolio(landscape(), designs(), TRAINING)
    assert [well_of(start) for start in found.starts] == [well_of(start) for start in plain.starts]
    for lost in (None, max(map(well_of, plain.starts))):
        if lost is not None:
            asked.clear()
            assert lost not in {well_of(s) for s in start_portfolio(counting, designs(), TRAINING).starts}
        assert len(asked) == TRAINING.designs
        for costs in asked.values():
            assert len(costs) <= len(WELLS)
            assert np.all(np.abs(np.diff(np.sort(costs))) > 1e-3 * np.abs(costs).min())
